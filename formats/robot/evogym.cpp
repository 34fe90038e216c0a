#include "formats/robot/evogym.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <unordered_map>
#include <utility>

#include "formats/io/files.h"
#include "formats/io/npz.h"
#include "formats/io/number.h"
#include "libevo/base/error.h"
#include "libevo/body/extent.h"

namespace evo {
namespace fs = std::filesystem;
namespace {

// ---- worlds: reading --------------------------------------------------------------

constexpr int largest_grid = 100'000;  // cells along one side
// A connected object of n cells has a bounding box of at most (n/2 + 1)^2.
constexpr std::int64_t largest_box = 100'000'000;

struct Cell {
  int x = 0;
  int y = 0;  // upwards
};

struct Grid {
  int width = 0;
  int height = 0;
  std::int64_t cells() const { return std::int64_t{width} * height; }
  Cell at(std::int64_t index) const {
    return {static_cast<int>(index % width), static_cast<int>(index / width)};
  }
};

// Told of a place, and of what is read there in the benchmark's way.
using Note = std::function<void(const Node& node, const std::string& text)>;

// A whole number; the benchmark reads 3.0 as 3, too.
std::optional<std::int64_t> whole(const Node& node) {
  constexpr double largest_exact = 1e15;
  const auto number = node.is_plain() ? finite_number(node.text()) : std::nullopt;
  if (!number || *number != std::floor(*number) || std::abs(*number) > largest_exact)
    return std::nullopt;
  return static_cast<std::int64_t>(*number);
}

// Rows of the highest cell that an object names. The benchmark finds a cell's place by the
// grid's width alone, and published worlds have cells above their grid_height.
int rows_named(const Node& objects, int width) {
  std::int64_t highest = 0;
  for (const auto& [name, record] : objects.entries()) {
    const auto indices = record.find("indices");
    if (!indices || !indices->is_sequence()) continue;
    for (const Node& item : indices->items())
      if (const auto index = whole(item); index && *index < std::int64_t{width} * largest_grid)
        highest = std::max(highest, *index);
  }
  return static_cast<int>(highest / width) + 1;
}

// Rows of the grid: the benchmark asks for the number and does not use it.
int grid_height(const Node& given, const Node& objects, int width, const Note& note) {
  const auto number = whole(given);
  const int rows = rows_named(objects, width);
  if (!number || *number < 1 || *number > largest_grid) {
    note(given, fmt::format("{} is no number of rows; read as {}", given.found(), rows));
    return rows;
  }
  if (rows > *number)
    note(given, fmt::format("is {}, but there are cells up to row {}; read as {}", *number,
                            rows - 1, rows));
  return std::max(rows, static_cast<int>(*number));
}

std::int64_t cell_index(const Node& node, const Grid& grid) {
  const auto index = whole(node);
  if (!index || *index < 0 || *index >= grid.cells())
    throw node.error(fmt::format("cell {} is outside the grid of {}x{} cells, 0 to {}",
                                 node.found(), grid.width, grid.height, grid.cells() - 1));
  return *index;
}

// The cells of an object by index, with their types.
using Cells = std::map<std::int64_t, Voxel>;

Cells read_cells(const Node& record, const Grid& grid, const Note& note) {
  const std::vector<Node> indices = record.at("indices").items();
  const std::vector<Node> types = record.at("types").items();
  const std::size_t neighbors = record.at("neighbors").entries().size();
  if (indices.size() != types.size() || indices.size() != neighbors)
    throw record.error(
        fmt::format("{} indices, {} types and {} neighbors: their numbers must be equal",
                    indices.size(), types.size(), neighbors));
  Cells cells;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::int64_t index = cell_index(indices[i], grid);
    const auto type = whole(types[i]);
    if (!type || *type < 0 || *type > static_cast<int>(Voxel::fixed))
      throw types[i].error(fmt::format("unknown type {}; allowed 0 1 2 3 4 5", types[i].found()));
    if (!cells.insert_or_assign(index, static_cast<Voxel>(*type)).second)
      note(indices[i], fmt::format("cell {} is listed twice; its last type counts", index));
  }
  if (std::none_of(cells.begin(), cells.end(),
                   [](const auto& cell) { return cell.second != Voxel::empty; }))
    throw record.error("an object without voxels");
  return cells;
}

// Where the box around the cells lies.
struct CellBox {
  int left = 0;
  int bottom = 0;
  int right = 0;  // inclusive
  int top = 0;
  int width() const { return right - left + 1; }
  int height() const { return top - bottom + 1; }
  // Where a cell is in the object's matrix, row-major, row 0 on top.
  std::int64_t place(const Cell& cell) const {
    return std::int64_t{top - cell.y} * width() + cell.x - left;
  }
};

CellBox box_around(const Cells& cells, const Grid& grid) {
  const Cell first = grid.at(cells.begin()->first);
  CellBox box{first.x, first.y, first.x, first.y};
  for (const auto& [index, type] : cells) {
    const Cell cell = grid.at(index);
    box.left = std::min(box.left, cell.x);
    box.right = std::max(box.right, cell.x);
    box.bottom = std::min(box.bottom, cell.y);
    box.top = std::max(box.top, cell.y);
  }
  return box;
}

std::vector<std::pair<std::int64_t, std::int64_t>> read_neighbors(const Node& record,
                                                                  const Cells& cells,
                                                                  const Grid& grid,
                                                                  const CellBox& box,
                                                                  const Note& note) {
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  for (const auto& [key, list] : record.at("neighbors").entries()) {
    const std::int64_t index = number_in<std::int64_t>(key.text()).value_or(-1);
    if (!cells.contains(index)) {
      note(list, fmt::format("{} is not a cell of this object; left out", key.found()));
      continue;
    }
    for (const Node& item : list.items()) {
      const std::int64_t other = cell_index(item, grid);
      if (!cells.contains(other))
        throw item.error(
            fmt::format("neighbour {} of cell {} is not a cell of this object", other, index));
      const Cell a = grid.at(index);
      const Cell b = grid.at(other);
      if (std::abs(a.x - b.x) + std::abs(a.y - b.y) != 1) {
        const std::string text =
            fmt::format("neighbour {} of cell {} is not adjacent to it", other, index);
        // The benchmark, which counts cells row by row, would weld the ends of two rows.
        if (std::abs(box.place(a) - box.place(b)) == 1) throw item.error(text);
        note(item, text + "; left out");
        continue;
      }
      if (cells.at(index) == Voxel::empty || cells.at(other) == Voxel::empty)
        throw item.error(
            fmt::format("cells {} and {} are neighbours, but one is empty", index, other));
      pairs.emplace_back(index, other);
    }
  }
  return pairs;
}

Object read_object(const std::string& name, const Node& record, const Grid& grid,
                   const Note& note) {
  const Cells cells = read_cells(record, grid, note);
  const CellBox box = box_around(cells, grid);
  const std::size_t reach =
      static_cast<std::size_t>(box.width()) + static_cast<std::size_t>(box.height()) - 1;
  if (reach > cells.size() || std::int64_t{box.width()} * box.height() > largest_box)
    throw record.error(fmt::format("{} cells cannot connect the {}x{} cells they are spread over",
                                   cells.size(), box.width(), box.height()));
  const auto in_box = [&](std::int64_t index) {
    return static_cast<int>(box.place(grid.at(index)));
  };
  Body body;
  body.rows = box.height();
  body.cols = box.width();
  body.cells.resize(static_cast<std::size_t>(body.rows) * static_cast<std::size_t>(body.cols));
  for (const auto& [index, type] : cells)
    body.cells[static_cast<std::size_t>(in_box(index))] = type;
  for (const auto& [a, b] : read_neighbors(record, cells, grid, box, note))
    body.links.push_back({std::min(in_box(a), in_box(b)), std::max(in_box(a), in_box(b))});
  std::sort(body.links.begin(), body.links.end());
  body.links.erase(std::unique(body.links.begin(), body.links.end()), body.links.end());
  if (const auto wrong = defect(body, false)) throw record.error("inside its box, " + *wrong);
  if (const auto given = record.find("stiffness")) {  // ours; the benchmark passes it over
    const std::vector<Node> indices = record.at("indices").items();
    const std::vector<Node> factors = given->items();
    if (factors.size() != indices.size())
      throw given->error(fmt::format("{} factors for {} cells", factors.size(), indices.size()));
    std::vector<double> stiffness(body.cells.size(), 1.0);
    for (std::size_t i = 0; i < factors.size(); ++i)
      stiffness[static_cast<std::size_t>(in_box(cell_index(indices[i], grid)))] =
          factors[i].number();
    body = with_stiffness(std::move(body), std::move(stiffness));
  }
  return {name, std::move(body), box.left, box.bottom};
}

// ---- worlds: writing --------------------------------------------------------------

// Whether some row or column at the border of the matrix is empty: without its
// empty cells, a reader would take the object for a smaller one.
bool has_empty_border(const Body& body) {
  const auto box = extent(body);
  return box.rows() < body.rows || box.cols() < body.cols;
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
  std::vector<double> stiffness;
  std::string neighbor_lists;
  for (int cell = 0; std::cmp_less(cell, body.cells.size()); ++cell) {
    const Voxel type = body.cells[static_cast<std::size_t>(cell)];
    if (type == Voxel::empty && !(keep_border && at_border(body, cell))) continue;
    indices.push_back(world_index(cell));
    types.push_back(static_cast<int>(type));
    stiffness.push_back(body.stiffness_of(static_cast<std::size_t>(cell)));
    neighbor_lists += fmt::format("{}\"{}\": [{}]", neighbor_lists.empty() ? "" : ", ",
                                  world_index(cell), fmt::join(neighbors[cell], ", "));
  }
  return fmt::format(
      "{{\n      \"indices\": [{}],\n      \"types\": [{}],\n      \"neighbors\": {{{}}}{}\n    }}",
      fmt::join(indices, ", "), fmt::join(types, ", "), neighbor_lists,
      body.stiffness.empty()
          ? ""
          : fmt::format(",\n      \"stiffness\": [{}]", fmt::join(stiffness, ", ")));
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
                  path.string(), line_number, shown(line));
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

}  // namespace

