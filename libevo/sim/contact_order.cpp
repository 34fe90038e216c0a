#include "libevo/sim/contact_order.h"

#include <algorithm>

namespace evo::contact {

SearchOrder::Boxes::Boxes(const Model::Compiled& world, const Points& points, int object)
    : world_(world),
      points_(points),
      tree_(world.trees[static_cast<std::size_t>(object)]),
      first_cell_(
          static_cast<std::uint32_t>(world.surface_ranges[static_cast<std::size_t>(object)].first)),
      is_static_(world.block[static_cast<std::size_t>(object)] < 0) {}

double SearchOrder::Boxes::area(std::int32_t i) {
  if (is_static_) return node(i).area;
  const Box& now = box(i);
  return (now.high.x - now.low.x) * (now.high.y - now.low.y);
}

const Box& SearchOrder::Boxes::box(std::int32_t i) {
  if (known_.empty()) {
    boxes_.resize(tree_.nodes.size());
    known_.resize(tree_.nodes.size());
  }
  const auto at = static_cast<std::size_t>(i);
  if (known_[at]) return boxes_[at];
  known_[at] = true;
  if (node(i).left < 0) {
    const auto cell =
        static_cast<std::uint32_t>(tree_.leaves[static_cast<std::size_t>(node(i).first)]);
    return boxes_[at] = points_.box(cell_of(world_, first_cell_ + cell));
  }
  const Box& left = box(node(i).left);
  const Box& right = box(node(i).right);
  return boxes_[at] = {{std::min(left.low.x, right.low.x), std::min(left.low.y, right.low.y)},
                       {std::max(left.high.x, right.high.x), std::max(left.high.y, right.high.y)}};
}

void SearchOrder::sort(std::vector<TouchingCells>& touching) {
  if (touching.size() < 2) return;
  for (TouchingCells& cells : touching) {
    cells.a = a_.tree().leaf_of[static_cast<std::size_t>(cells.a)];
    cells.b = b_.tree().leaf_of[static_cast<std::size_t>(cells.b)];
  }
  sort(a_.root(), b_.root(), touching);
}

// The search opens one of two nodes, the larger if it can, the second of equals never, and
// goes on with its left and then its right part.
void SearchOrder::sort(std::int32_t a, std::int32_t b, std::span<TouchingCells> touching) {
  if (touching.size() < 2) return;
  const BoundingTree::Node& of_a = a_.node(a);
  const BoundingTree::Node& of_b = b_.node(b);
  const bool opens_b = of_b.left >= 0 && (of_a.left < 0 || a_.area(a) < b_.area(b));
  const std::int32_t left_ends = opens_b ? b_.node(of_b.left).last : a_.node(of_a.left).last;
  const auto right = std::stable_partition(
      touching.begin(), touching.end(),
      [&](const TouchingCells& cells) { return (opens_b ? cells.b : cells.a) < left_ends; });
  const std::span<TouchingCells> lefts(touching.begin(), right);
  const std::span<TouchingCells> rights(right, touching.end());
  sort(opens_b ? a : of_a.left, opens_b ? of_b.left : b, lefts);
  sort(opens_b ? a : of_a.right, opens_b ? of_b.right : b, rights);
}

}  // namespace evo::contact
