// Builds point masses, springs and surfaces of every object in the order that
// the benchmark's simulator creates them (docs/physics.md, "Building an object"): results
// depend on that order to the last bits.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "libevo/base/error.h"
#include "libevo/sim/compiled.h"

namespace evo {
namespace {

constexpr int none = -1;

// One object before it is put into the world; points are numbered from 0.
struct Built {
  struct Cell {
    Voxel type = Voxel::empty;
    int row = 0;
    int col = 0;
    std::array<int, 4> corners{none, none, none, none};
    std::array<int, 4> edges{none, none, none, none};
    std::array<bool, 4> linked{};           // by Side
    std::array<bool, 4> linked_diagonal{};  // by Corner
  };
  std::vector<Cell> cells;  // scan order
  std::vector<Vec2> points;
  std::vector<std::uint8_t> fixed;
  std::vector<Spring> springs;
};

// Builds one object. Cells are addressed by (row, col); those outside the
// matrix are empty and linked to nothing.
class Builder {
 public:
  Builder(const Object& object, const Physics& physics)
      : body_(object.body), physics_(physics), x0_(object.x), y0_(object.y) {
    const std::size_t matrix = body_.cells.size();
    linked_right_.resize(matrix);
    linked_down_.resize(matrix);
    for (const Link& link : body_.links) {
      const auto a = static_cast<std::size_t>(link.a);
      if (link.b == link.a + 1 && body_.cols != 1)
        linked_right_[a] = true;
      else
        linked_down_[a] = true;
    }
    cell_at_.assign(matrix, none);
  }

  Built build() {
    scan_cells();
    make_points();
    make_edges();
    make_diagonals();
    if (!body_.stiffness.empty()) scale_edges();
    return std::move(built_);
  }

 private:
  bool inside(int row, int col) const {
    return row >= 0 && row < body_.rows && col >= 0 && col < body_.cols;
  }
  std::size_t index(int row, int col) const {
    return static_cast<std::size_t>(body_.index(row, col));
  }
  bool right_of(int row, int col) const {
    return inside(row, col) && linked_right_[index(row, col)];
  }
  bool below(int row, int col) const { return inside(row, col) && linked_down_[index(row, col)]; }
  // Whether the cell is linked to its vertical (horizontal) neighbour on one side.
  bool vertical_link(int row, int col, int down) const {
    return down > 0 ? below(row, col) : below(row - 1, col);
  }
  bool horizontal_link(int row, int col, int across) const {
    return across > 0 ? right_of(row, col) : right_of(row, col - 1);
  }
  // Whether two links lead to its diagonal neighbour, either way round.
  bool diagonal_link(int row, int col, int down, int across) const {
    return (vertical_link(row, col, down) && horizontal_link(row + down, col, across)) ||
           (horizontal_link(row, col, across) && vertical_link(row, col + across, down));
  }
  Built::Cell& cell(int row, int col) {
    return built_.cells[static_cast<std::size_t>(cell_at_[index(row, col)])];
  }

  void scan_cells() {
    for (int row = 0; row < body_.rows; ++row) {
      for (int col = 0; col < body_.cols; ++col) {
        if (body_.at(row, col) == Voxel::empty) continue;
        Built::Cell made;
        made.type = body_.at(row, col);
        made.row = row;
        made.col = col;
        made.linked[top] = vertical_link(row, col, -1);
        made.linked[bottom] = vertical_link(row, col, +1);
        made.linked[left] = horizontal_link(row, col, -1);
        made.linked[right] = horizontal_link(row, col, +1);
        for (std::size_t corner = 0; corner < 4; ++corner)
          made.linked_diagonal[corner] = diagonal_link(row, col, down(static_cast<int>(corner)),
                                                       across(static_cast<int>(corner)));
        cell_at_[index(row, col)] = static_cast<int>(built_.cells.size());
        built_.cells.push_back(made);
      }
    }
  }