// ---- public ---------------------------------------------------------------------------

World read_evogym_world(const Node& document, const WorldWarning& warn) {
  const Note note = [&](const Node& node, const std::string& text) {
    if (warn) warn(fmt::format("{}: {}", node.where(), text));
  };
  Grid grid{document.at("grid_width").integer(1, largest_grid), 0};
  const Node objects = document.at("objects");
  grid.height = grid_height(document.at("grid_height"), objects, grid.width, note);
  World world;
  for (const auto& [name, record] : objects.entries())
    world.objects.push_back(read_object(name.text(), record, grid, note));
  if (const auto wrong = defect(world))
    throw objects.at(world.objects[wrong->object].name).error(wrong->text);
  return world;
}

World read_evogym_world(const fs::path& path, const WorldWarning& warn) {
  return read_evogym_world(
      Node::json(read_input(path.string(), largest_value), input_label(path.string())), warn);
}

std::string evogym_world_to_json(const World& world) {
  if (const auto wrong = defect(world)) throw error(Failure::data, "{}", wrong->text);
  int width = 1;
  int height = 1;
  for (const Object& object : world.objects) {
    width = std::max(width, object.x + object.body.cols);
    height = std::max(height, object.y + object.body.rows);
  }
  std::string objects;
  for (const Object& object : world.objects)
    objects += fmt::format("{}\n    {}: {}", objects.empty() ? "" : ",", compact(object.name),
                           object_to_json(object, width));
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
                "{}: a world of {} objects, {} with actuators; one is expected, the robot", where,
                world.objects.size(), robots);
  return checked(Robot(robot->body), where, check);
}

