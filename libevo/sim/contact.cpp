#include "libevo/sim/contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "libevo/base/elementary.h"

namespace evo {
namespace {

// ---- small geometry --------------------------------------------------------------

constexpr double reach_slack = 1e-9;  // raw length, far above all roundings

struct V {
  double x = 0.0;
  double y = 0.0;
};
V operator+(V a, V b) { return {a.x + b.x, a.y + b.y}; }
V operator-(V a, V b) { return {a.x - b.x, a.y - b.y}; }
V operator*(V a, double s) { return {a.x * s, a.y * s}; }
V operator/(V a, double s) { return {a.x / s, a.y / s}; }
double dot(V a, V b) { return a.x * b.x + a.y * b.y; }
double cross(V a, V b) { return a.x * b.y - a.y * b.x; }
double norm(V a) { return std::sqrt(dot(a, a)); }

struct Box {
  V low;
  V high;
};

// Boxes that touch overlap.
bool within(const Box& a, const Box& b, double gap) {
  return a.low.x - gap <= b.high.x && b.low.x - gap <= a.high.x && a.low.y - gap <= b.high.y &&
         b.low.y - gap <= a.high.y;
}
// Along the axis on which they are farther apart; 0 for what is not a number.
double gap(const Box& a, const Box& b) {
  const double x = std::max(a.low.x - b.high.x, b.low.x - a.high.x);
  const double y = std::max(a.low.y - b.high.y, b.low.y - a.high.y);
  return std::max({0.0, x, y});
}
bool within(V p, const Box& b, double gap) {
  return b.low.x - gap <= p.x && p.x <= b.high.x + gap && b.low.y - gap <= p.y &&
         p.y <= b.high.y + gap;
}

struct Quad {
  V top_left, top_right, bottom_left, bottom_right;
};

// One value for either triangle of a cell: the upper one, which has its top right
// corner, and the lower one, which has its bottom left. (Of GCC and Clang.)
using Two [[gnu::vector_size(2 * sizeof(double))]] = double;
Two smaller(Two a, Two b) { return a < b ? a : b; }
Two larger(Two a, Two b) { return a > b ? a : b; }

// How far the points may move relative to each other before the sign of the cross
// product of u and v can change, but for roundings: x = |u x v| changes by at most
// r (|u| + |v| + r) when both change by r, and r <= x / (|u| + |v|). `size` is that
// sum, or more.
Two reach(Two product, Two size) {
  const Two x = larger(product, -product);
  return x * size / (size * size + x);
}

// Whether p is inside: in one of the two triangles of the cell, borders included.
// The benchmark's test, which only looks at signs. If not, by how much the points
// may move relative to each other, by any path, before it can become true.
struct Clearance {
  bool inside = false;
  double distance = 0.0;
};
// Both triangles at once: which one comes to matter is more than a branch can guess.
Clearance clearance(V p, const Quad& q) {
  const auto size = [](V v) { return std::abs(v.x) + std::abs(v.y); };
  const V tl = q.top_left - p;
  const V tr = q.top_right - p;
  const V bl = q.bottom_left - p;
  const V br = q.bottom_right - p;
  const Two side_x{tr.x, bl.x};
  const Two side_y{tr.y, bl.y};
  const Two first = tl.x * side_y - tl.y * side_x;
  const Two second = side_x * br.y - side_y * br.x;
  const double c = cross(br, tl);
  const auto first_alike = c * first >= 0.0;
  const auto second_alike = c * second >= 0.0;
  const auto inside = first_alike & second_alike;
  if ((inside[0] | inside[1]) != 0) return {true, 0.0};
  const Two none{};
  const Two side_size{size(tr), size(bl)};
  const Two beside = larger(first_alike ? none : reach(first, size(tl) + side_size),
                            second_alike ? none : reach(second, size(br) + side_size));
  const Two all = smaller(beside, reach(none + c, none + (size(tl) + size(br))));
  return {false, std::min(all[0], all[1]) - reach_slack};
}

// ---- points of the world -----------------------------------------------------------

class Points {
 public:
  Points(const Model::Compiled& world, const PointView& view)
      : view_(view), slots_(world.plan.slots), terrain_(world.static_points.data()) {}

