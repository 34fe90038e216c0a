#include "libevo/sim/contact_search.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace evo {

using contact::gap;
using contact::Points;
using contact::reach_slack;
using contact::within;

// ---- cells near each other ---------------------------------------------------------

NearCells::Axis::Axis(double low, double high, double pitch) : low_(low) {
  constexpr double most = 64.0;
  const double count = (high - low) / pitch;
  pitch_ = count < most ? pitch : (high - low) / most;
  tiles = count < most ? static_cast<std::size_t>(std::max(count, 0.0)) + 1
                       : static_cast<std::size_t>(most) + 1;
}

std::size_t NearCells::Axis::of(double x) const {
  const double n = (x - low_) / pitch_;
  if (!(n > 0.0)) return 0;  // what is not a number, too
  return n < static_cast<double>(tiles) ? static_cast<std::size_t>(n) : tiles - 1;
}

void NearCells::start(const std::vector<Box>& boxes, double gap, double pitch) {
  boxes_ = &boxes;
  gap_ = gap;
  if (boxes.size() <= few) return;
  widest_ = {};
  Vec2 low{HUGE_VAL, HUGE_VAL};
  Vec2 high{-HUGE_VAL, -HUGE_VAL};
  for (const Box& box : boxes) {  // what is not a number counts nowhere, and is near nothing
    low = {std::min(low.x, box.low.x), std::min(low.y, box.low.y)};
    high = {std::max(high.x, box.low.x), std::max(high.y, box.low.y)};
    widest_ = {std::max(widest_.x, box.high.x - box.low.x),
               std::max(widest_.y, box.high.y - box.low.y)};
  }
  x_ = {low.x, high.x, pitch};
  y_ = {low.y, high.y, pitch};

  ends_.assign(x_.tiles * y_.tiles + 1, 0);
  for (const Box& box : boxes) ++ends_[tile(box) + 1];
  for (std::size_t t = 1; t < ends_.size(); ++t) ends_[t] += ends_[t - 1];
  cells_.resize(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i)
    cells_[ends_[tile(boxes[i])]++] = static_cast<std::uint32_t>(i);
}

const std::vector<std::uint32_t>& NearCells::before(std::uint32_t i) {
  const Box& box = (*boxes_)[i];
  const double gap = gap_ + reach_slack;
  found_.clear();
  if (boxes_->size() <= few) {
    for (std::uint32_t k = i; k-- > 0;)
      if (within(box, (*boxes_)[k], gap_)) found_.push_back(k);
    return found_;
  }
  const std::size_t x_last = x_.of(box.high.x + gap);
  const std::size_t y_last = y_.of(box.high.y + gap);
  for (std::size_t y = y_.of(box.low.y - gap - widest_.y); y <= y_last; ++y) {
    for (std::size_t x = x_.of(box.low.x - gap - widest_.x); x <= x_last; ++x) {
      const std::size_t t = y * x_.tiles + x;
      for (std::uint32_t k = t == 0 ? 0 : ends_[t - 1]; k < ends_[t] && cells_[k] < i; ++k)
        if (within(box, (*boxes_)[cells_[k]], gap_)) found_.push_back(cells_[k]);
    }
  }
  std::sort(found_.begin(), found_.end(), std::greater<>());
  return found_;
}

// ---- lists -------------------------------------------------------------------------

