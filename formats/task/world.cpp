#include "formats/task/world.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <sstream>
#include <utility>

#include "formats/io/json.h"
#include "formats/io/number.h"
#include "formats/robot/evogym.h"
#include "libevo/body/extent.h"

namespace evo {
namespace {

constexpr int largest_coordinate = 100'000;  // cells
constexpr long most_cells = 4'000'000;       // of one object's bounding box

struct Cell {
  int x = 0;  // of the world, or of the object while it is being painted
  int y = 0;  // upwards
};

Cell read_cell(const Node& node, int low) {
  const auto& pair = node.items();
  if (pair.size() != 2)
    throw node.error(fmt::format("a cell [x, y] is expected, found {} numbers", pair.size()));
  return {pair[0].integer(low, largest_coordinate), pair[1].integer(low, largest_coordinate)};
}

// ---- drawings -----------------------------------------------------------------

// Rows as a list, or as a block of text (`|`), a line each; top row first, equally long, '.' for
// empty.
std::vector<std::string> read_drawing(const Node& node) {
  std::vector<std::string> drawing;
  if (node.is_sequence()) {
    for (const Node& row : node.items()) drawing.push_back(row.string());
  } else {
    std::istringstream lines(node.string());
    for (std::string line; std::getline(lines, line);) drawing.push_back(line);
  }
  if (drawing.empty() || drawing.front().empty())
    throw node.error("a drawing needs at least one row of letters");
  for (std::size_t row = 0; row < drawing.size(); ++row)
    if (drawing[row].size() != drawing.front().size())
      throw node.error(fmt::format("row {} of the drawing has {} cells, row 1 has {}", row + 1,
                                   drawing[row].size(), drawing.front().size()));
  return drawing;
}

Voxel read_voxel(const Node& node, char drawn, const std::string& place) {
  if (const auto voxel = voxel_from_letter(drawn)) return *voxel;
  throw node.error(fmt::format("unknown letter '{}'{}; allowed: . empty, R rigid, S soft, # fixed",
                               drawn, place));
}

// ---- painting an object ---------------------------------------------------------

// A matrix of empty cells, to be painted; links and a name come when it is cut out.
Object blank(const Node& node, Cell at, int rows, int cols) {
  const long cells = static_cast<long>(rows) * cols;
  if (cells > most_cells)
    throw node.error(
        fmt::format("{} x {} cells are too many (at most {})", rows, cols, most_cells));
  Object canvas{"", {}, at.x, at.y};
  canvas.body.rows = rows;
  canvas.body.cols = cols;
  canvas.body.cells.assign(static_cast<std::size_t>(cells), Voxel::empty);
  return canvas;
}

Object blank(const Node& node, Cell at, const std::vector<std::string>& drawing) {
  return blank(node, at, static_cast<int>(drawing.size()),
               static_cast<int>(drawing.front().size()));
}

// What one `rows`, or one `size` with `fill`, says.
Object paint_shape(const Mapping& shape, Cell at) {
  const auto rows = shape.find("rows");
  const auto size = shape.find("size");
  if (rows.has_value() == size.has_value())
    throw shape.node().error("either `rows` or `size` with `fill` is expected");
  if (rows) {
    if (const auto fill = shape.find("fill"))
      throw fill->error("`fill` goes with `size`, not with `rows`");
    const std::vector<std::string> drawing = read_drawing(*rows);
    Object canvas = blank(*rows, at, drawing);
    auto cell = canvas.body.cells.begin();
    for (std::size_t row = 0; row < drawing.size(); ++row)
      for (std::size_t col = 0; col < drawing[row].size(); ++col)
        *cell++ = read_voxel(*rows, drawing[row][col],
                             fmt::format(" in row {}, column {}", row + 1, col + 1));
    return canvas;
  }
  const auto& pair = size->items();
  if (pair.size() != 2) throw size->error("a size [columns, rows] is expected");
  const int cols = pair[0].integer(1, largest_coordinate);
  const int lines = pair[1].integer(1, largest_coordinate);
  const Node fill = shape.at("fill");
  const std::string text = fill.string();
  if (text.size() != 1) throw fill.error("one letter is expected, found " + fill.found());
  Object canvas = blank(*size, at, lines, cols);
  std::fill(canvas.body.cells.begin(), canvas.body.cells.end(), read_voxel(fill, text[0], ""));
  return canvas;
}

// Parts one over the other, the last one on top; empty cells erase.
Object paint_parts(const Node& node, Cell at) {
  std::vector<Object> parts;
  Cell low{largest_coordinate, largest_coordinate};
  Cell high;
  for (const Node& item : node.items()) {
    const Mapping part(item, "part", {"at", "rows", "size", "fill"});
    const auto offset = part.find("at");
    const Cell cell = offset ? read_cell(*offset, 0) : Cell{};
    parts.push_back(paint_shape(part, {at.x + cell.x, at.y + cell.y}));
    const Object& painted = parts.back();
    low = {std::min(low.x, painted.x), std::min(low.y, painted.y)};
    high = {std::max(high.x, painted.x + painted.body.cols),
            std::max(high.y, painted.y + painted.body.rows)};
  }
  if (parts.empty()) throw node.error("at least one part is expected");
  Object whole = blank(node, low, high.y - low.y, high.x - low.x);
  for (const Object& part : parts) {
    const int top = high.y - (part.y + part.body.rows);  // row of the part's first row
    for (int row = 0; row < part.body.rows; ++row)
      std::copy_n(part.body.cells.begin() + part.body.index(row, 0), part.body.cols,
                  whole.body.cells.begin() + whole.body.index(top + row, part.x - low.x));
  }
  return whole;
}

// ---- from canvas to object --------------------------------------------------------

void check_body(const Node& node, const std::string& name, const Body& body) {
  if (const auto problem = defect(body, false))
    throw node.error(fmt::format("object '{}': {}", name, *problem));
  if (count_actuators(body) > 0)
    throw node.error(
        fmt::format("object '{}' has actuators (H, V), which only the robot may have", name));
}

// Cut to its cells, as the benchmark stores objects: the start coordinates of a
// point follow from the matrix it is in (docs/physics.md, "Points").
Object cut_out(const Node& node, const std::string& name, Object canvas,
               const std::optional<Node>& connections) {
  const auto box = extent(canvas.body);
  if (box.bottom < 0) throw node.error(fmt::format("object '{}' has no cell", name));
  std::vector<Voxel> cells;
  for (int row = box.top; row <= box.bottom; ++row)
    for (int col = box.left; col <= box.right; ++col) cells.push_back(canvas.body.at(row, col));

  Object object{name, Body(box.rows(), box.cols(), std::move(cells)), canvas.x + box.left,
                canvas.y + canvas.body.rows - 1 - box.bottom};
  if (connections) {
    read_links(*connections, canvas.body);
    object.body.links.clear();
    const auto moved = [&](int cell) {
      return object.body.index(cell / canvas.body.cols - box.top,
                               cell % canvas.body.cols - box.left);
    };
    for (const Link& link : canvas.body.links)
      object.body.links.push_back({moved(link.a), moved(link.b)});
  }
  check_body(node, name, object.body);
  return object;
}

void check_name(const Node& node, const std::string& name) {
  if (name == robot_name)
    throw node.error("the name 'robot' belongs to the robot; its place is the task's `robot`");
  if (finite_number(name))
    throw node.error("a name is expected for an object, found " + node.found());
}

// "" or the name of a drawn integer.
std::string read_offset(const Node& node, const std::vector<DrawnInteger>& draws) {
  if (node.is_null() || node.found() == "'0'") return "";
  std::vector<std::string> names;
  names.reserve(draws.size());
  for (const DrawnInteger& drawn : draws) names.push_back(drawn.name);
  return node.choice("draw", names);
}

Placement read_object(const Node& name_node, const Node& node,
                      const std::vector<DrawnInteger>& draws) {
  const std::string name = name_node.string();
  check_name(name_node, name);
  const Mapping object(node, fmt::format("object '{}'", name),
                       {"at", "offset", "rows", "size", "fill", "parts", "connections"});
  const auto at = object.find("at");
  const Cell cell = at ? read_cell(*at, 0) : Cell{};

  Placement placement;
  const auto parts = object.find("parts");
  const auto connections = object.find("connections");
  if (parts) {
    for (const char* key : {"rows", "size", "fill", "connections"})
      if (const auto extra = object.find(key))
        throw extra->error(fmt::format("`{}` does not go with `parts`", key));
    placement.object = cut_out(node, name, paint_parts(*parts, cell), std::nullopt);
  } else {
    if (!object.has("rows") && !object.has("size"))
      throw node.error(
          fmt::format("object '{}' needs `rows`, or `size` with `fill`, or `parts`", name));
    placement.object = cut_out(node, name, paint_shape(object, cell), connections);
  }
  if (const auto offset = object.find("offset")) {
    const auto& axes = offset->items();
    if (axes.size() != 2)
      throw offset->error("an offset [x, y] of names of draws (or 0) is expected");
    placement.offset_x = read_offset(axes[0], draws);
    placement.offset_y = read_offset(axes[1], draws);
  }
  return placement;
}

// ---- a picture of several objects ---------------------------------------------------

struct Legend {
  struct Meaning {
    std::string object;
    Voxel voxel = Voxel::empty;
  };
  std::vector<std::string> objects;  // in the order first named
  std::map<char, Meaning> letters;
};

Legend read_legend(const Node& node) {
  Legend legend;
  for (const auto& [key, value] : node.entries()) {
    const std::string letter = key.string();
    if (letter.size() != 1 || letter == ".")
      throw key.error("one letter (not '.') is expected in a legend, found " + key.found());
    Legend::Meaning meaning;
    if (value.is_mapping()) {  // {object: beam, voxel: R}
      const Mapping entry(value, "legend", {"object", "voxel"});
      meaning.object = entry.at("object").string();
      const Node voxel = entry.at("voxel");
      const std::string drawn = voxel.string();
      if (drawn.size() != 1) throw voxel.error("one letter is expected, found " + voxel.found());
      meaning.voxel = read_voxel(voxel, drawn[0], "");
    } else {  // the letter itself says which voxel
      meaning.object = value.string();
      meaning.voxel = read_voxel(key, letter[0], "; a letter of your own needs {object:, voxel:}");
    }
    if (meaning.voxel == Voxel::empty) throw value.error("a legend cannot mean an empty cell");
    check_name(value, meaning.object);
    legend.letters[letter[0]] = meaning;
    if (std::find(legend.objects.begin(), legend.objects.end(), meaning.object) ==
        legend.objects.end())
      legend.objects.push_back(meaning.object);
  }
  return legend;
}

std::vector<Placement> read_picture(const Node& node, const Node& legend_node) {
  const std::vector<std::string> drawing = read_drawing(node);
  const Legend legend = read_legend(legend_node);
  std::map<std::string, Object> canvases;
  for (const std::string& name : legend.objects) canvases[name] = blank(node, Cell{}, drawing);
  for (std::size_t row = 0; row < drawing.size(); ++row) {
    for (std::size_t col = 0; col < drawing[row].size(); ++col) {
      const char drawn = drawing[row][col];
      if (drawn == '.') continue;
      const auto meaning = legend.letters.find(drawn);
      if (meaning == legend.letters.end())
        throw node.error(fmt::format("letter '{}' in row {}, column {} is not in the legend", drawn,
                                     row + 1, col + 1));
      Body& body = canvases[meaning->second.object].body;
      body.cells[row * drawing.front().size() + col] = meaning->second.voxel;
    }
  }
  std::vector<Placement> objects;
  for (const std::string& name : legend.objects)
    objects.push_back({cut_out(node, name, std::move(canvases[name]), std::nullopt), "", ""});
  return objects;
}

// ---- a file of Evolution Gym's design tool ---------------------------------------------

std::vector<Placement> read_world_file(const Node& node, const std::filesystem::path& folder) {
  World world;
  try {
    world = read_evogym_world(folder / node.string());
  } catch (const Error& failure) {
    throw node.error(failure.what());
  }
  std::vector<Placement> placements;
  for (Object& object : world.objects) {
    check_name(node, object.name);
    check_body(node, object.name, object.body);
    placements.push_back({std::move(object), "", ""});
  }
  return placements;
}

// ---- the whole world ------------------------------------------------------------------

void append(std::vector<Placement>& placements, std::vector<Placement> more) {
  std::move(more.begin(), more.end(), std::back_inserter(placements));
}

int lowest(const std::string& draw, const std::vector<DrawnInteger>& draws) {
  for (const DrawnInteger& drawn : draws)
    if (drawn.name == draw) return drawn.low;
  return 0;
}

// Where they lie with the lowest draws.
void check_objects(const Node& node, const std::vector<Placement>& placements,
                   const std::vector<DrawnInteger>& draws) {
  World world;
  for (const auto& [object, offset_x, offset_y] : placements) {
    world.objects.push_back(object);
    world.objects.back().x += lowest(offset_x, draws);
    world.objects.back().y += lowest(offset_y, draws);
  }
  if (const auto wrong = defect(world))
    throw node.error(wrong->text + (draws.empty() ? "" : ", with the lowest draws"));
}

}  // namespace

std::vector<Placement> world_from_yaml(const Node& node, const std::filesystem::path& folder,
                                       const std::vector<DrawnInteger>& draws) {
  std::vector<Placement> placements;
  if (node.is_scalar()) {
    placements = read_world_file(node, folder);
  } else {
    const Mapping world(node, "world", {"file", "drawing", "legend", "objects"});
    if (const auto file = world.find("file")) placements = read_world_file(*file, folder);
    if (const auto drawing = world.find("drawing"))
      append(placements, read_picture(*drawing, world.at("legend")));
    else if (const auto legend = world.find("legend"))
      throw legend->error("a `legend` goes with a `drawing`");
    if (const auto objects = world.find("objects"))
      for (const auto& [name, object] : objects->entries())
        placements.push_back(read_object(name, object, draws));
  }
  check_objects(node, placements, draws);
  return placements;
}

// ---- writing ----------------------------------------------------------------------------

std::string yaml_scalar(const std::string& text) { return compact(Json(text)); }

namespace {

bool is_uniform(const Body& body) {
  return std::all_of(body.cells.begin(), body.cells.end(),
                     [&](Voxel voxel) { return voxel == body.cells.front(); });
}

std::string offset_name(const std::string& name) { return name.empty() ? "0" : yaml_scalar(name); }

}  // namespace

std::string world_to_yaml(const std::vector<Placement>& objects) {
  if (objects.empty()) return "  objects: {}\n";
  std::string text = "  objects:\n";
  for (const Placement& placement : objects) {
    const Object& object = placement.object;
    const Body& body = object.body;
    text +=
        fmt::format("    {}:\n      at: [{}, {}]\n", yaml_scalar(object.name), object.x, object.y);
    if (!placement.offset_x.empty() || !placement.offset_y.empty())
      text += fmt::format("      offset: [{}, {}]\n", offset_name(placement.offset_x),
                          offset_name(placement.offset_y));
    if (is_uniform(body)) {
      text += fmt::format("      size: [{}, {}]\n      fill: \"{}\"\n", body.cols, body.rows,
                          letter(body.cells.front()));
    } else {
      text += "      rows: |\n";
      for (const std::string& row : body.to_rows()) text += "        " + row + "\n";
    }
    if (body.links != full_links(body.rows, body.cols, body.cells)) {
      text += "      connections: [";
      for (std::size_t i = 0; i < body.links.size(); ++i)
        text += fmt::format("{}[{}, {}]", i == 0 ? "" : ", ", body.links[i].a, body.links[i].b);
      text += "]\n";
    }
  }
  return text;
}

}  // namespace evo
