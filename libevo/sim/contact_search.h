// Finding contacts: which corners may come to touch which cells (the first of the
// two steps of contact.h), and whether a robot folds onto itself. With memory of
// its own, one per thread, so that finding does not allocate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libevo/sim/contact_geometry.h"

namespace evo {

// Which of an object's boxes are near each other. Where there are many, they are dealt
// to tiles by their lower left corners, so that each is compared with few others.
class NearCells {
 public:
  // `boxes` outlive the search; near is what `gap` or less lies between.
  void start(const std::vector<Box>& boxes, double gap, double pitch);

  // Those before `i` that are near it, the last first; good until the next call.
  const std::vector<std::uint32_t>& before(std::uint32_t i);

 private:
  static constexpr std::size_t few = 40;  // boxes that are compared faster than dealt

  struct Axis {
    Axis() = default;
    Axis(double low, double high, double pitch);
    std::size_t of(double x) const;
    std::size_t tiles = 1;

   private:
    double low_ = 0.0;
    double pitch_ = 1.0;
  };

  std::size_t tile(const Box& box) const { return y_.of(box.low.y) * x_.tiles + x_.of(box.low.x); }

  const std::vector<Box>* boxes_ = nullptr;
  double gap_ = 0.0;
  Vec2 widest_;
  Axis x_, y_;
  std::vector<std::uint32_t> ends_;   // [tiles + 1] where the cells of each end in cells_
  std::vector<std::uint32_t> cells_;  // by tile, in order within one
  std::vector<std::uint32_t> found_;
};

class ContactSearch {
 public:
  // Lists anew what a moving object, block of the plan, may do to itself. `listing`,
  // laid out as the positions of `view`, gets the positions of the block.
  void find_self(const Model::Compiled& world, std::size_t block, const PointView& view,
                 double* listing, ContactLists& lists);
  // The same of all pairs of objects that are not both static.
  void find_pairs(const Model::Compiled& world, const PointView& view, double* listing,
                  ContactLists& lists);

  // Whether any robot is folded onto itself.
  bool is_folding(const Model::Compiled& world, ContactLists& lists, const PointView& view);

 private:
  // A pair of cells that are near each other, with its place in the order in
  // which contacts are handled.
  struct CellPair {
    std::uint64_t order;
    std::uint32_t a;
    std::uint32_t b;
  };

  void copy_positions(const PlanBlock& block, const PointView& view, double* listing);
  void find_terrain_pairs(const Model::Compiled& world, const SurfaceRange& range);
  void find_moving_pairs(const Model::Compiled& world, int i, int j);
  void list_pairs(const Model::Compiled& world, ContactLists& lists);

  std::vector<double> positions_;         // [sites x 2] of one environment alone
  std::vector<Box> boxes_;                // of the surface cells of one or all objects
  std::vector<Box> object_boxes_;         // of all objects
  std::vector<std::uint32_t> reachable_;  // surface cells of one object near another one
  std::vector<CellPair> cell_pairs_;
  std::vector<double> gaps_;  // between the cells that count for folding
  NearCells near_;
};

}  // namespace evo