namespace {

// Corners of cell a, round the cell, that are near cell b, whose box is given, and no corner
// of it.
void list_corners(const Model::Compiled& world, const Points& points, std::uint32_t a,
                  std::uint32_t b, const Box& box, double skin, ContactCandidates& found) {
  const SurfaceCell& cell = world.surface[b];
  for (const std::uint32_t k : {top_left, top_right, bottom_right, bottom_left}) {
    const std::int32_t corner = world.surface[a].corners[k];
    if (!within(points(corner), box, skin)) continue;
    if (std::find(cell.corners.begin(), cell.corners.end(), corner) != cell.corners.end()) continue;
    found.all.push_back({4 * a + k, b});
  }
}

// Static cells of the world's grid near a box.
template <class F>
void terrain_near(const TerrainGrid& grid, const Box& box, double cell_length, double skin, F f) {
  if (grid.cells.empty()) return;
  const auto line = [&](double x, int first, int count) {
    const double c = std::floor(x / cell_length) - first;
    return c > 0.0 ? (c < count ? static_cast<int>(c) : count) : 0;  // NaN: 0
  };
  const int x0 = line(box.low.x - skin, grid.x0, grid.width);
  const int x1 = line(box.high.x + skin + cell_length, grid.x0, grid.width);
  const int y0 = line(box.low.y - skin, grid.y0, grid.height);
  const int y1 = line(box.high.y + skin + cell_length, grid.y0, grid.height);
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

}  // namespace

// Into the listing, and into a copy without the other lanes: searches read that one.
void ContactSearch::copy_positions(const PlanBlock& block, const PointView& view, double* listing) {
  for (int site = block.first; site < block.first + block.count; ++site) {
    const auto s = static_cast<std::size_t>(site);
    const std::size_t o = pair_offset(site, view.stride);
    positions_[2 * s] = listing[o] = view.position[o];
    positions_[2 * s + 1] = listing[o + view.stride] = view.position[o + view.stride];
  }
}

void ContactSearch::find_self(const Model::Compiled& world, std::size_t block,
                              const PointView& view, double* listing, ContactLists& lists) {
  const auto object = static_cast<std::size_t>(world.object_of_block[block]);
  const SurfaceRange& range = world.surface_ranges[object];
  const double skin = self_skin * world.length_scale;
  ContactLists::Self& list = lists.self[block];
  positions_.resize(2 * static_cast<std::size_t>(world.plan.sites));
  copy_positions(world.plan.blocks[block], view, listing);
  const Points points(world, {.position = positions_.data()});

  boxes_.clear();
  for (int c = range.first; c < range.first + range.count; ++c)
    boxes_.push_back(points.box(world.surface[static_cast<std::size_t>(c)]));

  // Pairs of cells from the last to the first, corners of either in the other. Each
  // pair pushes twice (contact.cpp).
  list.candidates.all.clear();
  list.folding.clear();
  near_.start(boxes_, skin, 1.5 * world.physics.voxel_length);
  const auto first = static_cast<std::uint32_t>(range.first);
  for (auto i = static_cast<std::uint32_t>(range.count); i-- > 0;) {
    for (const std::uint32_t j : near_.before(i)) {
      const std::uint32_t a = first + i;
      const std::uint32_t b = first + j;
      list_corners(world, points, a, b, boxes_[j], skin, list.candidates);
      list_corners(world, points, b, a, boxes_[i], skin, list.candidates);
      const SurfaceCell& one = world.surface[a];
      const SurfaceCell& other = world.surface[b];
      const bool adjacent =
          std::abs(one.row - other.row) <= 1 && std::abs(one.col - other.col) <= 1;
      if (!adjacent) list.folding.push_back({a, b});
    }
  }
  list.candidates.all_are_due();
  const bool can_fold = world.is_robot[object] != 0 &&
                        2 * list.folding.size() > static_cast<std::size_t>(range.count);
  if (!can_fold) list.folding.clear();
  list.folding_due = 0.0;
  const auto both = static_cast<std::uint32_t>(block);
  list.group = {0, list.candidates.count(), {both, both}, 0.0};
  list.valid = true;
}

void ContactSearch::find_terrain_pairs(const Model::Compiled& world, const SurfaceRange& range) {
  for (int m = range.first; m < range.first + range.count; ++m) {
    const auto a = static_cast<std::uint32_t>(m);
    terrain_near(world.terrain, boxes_[a], world.physics.voxel_length,
                 terrain_skin * world.length_scale, [&](std::uint32_t b) {
                   const bool in_order = world.surface[a].object < world.surface[b].object;
                   const std::uint32_t first = in_order ? a : b;
                   const std::uint32_t second = in_order ? b : a;
                   cell_pairs_.push_back({order(world, first, second), first, second});
                 });
  }
}

void ContactSearch::find_moving_pairs(const Model::Compiled& world, int i, int j) {
  const double skin = moving_skin * world.length_scale;
  const Box& box_i = object_boxes_[static_cast<std::size_t>(i)];
  const Box& box_j = object_boxes_[static_cast<std::size_t>(j)];
  if (!within(box_i, box_j, skin)) return;
  const SurfaceRange& range_i = world.surface_ranges[static_cast<std::size_t>(i)];
  const SurfaceRange& range_j = world.surface_ranges[static_cast<std::size_t>(j)];
  reachable_.clear();
  for (int n = range_j.first; n < range_j.first + range_j.count; ++n)
    if (within(boxes_[static_cast<std::size_t>(n)], box_i, skin))
      reachable_.push_back(static_cast<std::uint32_t>(n));
  for (int m = range_i.first; m < range_i.first + range_i.count; ++m) {
    const auto a = static_cast<std::uint32_t>(m);
    if (!within(boxes_[a], box_j, skin)) continue;
    for (const std::uint32_t b : reachable_)
      if (within(boxes_[a], boxes_[b], skin)) cell_pairs_.push_back({order(world, a, b), a, b});
  }
}

void ContactSearch::find_pairs(const Model::Compiled& world, const PointView& view, double* listing,
                               ContactLists& lists) {
  positions_.resize(2 * static_cast<std::size_t>(world.plan.sites));
  for (const PlanBlock& block : world.plan.blocks) copy_positions(block, view, listing);
  const Points points(world, {.position = positions_.data()});
  const int objects = static_cast<int>(world.objects.size());
  boxes_.resize(world.surface.size());
  object_boxes_.resize(world.objects.size());
  for (int i = 0; i < objects; ++i) {
    if (world.objects[static_cast<std::size_t>(i)].is_static) continue;
    const SurfaceRange& range = world.surface_ranges[static_cast<std::size_t>(i)];
    Box& all = object_boxes_[static_cast<std::size_t>(i)];
    for (int c = range.first; c < range.first + range.count; ++c) {
      const Box box = boxes_[static_cast<std::size_t>(c)] =
          points.box(world.surface[static_cast<std::size_t>(c)]);
      all = c == range.first ? box : around(all, box);
    }
  }

  cell_pairs_.clear();
  for (int i = 0; i < objects; ++i) {
    if (world.objects[static_cast<std::size_t>(i)].is_static) continue;
    find_terrain_pairs(world, world.surface_ranges[static_cast<std::size_t>(i)]);
    for (int j = i + 1; j < objects; ++j)
      if (!world.objects[static_cast<std::size_t>(j)].is_static) find_moving_pairs(world, i, j);
  }
  std::sort(cell_pairs_.begin(), cell_pairs_.end(),
            [](const CellPair& p, const CellPair& q) { return p.order < q.order; });
  list_pairs(world, lists);
}

// From pairs of cells to corners and cells, grouped by pairs of objects.
void ContactSearch::list_pairs(const Model::Compiled& world, ContactLists& lists) {
  const Points points(world, {.position = positions_.data()});
  lists.pairs.all.clear();
  lists.groups.clear();
  std::size_t object = 0;
  int partner = -1;
  for (const auto& [unused, a, b] : cell_pairs_) {
    const int i = world.surface[a].object;
    const int j = world.surface[b].object;
    if (object <= static_cast<std::size_t>(i) || partner != j) {
      for (; object <= static_cast<std::size_t>(i); ++object)
        lists.first_group[object] = static_cast<std::uint32_t>(lists.groups.size());
      partner = j;
      const std::uint32_t first = lists.pairs.count();
      lists.groups.push_back({first, first, {travel_block(world, i), travel_block(world, j)}, 0.0});
    }
    const bool terrain = world.is_static(world.surface[a]) || world.is_static(world.surface[b]);
    const double skin = (terrain ? terrain_skin : moving_skin) * world.length_scale;
    const auto box = [&](std::uint32_t i) {
      const SurfaceCell& cell = world.surface[i];
      return world.is_static(cell) ? points.box(cell) : boxes_[i];
    };
    list_corners(world, points, a, b, box(b), skin, lists.pairs);
    list_corners(world, points, b, a, box(a), skin, lists.pairs);
    lists.groups.back().last = lists.pairs.count();
  }
  lists.pairs.all_are_due();
  for (; object < lists.first_group.size(); ++object)
    lists.first_group[object] = static_cast<std::uint32_t>(lists.groups.size());
  lists.pairs_valid = true;
}

// ---- folding -------------------------------------------------------------------------

bool ContactSearch::is_folding(const Model::Compiled& world, ContactLists& lists,
                               const PointView& view) {
  for (std::size_t block = 0; block < lists.self.size(); ++block) {
    ContactLists::Self& self = lists.self[block];
    if (self.folding.empty()) continue;
    const Points points(world, view);
    // Two points come nearer by at most twice the travel of their block.
    const double travel = 2.0 * points.travel(static_cast<std::uint32_t>(block));
    if (travel < self.folding_due) continue;
    const SurfaceRange& range =
        world.surface_ranges[static_cast<std::size_t>(world.object_of_block[block])];
    boxes_.clear();
    for (int c = range.first; c < range.first + range.count; ++c)
      boxes_.push_back(points.box(world.surface[static_cast<std::size_t>(c)]));
    const auto first = static_cast<std::size_t>(range.first);
    gaps_.clear();
    std::ptrdiff_t overlaps = 0;
    for (const auto& [a, b] : self.folding) {
      const bool overlap = within(boxes_[a - first], boxes_[b - first], 0.0);
      overlaps += overlap ? 1 : 0;
      gaps_.push_back(overlap ? 0.0 : gap(boxes_[a - first], boxes_[b - first]));
    }
    if (2 * overlaps > range.count) return true;
    // More pairs than half its cells must overlap: not before the last of so many does.
    const auto last = gaps_.begin() + range.count / 2;
    std::nth_element(gaps_.begin(), last, gaps_.end());
    self.folding_due = travel + *last - reach_slack;
  }
  return false;
}

}  // namespace evo