  // The way to the diagonal neighbour at a corner.
  static int down(int corner) { return corner == bottom_left || corner == bottom_right ? +1 : -1; }
  static int across(int corner) { return corner == top_right || corner == bottom_right ? +1 : -1; }

  // The point that the linked neighbours already have for a corner; the last
  // of vertical, horizontal, diagonal that counts gives it.
  int shared_point(const Built::Cell& c, int corner) {
    const int flip_vertical = corner ^ 2;  // the same corner seen from above or below
    const int flip_horizontal = corner ^ 1;
    const bool vertical = vertical_link(c.row, c.col, down(corner));
    const bool horizontal = horizontal_link(c.row, c.col, across(corner));
    const bool diagonal = c.linked_diagonal[static_cast<std::size_t>(corner)];
    int point = none;
    const auto take = [&](bool counts, int row, int col, int their_corner) {
      if (!counts) return;
      const int theirs = cell(row, col).corners[static_cast<std::size_t>(their_corner)];
      if (theirs != none) point = theirs;
    };
    take(vertical, c.row + down(corner), c.col, flip_vertical);
    take(horizontal, c.row, c.col + across(corner), flip_horizontal);
    take(diagonal, c.row + down(corner), c.col + across(corner), corner ^ 3);
    return point;
  }

  // Every product and sum rounded on its own, in this order: the last bit of a
  // start coordinate decides which contacts exist.
  Vec2 corner_position(int col, int line) const {
    const double length = physics_.voxel_length;
    const double x = col * length + x0_ * length;
    const double y = (body_.rows * length + y0_ * length) - line * length;
    return {x, y};
  }

  void make_points() {
    for (Built::Cell& c : built_.cells) {
      for (int corner = 0; corner < 4; ++corner) {
        int point = shared_point(c, corner);
        if (point == none) {
          point = static_cast<int>(built_.points.size());
          built_.points.push_back(corner_position(c.col + (corner & 1), c.row + (corner >> 1)));
          built_.fixed.push_back(0);
        }
        c.corners[static_cast<std::size_t>(corner)] = point;
      }
    }
    for (const Built::Cell& c : built_.cells)
      if (c.type == Voxel::fixed)
        for (const int point : c.corners) built_.fixed[static_cast<std::size_t>(point)] = 1;
  }

  int add_spring(int a, int b, double rest, double stiffness) {
    built_.springs.push_back({a, b, rest, stiffness});
    return static_cast<int>(built_.springs.size()) - 1;
  }

  // Surface edges run so that their left-hand normal points outwards: the
  // bottom one from right to left, the left one from bottom to top.
  int add_edge(const Built::Cell& c, Side side) {
    static constexpr std::array<std::array<Corner, 2>, 4> inner{{{top_left, top_right},
                                                                 {top_right, bottom_right},
                                                                 {bottom_left, bottom_right},
                                                                 {top_left, bottom_left}}};
    auto [a, b] = inner[side];
    const bool surface = !c.linked[side];
    if (surface && (side == bottom || side == left)) std::swap(a, b);
    return add_spring(c.corners[a], c.corners[b], physics_.voxel_length, physics_.rigid.edge);
  }

  void make_edges() {
    for (Built::Cell& c : built_.cells) {
      c.edges[top] = c.linked[top] ? cell(c.row - 1, c.col).edges[bottom] : add_edge(c, top);
      c.edges[bottom] = add_edge(c, bottom);
      c.edges[left] = c.linked[left] ? cell(c.row, c.col - 1).edges[right] : add_edge(c, left);
      c.edges[right] = add_edge(c, right);
    }
  }

  const SpringStiffness& stiffness(Voxel type) const {
    if (type == Voxel::soft) return physics_.soft;
    if (is_actuator(type)) return physics_.actuator;
    return physics_.rigid;
  }