  bool moves(std::int32_t slot) const { return slot < slots_; }
  V operator()(std::int32_t slot) const {
    if (!moves(slot)) return {terrain_[slot - slots_].x, terrain_[slot - slots_].y};
    const double* p = view_.position + offset(slot);
    return {p[0], p[view_.stride]};
  }
  V previous(std::int32_t slot) const {
    if (!moves(slot)) return (*this)(slot);
    const double* p = view_.previous + offset(slot);
    return {p[0], p[view_.stride]};
  }
  void add_force(std::int32_t slot, V f) const {
    if (!moves(slot)) return;
    double* force = view_.force + offset(slot) * view_.force_spacing;
    force[0] += f.x;
    force[view_.stride] += f.y;
  }
  double travel(std::uint32_t block) const { return view_.travel[block * view_.stride]; }
  Quad quad(const ContactCell& c) const {
    return {(*this)(c.corners[top_left]), (*this)(c.corners[top_right]),
            (*this)(c.corners[bottom_left]), (*this)(c.corners[bottom_right])};
  }
  Box box(const ContactCell& c) const {
    const Quad q = quad(c);
    const auto [x0, x1] =
        std::minmax({q.top_left.x, q.top_right.x, q.bottom_left.x, q.bottom_right.x});
    const auto [y0, y1] =
        std::minmax({q.top_left.y, q.top_right.y, q.bottom_left.y, q.bottom_right.y});
    return {{x0, y0}, {x1, y1}};
  }

 private:
  std::size_t offset(std::int32_t slot) const {
    return 2 * static_cast<std::size_t>(slot) * view_.stride;
  }

