#include "formats/foreign/evogym.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <unordered_map>
#include <utility>

#include "formats/foreign/npz.h"
#include "formats/io/files.h"
#include "formats/io/number.h"
#include "libevo/base/error.h"

namespace evo {
namespace fs = std::filesystem;
namespace {

// ---- worlds: reading --------------------------------------------------------------

constexpr int largest_grid = 100'000;  // cells along one side
// A connected object of n cells has a bounding box of at most (n/2 + 1)^2.
constexpr std::int64_t largest_box = 100'000'000;

struct Cell {
  int x = 0;
  int y = 0;                                      // upwards
  auto operator<=>(const Cell&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14
};

struct Grid {
  int width = 0;
  int height = 0;
  std::int64_t cells() const { return std::int64_t{width} * height; }
  Cell at(std::int64_t index) const {
    return {static_cast<int>(index % width), static_cast<int>(index / width)};
  }
};

// A name as a step of a JSON path.
std::string step(const std::string& name) {
  std::string escaped = "/";
  for (const char c : name) {
    if (c == '~')
      escaped += "~0";
    else if (c == '/')
      escaped += "~1";
    else
      escaped += c;
  }
  return escaped;
}

const Json& field(const Json& record, const std::string& path, const char* name, Json::value_t type,
                  const char* expected) {
  const auto found = record.find(name);
  const std::string place = path + step(name);
  if (found == record.end()) throw Refusal{place, "is missing"};
  if (found->type() != type) throw refusal(place, "expected {}, found {}", expected, shown(*found));
  return *found;
}

// Told of a place, and of what is read there in the benchmark's way.
using Note = std::function<void(const std::string& path, const std::string& text)>;

// The benchmark reads 3.0 as 3, too.
bool is_whole(const Json& value) {
  if (!value.is_number_float()) return value.is_number_integer();
  const auto number = value.get<double>();
  return number == std::floor(number) && std::abs(number) < 1e15;
}

int grid_side(const Json& document, const char* name) {
  const auto found = document.find(name);
  if (found == document.end()) throw Refusal{step(name), "is missing"};
  if (!found->is_number_integer() || *found < 1 || *found > largest_grid)
    throw refusal(step(name), "expected a number of cells, 1 to {}, found {}", largest_grid,
                  shown(*found));
  return found->get<int>();
}

// Rows of the highest cell that an object names. The benchmark finds a cell's place by the
// grid's width alone, and published worlds have cells above their grid_height.
int rows_named(const Json& objects, const Grid& grid) {
  std::int64_t highest = 0;
  for (const auto& [name, record] : objects.items()) {
    const auto indices = record.is_object() ? record.find("indices") : record.end();
    if (indices == record.end() || !indices->is_array()) continue;
    for (const Json& index : *indices)
      if (index.is_number_integer() && index >= 0 &&
          index < std::int64_t{grid.width} * largest_grid)
        highest = std::max(highest, index.get<std::int64_t>());
  }
  return static_cast<int>(highest / grid.width) + 1;
}

// Rows of the grid: the benchmark asks for the number and does not use it.
int grid_height(const Json& document, const Json& objects, int width, const Note& note) {
  const auto found = document.find("grid_height");
  if (found == document.end()) throw Refusal{"/grid_height", "is missing"};
  const bool usable = found->is_number_integer() && *found >= 1 && *found <= largest_grid;
  const int given = usable ? found->get<int>() : 0;
  const int rows = rows_named(objects, {width, given});
  if (!usable)
    note("/grid_height",
         fmt::format("is {}, which is no number of rows; read as {}", shown(*found), rows));
  else if (rows > given)
    note("/grid_height",
         fmt::format("is {}, but there are cells up to row {}; read as {}", given, rows - 1, rows));
  return std::max(rows, given);
}

std::int64_t cell_index(const Json& value, const Grid& grid, const std::string& path) {
  if (!is_whole(value) || value < 0 || value >= grid.cells())
    throw refusal(path, "cell {} is outside the grid of {}x{} cells, 0 to {}", shown(value),
                  grid.width, grid.height, grid.cells() - 1);
  return value.get<std::int64_t>();
}

// The cells of an object by index, with their types.
using Cells = std::map<std::int64_t, Voxel>;

Cells read_cells(const Json& record, const Grid& grid, const std::string& path, const Note& note) {
  const Json& indices =
      field(record, path, "indices", Json::value_t::array, "a list of cell indices");
  const Json& types = field(record, path, "types", Json::value_t::array, "a list of cell types");
  const Json& neighbors = field(record, path, "neighbors", Json::value_t::object,
                                "a mapping from cell index to a list of cell indices");
  if (indices.size() != types.size() || indices.size() != neighbors.size())
    throw refusal(path, "{} indices, {} types and {} neighbors: their numbers must be equal",
                  indices.size(), types.size(), neighbors.size());
  Cells cells;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::int64_t index = cell_index(indices[i], grid, fmt::format("{}/indices/{}", path, i));
    const Json& type = types[i];
    if (!is_whole(type) || type < 0 || type > static_cast<int>(Voxel::fixed))
      throw refusal(fmt::format("{}/types/{}", path, i), "unknown type {}; allowed 0 1 2 3 4 5",
                    shown(type));
    if (!cells.insert_or_assign(index, static_cast<Voxel>(type.get<int>())).second)
      note(fmt::format("{}/indices/{}", path, i),
           fmt::format("cell {} is listed twice; its last type counts", index));
  }
  if (std::none_of(cells.begin(), cells.end(),
                   [](const auto& cell) { return cell.second != Voxel::empty; }))
    throw Refusal{path, "an object without voxels"};
  return cells;
}

// Where the box around the cells lies.
struct Box {
  int left = 0;
  int bottom = 0;
  int right = 0;  // inclusive
  int top = 0;
  int width() const { return right - left + 1; }
  int height() const { return top - bottom + 1; }
  // Of a cell in the object's matrix, row-major, row 0 on top.
  std::int64_t place(const Cell& cell) const {
    return std::int64_t{top - cell.y} * width() + cell.x - left;
  }
};

Box box_around(const Cells& cells, const Grid& grid) {
  const Cell first = grid.at(cells.begin()->first);
  Box box{first.x, first.y, first.x, first.y};
  for (const auto& [index, type] : cells) {
    const Cell cell = grid.at(index);
    box.left = std::min(box.left, cell.x);
    box.right = std::max(box.right, cell.x);
    box.bottom = std::min(box.bottom, cell.y);
    box.top = std::max(box.top, cell.y);
  }
  return box;
}

std::vector<std::pair<std::int64_t, std::int64_t>> read_neighbors(const Json& record,
                                                                  const Cells& cells,
                                                                  const Grid& grid, const Box& box,
                                                                  const std::string& path,
                                                                  const Note& note) {
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  for (const auto& [key, list] : record["neighbors"].items()) {
    const std::string place = path + "/neighbors" + step(key);
    const std::int64_t index = number_in<std::int64_t>(key).value_or(-1);
    if (!cells.contains(index)) {
      note(place, fmt::format("{} is not a cell of this object; left out", shown(Json(key))));
      continue;
    }
    if (!list.is_array())
      throw refusal(place, "expected a list of cell indices, found {}", shown(list));
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string link = fmt::format("{}/{}", place, i);
      const std::int64_t other = cell_index(list[i], grid, link);
      if (!cells.contains(other))
        throw refusal(link, "neighbour {} of cell {} is not a cell of this object", other, index);
      const Cell a = grid.at(index);
      const Cell b = grid.at(other);
      if (std::abs(a.x - b.x) + std::abs(a.y - b.y) != 1) {
        // The benchmark, which counts cells row by row, would weld the ends of two rows.
        if (std::abs(box.place(a) - box.place(b)) == 1)
          throw refusal(link, "neighbour {} of cell {} is not adjacent to it", other, index);
        note(link,
             fmt::format("neighbour {} of cell {} is not adjacent to it; left out", other, index));
        continue;
      }
      if (cells.at(index) == Voxel::empty || cells.at(other) == Voxel::empty)
        throw refusal(link, "cells {} and {} are neighbours, but one is empty", index, other);
      pairs.emplace_back(index, other);
    }
  }
  return pairs;
}

Object read_object(const std::string& name, const Json& record, const Grid& grid,
                   const Note& note) {
  const std::string path = "/objects" + step(name);
  if (!record.is_object())
    throw refusal(path, "expected an object record, found {}", shown(record));
  const Cells cells = read_cells(record, grid, path, note);
  const Box box = box_around(cells, grid);
  const std::size_t reach =
      static_cast<std::size_t>(box.width()) + static_cast<std::size_t>(box.height()) - 1;
  if (reach > cells.size() || std::int64_t{box.width()} * box.height() > largest_box)
    throw refusal(path, "{} cells cannot connect the {}x{} cells they are spread over",
                  cells.size(), box.width(), box.height());
  const auto in_box = [&](std::int64_t index) {
    return static_cast<int>(box.place(grid.at(index)));
  };
  Body body;
  body.rows = box.height();
  body.cols = box.width();
  body.cells.resize(static_cast<std::size_t>(body.rows) * static_cast<std::size_t>(body.cols));
  for (const auto& [index, type] : cells)
    body.cells[static_cast<std::size_t>(in_box(index))] = type;
  for (const auto& [a, b] : read_neighbors(record, cells, grid, box, path, note))
    body.links.push_back({std::min(in_box(a), in_box(b)), std::max(in_box(a), in_box(b))});
  std::sort(body.links.begin(), body.links.end());
  body.links.erase(std::unique(body.links.begin(), body.links.end()), body.links.end());
  if (const auto wrong = defect(body, false)) throw Refusal{path, "inside its box, " + *wrong};
  return {name, std::move(body), box.left, box.bottom};
}

// The world cells that an object fills.
std::vector<Cell> filled_cells(const Object& object) {
  std::vector<Cell> cells;
  for (int r = 0; r < object.body.rows; ++r)
    for (int c = 0; c < object.body.cols; ++c)
      if (object.body.at(r, c) != Voxel::empty)
        cells.push_back({object.x + c, object.y + object.body.rows - 1 - r});
  return cells;
}

void check_overlap(const World& world) {
  std::map<Cell, const Object*> owners;
  for (const Object& object : world.objects)
    for (const Cell& cell : filled_cells(object))
      if (const auto [owner, added] = owners.emplace(cell, &object); !added)
        throw refusal("/objects" + step(object.name),
                      "the cell at x {}, y {} belongs to object {}, too", cell.x, cell.y,
                      shown(Json(owner->second->name)));
}

// ---- worlds: writing --------------------------------------------------------------

// Whether some row or column at the border of the matrix is empty: without its
// empty cells, a reader would take the object for a smaller one.
bool has_empty_border(const Body& body) {
  const auto filled = [&](int r, int c) { return body.at(r, c) != Voxel::empty; };
  bool top = false;
  bool bottom = false;
  bool left = false;
  bool right = false;
  for (int c = 0; c < body.cols; ++c) {
    top |= filled(0, c);
    bottom |= filled(body.rows - 1, c);
  }
  for (int r = 0; r < body.rows; ++r) {
    left |= filled(r, 0);
    right |= filled(r, body.cols - 1);
  }
  return !(top && bottom && left && right);
}

bool at_border(const Body& body, int cell) {
  const int r = cell / body.cols;
  const int c = cell % body.cols;
  return r == 0 || c == 0 || r == body.rows - 1 || c == body.cols - 1;
}

std::string object_to_json(const Object& object, int grid_width) {
  const Body& body = object.body;
  const auto world_index = [&](int cell) {
    const int x = object.x + cell % body.cols;
    const int y = object.y + body.rows - 1 - cell / body.cols;
    return std::int64_t{y} * grid_width + x;
  };
  std::map<int, std::vector<std::int64_t>> neighbors;
  for (const Link& link : body.links) {
    neighbors[link.a].push_back(world_index(link.b));
    neighbors[link.b].push_back(world_index(link.a));
  }
  const bool keep_border = has_empty_border(body);
  std::vector<std::int64_t> indices;
  std::vector<int> types;
  std::string neighbor_lists;
  for (int cell = 0; std::cmp_less(cell, body.cells.size()); ++cell) {
    const Voxel type = body.cells[static_cast<std::size_t>(cell)];
    if (type == Voxel::empty && !(keep_border && at_border(body, cell))) continue;
    indices.push_back(world_index(cell));
    types.push_back(static_cast<int>(type));
    neighbor_lists += fmt::format("{}\"{}\": [{}]", neighbor_lists.empty() ? "" : ", ",
                                  world_index(cell), fmt::join(neighbors[cell], ", "));
  }
  return fmt::format(
      "{{\n      \"indices\": [{}],\n      \"types\": [{}],\n      \"neighbors\": {{{}}}\n    }}",
      fmt::join(indices, ", "), fmt::join(types, ", "), neighbor_lists);
}

// ---- experiments --------------------------------------------------------------------

struct Ranked {
  int label = 0;
  std::optional<double> fitness;
  bool is_number = true;
};

constexpr std::string_view generation_prefix = "generation_";

// The numbers that name the entries of a folder between a prefix and a suffix.
std::vector<int> numbered_entries(const fs::path& folder, std::string_view prefix,
                                  std::string_view suffix) {
  std::vector<int> numbers;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix) || !name.ends_with(suffix) ||
        name.size() < prefix.size() + suffix.size())
      continue;
    const std::string_view middle =
        std::string_view(name).substr(prefix.size(), name.size() - prefix.size() - suffix.size());
    if (const auto number = number_in<unsigned>(middle))
      numbers.push_back(static_cast<int>(*number));
  }
  if (failed)
    throw error(Failure::no_input, "{}: cannot be opened: {}", folder.string(), failed.message());
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