World evogym_world_of_robot(const Robot& robot) { return {{{"robot", robot.body, 0, 0}}}; }

std::vector<Robot> read_evogym_experiment(const fs::path& folder) {
  const std::vector<int> generations = numbered_entries(folder, generation_prefix, "");
  if (generations.empty())
    throw error(Failure::no_input, "{}: not an experiment folder of EvoGym: no generation_0 in it",
                folder.string());
  std::vector<Robot> robots;
  std::unordered_map<std::string, std::size_t> places;  // by id
  const auto add = [&](Robot robot) {
    const auto [known, added] = places.emplace(robot.id, robots.size());
    if (added) return robots.push_back(std::move(robot));
    Robot& first = robots[known->second];
    if (robot.fitness() > first.fitness()) first.document["fitness"] = *robot.fitness();
  };
  for (const int generation : generations) {
    const fs::path place = folder / fmt::format("{}{}", generation_prefix, generation);
    const std::vector<Ranked> ranking = read_ranking(place / "output.txt");
    std::set<int> ranked_labels;
    for (const Ranked& ranked : ranking) {
      if (!ranked_labels.insert(ranked.label).second)
        throw error(Failure::data, "{}: label {} is ranked twice", (place / "output.txt").string(),
                    ranked.label);
      add(read_member(place, generation, ranked));
    }
    for (const int label : numbered_entries(place / "structure", "", ".npz"))
      if (!ranked_labels.contains(label))
        add(read_member(place, generation, {label, std::nullopt}));
  }
  return robots;
}

bool is_evogym_experiment(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "generation_0" / "structure", ignored);
}

}  // namespace evo