  PointView view_;
  std::int32_t slots_;
  const Vec2* terrain_;
};

const ContactCell& cell_of(const Model::Compiled& world, std::uint32_t cell) {
  return world.contact_cells[cell];
}

// ---- finding -------------------------------------------------------------------------

// A pair of cells that are near each other, with its place in the order in
// which contacts are handled.
struct CellPair {
  std::uint64_t order;
  std::uint32_t a;
  std::uint32_t b;
};

// Scratch memory of the calling thread, so that finding does not allocate.
struct Scratch {
  std::vector<Box> boxes;                            // of the surface cells of one or all objects
  std::vector<Box> object_boxes;                     // of all objects
  std::vector<std::uint32_t> reachable;              // surface cells of one object near another one
  std::vector<std::uint32_t> tile_ends, tile_cells;  // of NearCells
  std::vector<std::uint32_t> near;
  std::vector<CellPair> cell_pairs;
  std::vector<double> gaps;  // between the cells that count for folding
};
Scratch& scratch() {
  thread_local Scratch memory;
  return memory;
}

// Corners of cell a that are near cell b, whose box is given, and no corner of it.
void list_corners(const Model::Compiled& world, const Points& points, std::uint32_t a,
                  std::uint32_t b, const Box& box, double skin,
                  std::vector<ContactCandidate>& found) {
  const ContactCell& cell = cell_of(world, b);
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::int32_t corner = cell_of(world, a).corners[k];
    if (!within(points(corner), box, skin)) continue;
    if (std::find(cell.corners.begin(), cell.corners.end(), corner) != cell.corners.end()) continue;
    found.push_back({4 * a + k, b, 0.0});
  }
}

// Which of an object's boxes are near each other. Boxes are dealt to tiles by their
// lower left corners, so that each is compared with few others.
class NearCells {
 public:
  NearCells(const std::vector<Box>& boxes, double gap, double pitch) : boxes_(boxes), gap_(gap) {
    V low{HUGE_VAL, HUGE_VAL};
    V high{-HUGE_VAL, -HUGE_VAL};
    for (const Box& box : boxes) {  // what is not a number counts nowhere, and is near nothing
      low = {std::min(low.x, box.low.x), std::min(low.y, box.low.y)};
      high = {std::max(high.x, box.low.x), std::max(high.y, box.low.y)};
      widest_ = {std::max(widest_.x, box.high.x - box.low.x),
                 std::max(widest_.y, box.high.y - box.low.y)};
    }
    x_ = {low.x, high.x, pitch};
    y_ = {low.y, high.y, pitch};

    std::vector<std::uint32_t>& ends = scratch().tile_ends;
    std::vector<std::uint32_t>& cells = scratch().tile_cells;
    ends.assign(x_.tiles * y_.tiles + 1, 0);
    for (const Box& box : boxes) ++ends[tile(box) + 1];
    for (std::size_t t = 1; t < ends.size(); ++t) ends[t] += ends[t - 1];
    cells.resize(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
      cells[ends[tile(boxes[i])]++] = static_cast<std::uint32_t>(i);
  }

  // Those before `i` that are near it, the last first; good until the next call.
  const std::vector<std::uint32_t>& before(std::uint32_t i) const {
    const Box& box = boxes_[i];
    const double gap = gap_ + reach_slack;
    const std::vector<std::uint32_t>& ends = scratch().tile_ends;
    const std::vector<std::uint32_t>& cells = scratch().tile_cells;
    std::vector<std::uint32_t>& found = scratch().near;
    found.clear();
    const std::size_t x_last = x_.of(box.high.x + gap);
    const std::size_t y_last = y_.of(box.high.y + gap);
    for (std::size_t y = y_.of(box.low.y - gap - widest_.y); y <= y_last; ++y) {
      for (std::size_t x = x_.of(box.low.x - gap - widest_.x); x <= x_last; ++x) {
        const std::size_t t = y * x_.tiles + x;
        for (std::uint32_t k = t == 0 ? 0 : ends[t - 1]; k < ends[t] && cells[k] < i; ++k)
          if (within(box, boxes_[cells[k]], gap_)) found.push_back(cells[k]);
      }
    }
    std::sort(found.begin(), found.end(), std::greater<>());
    return found;
  }

 private:
  struct Axis {
    Axis() = default;
    Axis(double low, double high, double pitch) : low_(low) {
      constexpr double most = 64.0;
      const double count = (high - low) / pitch;
      pitch_ = count < most ? pitch : (high - low) / most;
      tiles = count < most ? static_cast<std::size_t>(std::max(count, 0.0)) + 1
                           : static_cast<std::size_t>(most) + 1;
    }
    std::size_t of(double x) const {
      const double n = (x - low_) / pitch_;
      if (!(n > 0.0)) return 0;  // what is not a number, too
      return n < static_cast<double>(tiles) ? static_cast<std::size_t>(n) : tiles - 1;
    }
    std::size_t tiles = 1;

   private:
    double low_ = 0.0;
    double pitch_ = 1.0;
  };

  std::size_t tile(const Box& box) const { return y_.of(box.low.y) * x_.tiles + x_.of(box.low.x); }

  const std::vector<Box>& boxes_;
  double gap_;
  V widest_;
  Axis x_, y_;
};

// Reads the positions of all slots of a block into the reference of a list.
void copy_reference(const PlanBlock& block, const PointView& view, std::vector<double>& reference) {
  for (int slot = block.first; slot < block.first + block.count; ++slot) {
    const auto s = static_cast<std::size_t>(slot);
    reference[2 * s] = view.position[2 * s * view.stride];
    reference[2 * s + 1] = view.position[2 * s * view.stride + view.stride];
  }
}

// Static cells of the world's grid near a box.
template <class F>
void terrain_near(const TerrainGrid& grid, const Box& box, double cell_length, F f) {
  if (grid.cells.empty()) return;
  const auto line = [&](double x, int first, int count) {
    const double c = std::floor(x / cell_length) - first;
    return c > 0.0 ? (c < count ? static_cast<int>(c) : count) : 0;  // NaN: 0
  };
  const int x0 = line(box.low.x - terrain_skin, grid.x0, grid.width);
  const int x1 = line(box.high.x + terrain_skin + cell_length, grid.x0, grid.width);
  const int y0 = line(box.low.y - terrain_skin, grid.y0, grid.height);
  const int y1 = line(box.high.y + terrain_skin + cell_length, grid.y0, grid.height);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const std::int32_t cell =
          grid.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width) +
                     static_cast<std::size_t>(x)];
      if (cell >= 0) f(static_cast<std::uint32_t>(cell));
    }
  }
}