// "label<TAB><TAB>fitness" a line, best first; nothing when the generation was
// not finished.
std::vector<Ranked> read_ranking(const fs::path& path) {
  std::vector<Ranked> ranking;
  if (!fs::exists(path)) return ranking;
  std::istringstream lines(read_file(path));
  std::size_t line_number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++line_number;
    std::istringstream words(line);
    std::string label;
    std::string fitness;
    std::string more;
    words >> label >> fitness >> more;
    if (label.empty()) continue;
    const auto number = number_in<unsigned>(label);
    const auto value = number_in<double>(fitness);
    if (!number || !value || !more.empty())
      throw error(Failure::data, "{}: line {}: expected a label and a fitness, found {}",
                  path.string(), line_number, shown(Json(line)));
    ranking.push_back({static_cast<int>(*number), *value, std::isfinite(*value)});
  }
  return ranking;
}

Robot read_member(const fs::path& generation_folder, int generation, const Ranked& ranked) {
  const fs::path path = generation_folder / "structure" / (std::to_string(ranked.label) + ".npz");
  Robot robot(read_npz(path));
  robot.document["origin"] = {
      {"tool", "evogym"}, {"generation", generation}, {"label", ranked.label}};
  if (ranked.fitness) robot.document["fitness"] = ranked.is_number ? Json(*ranked.fitness) : Json();
  return robot;
}

