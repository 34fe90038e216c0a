#include "libevo/sim/contact_order.h"

#include <algorithm>
#include <cmath>

namespace evo::contact {

SearchOrder::Tree::Tree(const Model::Compiled& world, const Points& points, ContactLists& lists,
                        int object)
    : world_(world),
      points_(points),
      tree_(world.trees[static_cast<std::size_t>(object)]),
      look_(lists.looks) {
  const auto o = static_cast<std::size_t>(object);
  first_cell_ = static_cast<std::uint32_t>(world.surface_ranges[o].first);
  if (world.block[o] < 0) return;
  const auto block = static_cast<std::uint32_t>(world.block[o]);
  boxes_ = lists.self[block].boxes;
  travel_ = points.travel(block);
}

std::int32_t SearchOrder::Tree::common(std::int32_t i, std::int32_t j) const {
  std::int32_t at = tree_.node_of_leaf[static_cast<std::size_t>(i)];
  for (;; at = tree_.nodes[static_cast<std::size_t>(at)].parent) {
    const BoundingTree::Node& node = tree_.nodes[static_cast<std::size_t>(at)];
    if (node.first <= j && j < node.last) return at;
  }
}

double SearchOrder::Tree::area(std::int32_t i) const {
  const BoundingTree::Node& node = tree_.nodes[static_cast<std::size_t>(i)];
  if (boxes_.empty()) return node.area;
  NodeBox& known = boxes_[static_cast<std::size_t>(i)];
  if (known.look == look_) return known.width * known.height;
  Box all{{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
  for (std::int32_t leaf = node.first; leaf < node.last; ++leaf) {
    const auto cell = static_cast<std::uint32_t>(tree_.leaves[static_cast<std::size_t>(leaf)]);
    all = around(all, points_.box(world_.surface[first_cell_ + cell]));
  }
  const Vec2 size = all.high - all.low;
  known = {size.x, size.y, travel_, look_};
  return size.x * size.y;
}

SearchOrder::Tree::Range SearchOrder::Tree::area_within(std::int32_t i) const {
  if (boxes_.empty()) {
    const double area = tree_.nodes[static_cast<std::size_t>(i)].area;
    return {area, area};
  }
  const NodeBox& box = boxes_[static_cast<std::size_t>(i)];
  const double change = 2.0 * (travel_ - box.travel) + reach_slack;
  return {std::max(0.0, box.width - change) * std::max(0.0, box.height - change),
          (box.width + change) * (box.height + change)};
}

bool SearchOrder::is_before(const Meeting& p, const Meeting& q) const {
  const bool by_a = p.a < q.a;
  const bool by_b = p.b < q.b;
  if (by_a == by_b || p.a == q.a) return by_b;
  if (p.b == q.b) return by_a;
  const std::int32_t in_a = a_.common(p.a, q.a);
  const std::int32_t in_b = b_.common(p.b, q.b);
  if (is_within_ && in_a == in_b) return by_a;
  const Tree::Range a = a_.area_within(in_a);
  const Tree::Range b = b_.area_within(in_b);
  if (a.low > b.high) return by_a;
  if (a.high < b.low) return by_b;
  return a_.area(in_a) < b_.area(in_b) ? by_b : by_a;  // of equals, the first one's
}

void SearchOrder::sort(std::span<Meeting> meetings) const {
  const auto before = [&](const Meeting& p, const Meeting& q) { return is_before(p, q); };
  for (auto it = meetings.begin() + 1; it != meetings.end(); ++it)
    if (is_before(*it, *(it - 1)))
      std::rotate(std::upper_bound(meetings.begin(), it - 1, *it, before), it, it + 1);
}

}  // namespace evo::contact