// The order in which contacts between objects are handled: pairs of objects
// (i, j) by i, then j; their cells by a, then b. Limits in compile.cpp make
// the fields fit.
std::uint64_t order(const Model::Compiled& world, std::uint32_t a, std::uint32_t b) {
  const auto i = static_cast<std::uint64_t>(world.surface[a].object);
  const auto j = static_cast<std::uint64_t>(world.surface[b].object);
  return i << 54 | j << 44 | std::uint64_t{a} << 22 | b;
}

// Where the travel of an object stands.
std::uint32_t travel_block(const Model::Compiled& world, int object) {
  const int block = world.block[static_cast<std::size_t>(object)];
  return block >= 0 ? static_cast<std::uint32_t>(block)
                    : static_cast<std::uint32_t>(world.plan.blocks.size());
}

void find_terrain_pairs(const Model::Compiled& world, const SurfaceRange& range,
                        const std::vector<Box>& boxes) {
  for (int m = range.first; m < range.first + range.count; ++m) {
    const auto a = static_cast<std::uint32_t>(m);
    terrain_near(world.terrain, boxes[a], world.physics.voxel_length, [&](std::uint32_t b) {
      const bool in_order = world.surface[a].object < world.surface[b].object;
      const std::uint32_t first = in_order ? a : b;
      const std::uint32_t second = in_order ? b : a;
      scratch().cell_pairs.push_back({order(world, first, second), first, second});
    });
  }
}

void find_moving_pairs(const Model::Compiled& world, int i, int j, const std::vector<Box>& boxes,
                       const std::vector<Box>& object_boxes) {
  const Box& box_i = object_boxes[static_cast<std::size_t>(i)];
  const Box& box_j = object_boxes[static_cast<std::size_t>(j)];
  if (!within(box_i, box_j, moving_skin)) return;
  const SurfaceRange& range_i = world.surface_ranges[static_cast<std::size_t>(i)];
  const SurfaceRange& range_j = world.surface_ranges[static_cast<std::size_t>(j)];
  std::vector<std::uint32_t>& reachable = scratch().reachable;
  reachable.clear();
  for (int n = range_j.first; n < range_j.first + range_j.count; ++n)
    if (within(boxes[static_cast<std::size_t>(n)], box_i, moving_skin))
      reachable.push_back(static_cast<std::uint32_t>(n));
  for (int m = range_i.first; m < range_i.first + range_i.count; ++m) {
    const auto a = static_cast<std::uint32_t>(m);
    if (!within(boxes[a], box_j, moving_skin)) continue;
    for (const std::uint32_t b : reachable)
      if (within(boxes[a], boxes[b], moving_skin))
        scratch().cell_pairs.push_back({order(world, a, b), a, b});
  }
}

}  // namespace

void prepare_lists(const Model::Compiled& world, ContactLists& lists) {
  lists.self.resize(world.plan.blocks.size());
  lists.first_group.assign(world.objects.size() + 1, 0);
  lists.self_reference.assign(2 * static_cast<std::size_t>(world.plan.slots), 0.0);
  lists.pair_reference.assign(2 * static_cast<std::size_t>(world.plan.slots), 0.0);
  lists.invalidate();
}