  void make_diagonals() {
    const double rest = physics_.voxel_length * std::sqrt(2.0);
    for (const Built::Cell& c : built_.cells) {
      const SpringStiffness& k = stiffness(c.type);
      if (c.type == Voxel::soft || is_actuator(c.type))
        for (const int edge : c.edges)
          built_.springs[static_cast<std::size_t>(edge)].stiffness = k.edge;
      const double diagonal = k.diagonal * body_.stiffness_of(index(c.row, c.col));
      add_spring(c.corners[top_right], c.corners[bottom_left], rest, diagonal);
      add_spring(c.corners[top_left], c.corners[bottom_right], rest, diagonal);
    }
  }

  // An edge that two voxels share has the mean of both factors.
  void scale_edges() {
    struct Sum {
      double stiffness = 0.0;
      double voxels = 0.0;
    };
    std::map<int, Sum> sums;
    for (const Built::Cell& c : built_.cells)
      for (const int edge : c.edges) {
        Sum& sum = sums[edge];
        sum.stiffness += built_.springs[static_cast<std::size_t>(edge)].stiffness *
                         body_.stiffness_of(index(c.row, c.col));
        sum.voxels += 1.0;
      }
    for (const auto& [edge, sum] : sums)
      built_.springs[static_cast<std::size_t>(edge)].stiffness = sum.stiffness / sum.voxels;
  }