// Robots in the order first seen, each body once.
class Collection {
 public:
  void add(Robot robot) {
    const auto [known, added] = places_.emplace(robot.id, robots_.size());
    if (added) {
      robots_.push_back(std::move(robot));
      return;
    }
    Robot& first = robots_[known->second];
    const auto fitness = robot.fitness();
    if (fitness && (!first.fitness() || *fitness > *first.fitness()))
      first.document["fitness"] = *fitness;
  }

  std::vector<Robot> take() { return std::move(robots_); }

 private:
  std::vector<Robot> robots_;
  std::unordered_map<std::string, std::size_t> places_;  // by id
};

}  // namespace

// ---- public ---------------------------------------------------------------------------

World evogym_world_from_json(const Json& document, const std::string& where,
                             const WorldWarning& warn) {
  try {
    if (!document.is_object())
      throw refusal("", "expected a world (an object), found {}", shown(document));
    const Note note = [&](const std::string& path, const std::string& text) {
      if (warn) warn(fmt::format("{}: {} {}", where, path, text));
    };
    Grid grid{grid_side(document, "grid_width"), 0};
    const Json& objects = field(document, "", "objects", Json::value_t::object,
                                "a mapping from object name to record");
    grid.height = grid_height(document, objects, grid.width, note);
    World world;
    for (const auto& [name, record] : objects.items())
      world.objects.push_back(read_object(name, record, grid, note));
    check_overlap(world);
    return world;
  } catch (const Refusal& refused) {
    throw refused.at(where);
  }
}