void find_self_contacts(const Model::Compiled& world, int object, const PointView& view,
                        ContactLists& lists) {
  const SurfaceRange& range = world.surface_ranges[static_cast<std::size_t>(object)];
  const auto block = static_cast<std::size_t>(world.block[static_cast<std::size_t>(object)]);
  ContactLists::Self& list = lists.self[block];
  // The reference is a copy without the other lanes: read that one.
  copy_reference(world.plan.blocks[block], view, lists.self_reference);
  const Points points(world, {.position = lists.self_reference.data()});

  std::vector<Box>& boxes = scratch().boxes;
  boxes.clear();
  for (int c = range.first; c < range.first + range.count; ++c)
    boxes.push_back(points.box(world.contact_cells[static_cast<std::size_t>(c)]));

  // Pairs of cells from the last to the first, each pair twice, as (a, b) and
  // as (b, a), corners of either in the other.
  list.candidates.clear();
  list.folding.clear();
  const NearCells near(boxes, self_skin, 1.5 * world.physics.voxel_length);
  const auto first = static_cast<std::uint32_t>(range.first);
  for (auto i = static_cast<std::uint32_t>(range.count); i-- > 0;) {
    for (const std::uint32_t j : near.before(i)) {
      const std::uint32_t a = first + i;
      const std::uint32_t b = first + j;
      const std::size_t start = list.candidates.size();
      list_corners(world, points, a, b, boxes[j], self_skin, list.candidates);
      const std::size_t middle = list.candidates.size();
      list_corners(world, points, b, a, boxes[i], self_skin, list.candidates);
      const std::size_t end = list.candidates.size();
      for (std::size_t k = middle; k < end; ++k) list.candidates.push_back(list.candidates[k]);
      for (std::size_t k = start; k < middle; ++k) list.candidates.push_back(list.candidates[k]);
      const SurfaceCell& one = world.surface[a];
      const SurfaceCell& other = world.surface[b];
      const bool adjacent =
          std::abs(one.row - other.row) <= 1 && std::abs(one.col - other.col) <= 1;
      if (!adjacent) list.folding.push_back({a, b});
    }
  }
  const bool can_fold = world.is_robot[static_cast<std::size_t>(object)] != 0 &&
                        2 * list.folding.size() > static_cast<std::size_t>(range.count);
  if (!can_fold) list.folding.clear();
  list.folding_due = 0.0;
  const auto both = static_cast<std::uint32_t>(block);
  list.group = {0, static_cast<std::uint32_t>(list.candidates.size()), {both, both}, 0.0};
  list.valid = true;
}

void find_pair_contacts(const Model::Compiled& world, const PointView& view, ContactLists& lists) {
  for (const PlanBlock& block : world.plan.blocks)
    copy_reference(block, view, lists.pair_reference);
  const Points points(world, {.position = lists.pair_reference.data()});
  const int objects = static_cast<int>(world.objects.size());
  std::vector<Box>& boxes = scratch().boxes;
  std::vector<Box>& object_boxes = scratch().object_boxes;
  boxes.resize(world.surface.size());
  object_boxes.resize(world.objects.size());
  for (int i = 0; i < objects; ++i) {
    if (world.objects[static_cast<std::size_t>(i)].is_static) continue;
    const SurfaceRange& range = world.surface_ranges[static_cast<std::size_t>(i)];
    Box& all = object_boxes[static_cast<std::size_t>(i)];
    for (int c = range.first; c < range.first + range.count; ++c) {
      const Box box = boxes[static_cast<std::size_t>(c)] =
          points.box(world.contact_cells[static_cast<std::size_t>(c)]);
      if (c == range.first) all = box;
      all.low = {std::min(all.low.x, box.low.x), std::min(all.low.y, box.low.y)};
      all.high = {std::max(all.high.x, box.high.x), std::max(all.high.y, box.high.y)};
    }
  }

  std::vector<CellPair>& cell_pairs = scratch().cell_pairs;
  cell_pairs.clear();
  for (int i = 0; i < objects; ++i) {
    if (world.objects[static_cast<std::size_t>(i)].is_static) continue;
    find_terrain_pairs(world, world.surface_ranges[static_cast<std::size_t>(i)], boxes);
    for (int j = i + 1; j < objects; ++j)
      if (!world.objects[static_cast<std::size_t>(j)].is_static)
        find_moving_pairs(world, i, j, boxes, object_boxes);
  }
  std::sort(cell_pairs.begin(), cell_pairs.end(),
            [](const CellPair& p, const CellPair& q) { return p.order < q.order; });

  lists.pairs.clear();
  lists.groups.clear();
  std::size_t object = 0;
  int partner = -1;
  for (const auto& [unused, a, b] : cell_pairs) {
    const int i = world.surface[a].object;
    const int j = world.surface[b].object;
    if (object <= static_cast<std::size_t>(i) || partner != j) {
      for (; object <= static_cast<std::size_t>(i); ++object)
        lists.first_group[object] = static_cast<std::uint32_t>(lists.groups.size());
      partner = j;
      const auto first = static_cast<std::uint32_t>(lists.pairs.size());
      lists.groups.push_back({first, first, {travel_block(world, i), travel_block(world, j)}, 0.0});
    }
    const bool terrain = cell_of(world, a).is_static || cell_of(world, b).is_static;
    const double skin = terrain ? terrain_skin : moving_skin;
    const auto box = [&](std::uint32_t cell) {
      return cell_of(world, cell).is_static ? points.box(cell_of(world, cell)) : boxes[cell];
    };
    list_corners(world, points, a, b, box(b), skin, lists.pairs);
    list_corners(world, points, b, a, box(a), skin, lists.pairs);
    lists.groups.back().last = static_cast<std::uint32_t>(lists.pairs.size());
  }
  for (; object < lists.first_group.size(); ++object)
    lists.first_group[object] = static_cast<std::uint32_t>(lists.groups.size());
  lists.pairs_valid = true;
}