  const Body& body_;
  const Physics& physics_;
  int x0_;
  int y0_;
  std::vector<bool> linked_right_;
  std::vector<bool> linked_down_;
  std::vector<int> cell_at_;  // of the matrix, into built_.cells
  Built built_;
};

bool is_robot(const Body& body) {
  return std::any_of(body.cells.begin(), body.cells.end(), is_actuator);
}

bool is_static(const Body& body) {
  return std::all_of(body.cells.begin(), body.cells.end(),
                     [](Voxel v) { return v == Voxel::empty || v == Voxel::fixed; });
}

// Objects with an actuator first, then by name.
std::vector<const Object*> world_order(const World& world) {
  std::vector<const Object*> order;
  for (const Object& object : world.objects) order.push_back(&object);
  std::stable_sort(order.begin(), order.end(), [](const Object* a, const Object* b) {
    const bool a_robot = is_robot(a->body);
    const bool b_robot = is_robot(b->body);
    return a_robot != b_robot ? a_robot : a->name < b->name;
  });
  return order;
}

void check(const World& world) {
  for (const Object& object : world.objects)
    if (const auto why = defect(object.body, false))
      throw error(Failure::data, "object '{}': {}", object.name, *why);
  if (const auto wrong = defect(world)) throw error(Failure::data, "{}", wrong->text);
}

bool is_on_surface(const Built::Cell& c) {
  return !(c.linked[top] && c.linked[right] && c.linked[bottom] && c.linked[left]);
}

// Which springs are a voxel's, and by how much each grows with the voxel's factor: what a
// spring's voxels have in common is divided by the sum of their factors.
std::vector<VoxelSpring> voxel_springs(const Body& body, const Built& built) {
  std::vector<VoxelSpring> all;
  std::vector<double> factors(built.springs.size(), 0.0);
  auto diagonal = static_cast<int>(built.springs.size() - 2 * built.cells.size());
  for (std::size_t i = 0; i < built.cells.size(); ++i) {
    const Built::Cell& c = built.cells[i];
    std::vector<int> springs(c.edges.begin(), c.edges.end());
    springs.insert(springs.end(), {diagonal, diagonal + 1});
    diagonal += 2;
    for (const int spring : springs) {
      all.push_back({static_cast<int>(i), spring, 0.0});
      factors[static_cast<std::size_t>(spring)] +=
          body.stiffness_of(static_cast<std::size_t>(body.index(c.row, c.col)));
    }
  }
  for (VoxelSpring& part : all) {
    const auto spring = static_cast<std::size_t>(part.spring);
    part.stiffness = built.springs[spring].stiffness / factors[spring];
  }
  return all;
}

// Adds the finished object's points, springs and cells to the world.
void append(Model::Compiled& world, const Object& object, const Built& built) {
  ModelObject info;
  info.name = object.name;
  info.first_point = static_cast<int>(world.initial_positions.size());
  info.points = static_cast<int>(built.points.size());
  info.first_cell = static_cast<int>(world.cells.size());
  info.cells = static_cast<int>(built.cells.size());
  info.is_static = is_static(object.body);

  const int object_index = static_cast<int>(world.objects.size());
  const int base = info.is_static
                       ? world.moving_points + static_cast<int>(world.static_points.size())
                       : world.dynamics.points;
  const int first_spring = static_cast<int>(world.dynamics.springs.size());
  for (int i = 0; i < info.points; ++i) world.point_indices.push_back(base + i);
  world.initial_positions.insert(world.initial_positions.end(), built.points.begin(),
                                 built.points.end());

  for (const Built::Cell& c : built.cells) {
    ModelCell cell;
    cell.object = object_index;
    cell.type = c.type;
    for (std::size_t k = 0; k < 4; ++k) cell.points[k] = info.first_point + c.corners[k];
    world.cells.push_back(cell);
  }

  SurfaceRange range{static_cast<int>(world.surface.size()), 0};
  for (const Built::Cell& c : built.cells) {
    if (!is_on_surface(c)) continue;
    SurfaceCell s;
    s.object = object_index;
    s.row = c.row;
    s.col = c.col;
    for (std::size_t k = 0; k < 4; ++k) {
      s.corners[k] = base + c.corners[k];
      const Spring& edge = built.springs[static_cast<std::size_t>(c.edges[k])];
      s.edges[k] = {base + edge.a, base + edge.b};
      s.surface[k] = !c.linked[k];
    }
    world.surface.push_back(s);
    ++range.count;
  }
  world.surface_ranges.push_back(range);
  world.is_robot.push_back(is_robot(object.body) ? 1 : 0);
  world.objects.push_back(info);

  if (info.is_static) {
    world.static_points.insert(world.static_points.end(), built.points.begin(), built.points.end());
    return;
  }
  Dynamics& d = world.dynamics;
  d.points += info.points;
  d.fixed.insert(d.fixed.end(), built.fixed.begin(), built.fixed.end());
  for (const Spring& spring : built.springs)
    d.springs.push_back({base + spring.a, base + spring.b, spring.rest, spring.stiffness});
  for (const VoxelSpring& part : voxel_springs(object.body, built))
    world.voxel_springs.push_back(
        {info.first_cell + part.cell, first_spring + part.spring, part.stiffness});
  std::map<int, std::pair<int, int>> driven;  // spring -> its first and last actuator
  for (const Built::Cell& c : built.cells) {
    if (c.type == Voxel::rigid)
      for (const int edge : c.edges) d.rigid_edges.push_back(first_spring + edge);
    if (!is_actuator(c.type)) continue;
    const auto sides =
        c.type == Voxel::horizontal ? std::array{top, bottom} : std::array{left, right};
    for (const Side side : sides) {
      const auto [it, first] =
          driven.emplace(first_spring + c.edges[side], std::pair{d.actuators, d.actuators});
      if (!first) it->second.second = d.actuators;
    }
    ++d.actuators;
  }
  for (const auto& [spring, actuators] : driven)
    d.drives.push_back({spring, actuators.first, actuators.second});
}

// Numbers the moving objects as blocks of the plan; returns the State indices at
// which they start, and the number of points.
std::vector<int> number_blocks(Model::Compiled& world) {
  std::vector<int> first{0};
  for (const ModelObject& object : world.objects) {
    world.block.push_back(object.is_static ? none : static_cast<int>(first.size()) - 1);
    if (object.is_static) continue;
    world.object_of_block.push_back(static_cast<int>(world.block.size()) - 1);
    first.push_back(first.back() + object.points);
  }
  return first;
}

// From indices of points to their sites.
void name_sites(Model::Compiled& world) {
  const auto to_site = [&](std::int32_t& point) {
    if (point < world.moving_points) point = world.plan.site_of[static_cast<std::size_t>(point)];
  };
  for (SurfaceCell& cell : world.surface) {
    for (std::int32_t& corner : cell.corners) to_site(corner);
    for (auto& edge : cell.edges)
      for (std::int32_t& end : edge) to_site(end);
  }
}

// The tree of an object over its surface cells, at the start.
BoundingTree tree_of(const Object& object, const Built& built) {
  std::vector<TreeCell> cells;
  for (std::size_t i = 0; i < built.cells.size(); ++i) {
    const Built::Cell& c = built.cells[i];
    if (!is_on_surface(c)) continue;
    const auto corner = [&](Corner at) {
      return built.points[static_cast<std::size_t>(c.corners[at])];
    };
    cells.push_back({static_cast<int>(i),
                     c.row,
                     c.col,
                     c.linked,
                     c.linked_diagonal,
                     {corner(bottom_left), corner(top_right)}});
  }
  if (cells.size() > max_tree_cells)
    throw error(Failure::data, "object '{}' has {} cells on its surface; at most {} are possible",
                object.name, cells.size(), max_tree_cells);
  return make_bounding_tree(cells);
}

TerrainGrid map_terrain(const Model::Compiled& world, const std::vector<const Object*>& order) {
  const auto world_x = [&](const SurfaceCell& c) {
    return order[static_cast<std::size_t>(c.object)]->x + c.col;
  };
  const auto world_y = [&](const SurfaceCell& c) {
    const Object& object = *order[static_cast<std::size_t>(c.object)];
    return object.y + object.body.rows - 1 - c.row;
  };
  TerrainGrid grid;
  int x1 = 0;
  int y1 = 0;
  bool any = false;
  for (const SurfaceCell& c : world.surface) {
    if (!world.is_static(c)) continue;
    grid.x0 = any ? std::min(grid.x0, world_x(c)) : world_x(c);
    grid.y0 = any ? std::min(grid.y0, world_y(c)) : world_y(c);
    x1 = std::max(x1, world_x(c) + 1);
    y1 = std::max(y1, world_y(c) + 1);
    any = true;
  }
  if (!any) return grid;
  grid.width = x1 - grid.x0;
  grid.height = y1 - grid.y0;
  grid.cells.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height),
                    none);
  for (std::size_t i = 0; i < world.surface.size(); ++i) {
    const SurfaceCell& c = world.surface[i];
    if (!world.is_static(c)) continue;
    const auto row = static_cast<std::size_t>(world_y(c) - grid.y0);
    const auto col = static_cast<std::size_t>(world_x(c) - grid.x0);
    grid.cells[row * static_cast<std::size_t>(grid.width) + col] = static_cast<std::int32_t>(i);
  }
  return grid;
}

}  // namespace

Model::Compiled compile(const World& world, const Physics& physics) {
  check(world);
  Model::Compiled compiled;
  compiled.physics = physics;
  compiled.length_scale = physics.voxel_length / Physics{}.voxel_length;
  const std::vector<const Object*> order = world_order(world);
  std::vector<Built> built;
  built.reserve(order.size());
  for (const Object* object : order) {
    built.push_back(Builder(*object, physics).build());
    if (!is_static(object->body))
      compiled.moving_points += static_cast<int>(built.back().points.size());
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    append(compiled, *order[i], built[i]);
    if (i == 0) compiled.actuators = compiled.dynamics.actuators;
    compiled.trees.push_back(tree_of(*order[i], built[i]));
  }
  if (compiled.objects.size() > max_objects || compiled.surface.size() > max_surface_cells)
    throw error(Failure::data,
                "the world has {} objects with {} surface cells; at most {} and {} are possible",
                compiled.objects.size(), compiled.surface.size(), max_objects, max_surface_cells);
  compiled.plan = make_plan(compiled.dynamics, number_blocks(compiled), physics);
  name_sites(compiled);
  compiled.terrain = map_terrain(compiled, order);
  return compiled;
}

}  // namespace evo
