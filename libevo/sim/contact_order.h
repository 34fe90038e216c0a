// The order in which the forces between two objects, or of one with itself, are added up
// (docs/physics.md, "Order of contacts"): that of the benchmark's search through their
// bounding trees. Which of two nodes it opens depends on where the objects are now.
//
// The search is not made. Two pairs of cells are met one after the other until a node that
// holds the first cells of both is opened, or one that holds the second ones of both: their
// lowest common nodes. Areas only fall on the way down and the larger of two nodes is opened
// first, so of those two common nodes the larger one is, whatever was opened before.
#pragma once

#include <cstdint>
#include <span>

#include "libevo/sim/contact_geometry.h"
#include "libevo/sim/contact_lists.h"

namespace evo::contact {

// What is pushed when the search meets two cells, by their leaves in the trees of the first
// and the second object; pushes are the caller's.
struct Meeting {
  std::int32_t a = 0;
  std::int32_t b = 0;
  std::uint32_t pushes = 0;
};

class SearchOrder {
 public:
  SearchOrder(const Model::Compiled& world, const Points& points, ContactLists& lists, int first,
              int second)
      : a_(world, points, lists, first),
        b_(world, points, lists, second),
        is_within_(first == second) {}

  void sort(std::span<Meeting> meetings) const;

 private:
  // The boxes of an object's tree. The last one that was found of a node often tells enough:
  // no side of it has moved farther since than the points of the object.
  class Tree {
   public:
    Tree(const Model::Compiled& world, const Points& points, ContactLists& lists, int object);

    // The node at which the ways to two leaves part.
    std::int32_t common(std::int32_t i, std::int32_t j) const;
    double area(std::int32_t node) const;

    struct Range {
      double low, high;
    };
    Range area_within(std::int32_t node) const;

   private:
    const Model::Compiled& world_;
    const Points& points_;
    const BoundingTree& tree_;
    std::span<NodeBox> boxes_;  // empty: it never moves
    std::uint32_t look_;
    std::uint32_t first_cell_;
    double travel_;
  };

  bool is_before(const Meeting& p, const Meeting& q) const;

  Tree a_;
  Tree b_;
  bool is_within_;  // the objects are one
};

}  // namespace evo::contact