// ---- pushing -------------------------------------------------------------------------

namespace {

constexpr double parallel_determinant = 1e-4;  // raw area: edges nearer to parallel never cross
constexpr double shortest_edge = 1e-6;         // raw length
constexpr double far_away = 1000.0;            // distance to an edge that is shorter

class Pusher {
 public:
  Pusher(const Model::Compiled& world, const PointView& view)
      : world_(world), physics_(world.physics), points_(world, view) {}

  // Of the candidates of a group, those that are inside.
  bool push(ContactGroup& group, std::vector<ContactCandidate>& candidates) const {
    const double travel = points_.travel(group.blocks[0]) + points_.travel(group.blocks[1]);
    if (travel < group.due) return false;
    bool any = false;
    group.due = HUGE_VAL;
    for (std::uint32_t i = group.first; i < group.last; ++i) {
      ContactCandidate& candidate = candidates[i];
      if (!(travel < candidate.due)) any |= push(candidate, travel);
      group.due = std::min(group.due, candidate.due);
    }
    return any;
  }

 private:
  using Edge = std::array<std::int32_t, 2>;

  bool push(ContactCandidate& candidate, double travel) const {
    const ContactCell& cell = cell_of(world_, candidate.cell);
    const ContactCell& owner = cell_of(world_, candidate.corner / 4);
    const std::uint32_t corner = candidate.corner % 4;
    const std::int32_t point = owner.corners[corner];
    const V p = points_(point);
    const Clearance clear = clearance(p, points_.quad(cell));
    candidate.due = travel + clear.distance;
    if (!clear.inside) return false;

    static constexpr std::array<std::array<Side, 2>, 4> probes{
        {{top, left}, {top, right}, {bottom, left}, {bottom, right}}};
    const Edge& probe1 = owner.edges[probes[corner][0]];
    const Edge& probe2 = owner.edges[probes[corner][1]];
    const Edge* nearest = nullptr;
    double depth = 0.0;
    for (const Side side : {top, right, bottom, left}) {
      if (!cell.surface[side]) continue;
      const Edge& edge = cell.edges[side];
      if (!cross_each_other(probe1, edge) && !cross_each_other(probe2, edge)) continue;
      const double distance = distance_to_line(p, edge);
      if (nearest == nullptr || distance < depth) {
        nearest = &edge;
        depth = distance;
      }
    }
    if (nearest == nullptr) return false;
    apply(point, *nearest, depth);
    return true;
  }

  bool cross_each_other(const Edge& probe, const Edge& edge) const {
    const V a1 = points_(probe[0]);
    const V a2 = points_(edge[0]);
    const V d1 = points_(probe[1]) - a1;
    const V d2 = points_(edge[1]) - a2;
    const double det = -d1.x * d2.y + d2.x * d1.y;
    if (std::abs(det) < parallel_determinant) return false;
    const V d = a2 - a1;
    const double t = (-d2.y * d.x + d2.x * d.y) / det;
    const double s = (-d1.y * d.x + d1.x * d.y) / det;
    return t >= 0.0 && t <= 1.0 && s >= 0.0 && s <= 1.0;
  }