World read_evogym_world(const fs::path& path, const WorldWarning& warn) {
  const std::string where = input_label(path.string());
  return evogym_world_from_json(parse_json(read_input(path.string(), largest_value), where), where,
                                warn);
}

std::string evogym_world_to_json(const World& world) {
  int width = 1;
  int height = 1;
  for (const Object& object : world.objects) {
    if (object.x < 0 || object.y < 0)
      throw error(Failure::data, "object '{}' lies at {}, {}: a position cannot be negative",
                  object.name, object.x, object.y);
    width = std::max(width, object.x + object.body.cols);
    height = std::max(height, object.y + object.body.rows);
  }
  std::set<std::string> names;
  std::string objects;
  for (const Object& object : world.objects) {
    if (!names.insert(object.name).second)
      throw error(Failure::data, "two objects are named '{}'", object.name);
    objects += fmt::format("{}\n    {}: {}", objects.empty() ? "" : ",", compact(object.name),
                           object_to_json(object, width));
  }
  return fmt::format(
      "{{\n  \"grid_width\": {},\n  \"grid_height\": {},\n  \"objects\": {{{}\n  }}\n}}\n", width,
      height, objects);
}

Robot robot_from_evogym_world(const World& world, const std::string& where, BodyCheck check) {
  const auto acts = [](const Object& object) {
    return std::any_of(object.body.cells.begin(), object.body.cells.end(), is_actuator);
  };
  const Object* robot = world.objects.size() == 1 ? &world.objects.front() : nullptr;
  const auto robots = std::count_if(world.objects.begin(), world.objects.end(), acts);
  if (robots == 1) robot = &*std::find_if(world.objects.begin(), world.objects.end(), acts);
  if (robot == nullptr)
    throw error(Failure::data,
                "{}: a world of {} objects, {} of which have actuators; one is expected, the robot",
                where, world.objects.size(), robots);
  return robot_from_json(Robot(robot->body).document, where, check);
}

World evogym_world_of_robot(const Robot& robot) { return {{{"robot", robot.body, 0, 0}}}; }

std::vector<Robot> read_evogym_experiment(const fs::path& folder) {
  const std::vector<int> generations = numbered_entries(folder, generation_prefix, "");
  if (generations.empty())
    throw error(Failure::no_input, "{}: not an experiment folder of EvoGym: no generation_0 in it",
                folder.string());
  Collection robots;
  for (const int generation : generations) {
    const fs::path place = folder / fmt::format("{}{}", generation_prefix, generation);
    const std::vector<Ranked> ranking = read_ranking(place / "output.txt");
    std::set<int> ranked_labels;
    for (const Ranked& ranked : ranking) {
      if (!ranked_labels.insert(ranked.label).second)
        throw error(Failure::data, "{}: label {} is ranked twice", (place / "output.txt").string(),
                    ranked.label);
      robots.add(read_member(place, generation, ranked));
    }
    for (const int label : numbered_entries(place / "structure", "", ".npz"))
      if (!ranked_labels.contains(label))
        robots.add(read_member(place, generation, {label, std::nullopt}));
  }
  return robots.take();
}

bool is_evogym_experiment(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "generation_0" / "structure", ignored);
}

}  // namespace evo
