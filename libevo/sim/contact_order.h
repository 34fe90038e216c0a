// The order in which the benchmark's package adds up the forces between two objects, or of
// one with itself (docs/physics.md, "The package's order"): that of its search through
// their bounding trees. Which of two nodes it opens depends on where the objects are now.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libevo/sim/contact_geometry.h"

namespace evo::contact {

// Surface cells that touch: `a` of the first object and `b` of the second, counted from
// each object's first; `number` is the caller's.
struct TouchingCells {
  std::int32_t a = 0;
  std::int32_t b = 0;
  std::size_t number = 0;
};

// Puts them into the order in which the search meets them.
class SearchOrder {
 public:
  SearchOrder(const Model::Compiled& world, const Points& points, int first, int second)
      : a_(world, points, first), b_(world, points, second) {}

  void sort(std::vector<TouchingCells>& touching);

 private:
  // A tree with the boxes of now.
  class Boxes {
   public:
    Boxes(const Model::Compiled& world, const Points& points, int object);

    const BoundingTree& tree() const { return tree_; }
    std::int32_t root() const { return static_cast<std::int32_t>(tree_.nodes.size()) - 1; }
    const BoundingTree::Node& node(std::int32_t i) const {
      return tree_.nodes[static_cast<std::size_t>(i)];
    }
    double area(std::int32_t i);

   private:
    const Box& box(std::int32_t i);

    const Model::Compiled& world_;
    const Points& points_;
    const BoundingTree& tree_;
    std::uint32_t first_cell_;
    bool is_static_;
    std::vector<Box> boxes_;  // of each node, once it is asked for
    std::vector<bool> known_;
  };

  void sort(std::int32_t a, std::int32_t b, std::span<TouchingCells> touching);

  Boxes a_;
  Boxes b_;
};

}  // namespace evo::contact