  double distance_to_line(V p, const Edge& edge) const {
    const V a = points_(edge[0]);
    const V along = points_(edge[1]) - a;
    const double length = norm(along);
    if (length < shortest_edge) return far_away;
    return std::abs(cross(along, p - a)) / length;
  }

  // Velocity as friction and damping feel it: strain limiting included.
  V true_velocity(std::int32_t slot) const {
    return (points_(slot) - points_.previous(slot)) / physics_.substep;
  }

  // Roundings as in the specification: every product in this order.
  void apply(std::int32_t point, const Edge& edge, double depth) const {
    const auto [a, b] = edge;
    const V along = points_(b) - points_(a);
    const V n = V{-along.y, along.x} / norm(along);
    const V force = n * physics_.contact_stiffness * (depth + physics_.contact_margin);
    const V velocity = true_velocity(point);
    const auto damping = [&](V v) { return n * dot(n, v) * physics_.contact_damping; };
    points_.add_force(point, force - damping(velocity));
    push_back(a, force / 2.0 + damping(true_velocity(a)) / 2.0);
    push_back(b, force / 2.0 + damping(true_velocity(b)) / 2.0);

    V t{-n.y, n.x};
    t = t / norm(t);
    double slip = dot(t, velocity);
    if (slip < 0.0) {
      slip = -slip;
      t = t * -1.0;
    }
    const double pressure = norm(force);
    const double grip = math::tanh(slip / (physics_.friction_coefficient * pressure));
    const V friction =
        t * -1.0 * physics_.friction_multiplier * physics_.friction_coefficient * pressure * grip;
    points_.add_force(point, friction);
    push_back(a, friction / 2.0);
    push_back(b, friction / 2.0);
  }

  void push_back(std::int32_t slot, V f) const { points_.add_force(slot, f * -1.0); }

  const Model::Compiled& world_;
  const Physics& physics_;
  Points points_;
};

}  // namespace

bool push_contacts(const Model::Compiled& world, ContactLists& lists, const PointView& view) {
  const Pusher pusher(world, view);
  bool any = false;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (world.block[i] >= 0) {
      ContactLists::Self& self = lists.self[static_cast<std::size_t>(world.block[i])];
      any |= pusher.push(self.group, self.candidates);
    }
    for (std::uint32_t g = lists.first_group[i]; g < lists.first_group[i + 1]; ++g)
      any |= pusher.push(lists.groups[g], lists.pairs);
  }
  return any;
}

bool is_folding(const Model::Compiled& world, ContactLists& lists, const PointView& view) {
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (world.block[i] < 0) continue;
    ContactLists::Self& self = lists.self[static_cast<std::size_t>(world.block[i])];
    if (self.folding.empty()) continue;
    const Points points(world, view);
    // Two points come nearer by at most twice the travel of their block.
    const double travel = 2.0 * points.travel(static_cast<std::uint32_t>(world.block[i]));
    if (travel < self.folding_due) continue;
    const SurfaceRange& range = world.surface_ranges[i];
    std::vector<Box>& boxes = scratch().boxes;
    boxes.clear();
    for (int c = range.first; c < range.first + range.count; ++c)
      boxes.push_back(points.box(world.contact_cells[static_cast<std::size_t>(c)]));
    const auto first = static_cast<std::size_t>(range.first);
    std::vector<double>& gaps = scratch().gaps;
    gaps.clear();
    std::ptrdiff_t overlaps = 0;
    for (const auto& [a, b] : self.folding) {
      const bool overlap = within(boxes[a - first], boxes[b - first], 0.0);
      overlaps += overlap ? 1 : 0;
      gaps.push_back(overlap ? 0.0 : gap(boxes[a - first], boxes[b - first]));
    }
    if (2 * overlaps > range.count) return true;
    // More pairs than half its cells must overlap: not before the last of so many does.
    const auto last = gaps.begin() + range.count / 2;
    std::nth_element(gaps.begin(), last, gaps.end());
    self.folding_due = travel + *last - reach_slack;
  }
  return false;
}

}  // namespace evo
