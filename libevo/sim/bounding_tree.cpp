#include "libevo/sim/bounding_tree.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "libevo/sim/compiled.h"

namespace evo {
namespace {

// Numbers in the order in which the std::unordered_set<int> of GNU's C++ library lists
// them: the package takes the first of equally good pairs from one. A number goes in front
// of those in its bucket, or else to the very front; a set that grows is dealt anew.
class HashOrder {
 public:
  void insert(int number) {
    if (std::find(numbers_.begin(), numbers_.end(), number) != numbers_.end()) return;
    if (numbers_.size() == buckets_) grow();
    deal(number);
  }
  void erase(int number) {
    numbers_.erase(std::remove(numbers_.begin(), numbers_.end(), number), numbers_.end());
  }
  const std::vector<int>& numbers() const { return numbers_; }

 private:
  void deal(int number) {
    const auto bucket = [&](int n) { return static_cast<std::size_t>(n) % buckets_; };
    const auto at = std::find_if(numbers_.begin(), numbers_.end(),
                                 [&](int n) { return bucket(n) == bucket(number); });
    numbers_.insert(at == numbers_.end() ? numbers_.begin() : at, number);
  }
  void grow() {
    static constexpr std::array<std::size_t, 11> sizes{13,   29,   59,   127,   257,  541,
                                                       1109, 2357, 5087, 10273, 20753};
    const auto size = std::upper_bound(sizes.begin(), sizes.end(), buckets_);
    assert(size != sizes.end());
    buckets_ = *size;
    for (const int number : std::exchange(numbers_, {})) deal(number);
  }

  std::vector<int> numbers_;
  std::size_t buckets_ = 0;
};

struct Draft {
  Box box;
  std::array<int, 2> children{-1, -1};
  int cell = -1;
  bool is_free = true;  // not yet a child
  HashOrder neighbours;
};

double area(const Box& box) { return (box.high.x - box.low.x) * (box.high.y - box.low.y); }

// Leaves in the package's order of surface cells.
std::vector<Draft> draft_leaves(std::span<const TreeCell> cells) {
  HashOrder order;
  std::map<int, int> index;  // of `cells`, by number
  for (std::size_t i = 0; i < cells.size(); ++i) {
    order.insert(cells[i].number);
    index[cells[i].number] = static_cast<int>(i);
  }
  std::vector<Draft> nodes;
  std::map<std::pair<int, int>, int> node_at;
  for (const int number : order.numbers()) {
    const TreeCell& cell = cells[static_cast<std::size_t>(index[number])];
    node_at[{cell.row, cell.col}] = static_cast<int>(nodes.size());
    Draft& node = nodes.emplace_back();
    node.box = cell.box;
    node.cell = index[number];
  }
  for (Draft& node : nodes) {
    const TreeCell& cell = cells[static_cast<std::size_t>(node.cell)];
    const auto join = [&](bool is_linked, int down, int across) {
      const auto found = node_at.find({cell.row + down, cell.col + across});
      if (is_linked && found != node_at.end()) node.neighbours.insert(found->second);
    };
    join(cell.linked[top], -1, 0);
    join(cell.linked[bottom], 1, 0);
    join(cell.linked[left], 0, -1);
    join(cell.linked[right], 0, 1);
    if (!node.neighbours.numbers().empty()) continue;
    join(cell.linked_diagonal[top_left], -1, -1);
    join(cell.linked_diagonal[top_right], -1, 1);
    join(cell.linked_diagonal[bottom_left], 1, -1);
    join(cell.linked_diagonal[bottom_right], 1, 1);
  }
  return nodes;
}

// The pair of `free` nodes, which are in their order, whose common box is smallest, the first
// of equals: of neighbours if there are any, else of all.
std::pair<int, int> next_pair(const std::vector<Draft>& nodes, const std::vector<int>& free) {
  std::pair<int, int> pair{-1, -1};
  double smallest = std::numeric_limits<double>::max();
  const auto consider = [&](int i, int j) {
    const Draft& a = nodes[static_cast<std::size_t>(i)];
    const Draft& b = nodes[static_cast<std::size_t>(j)];
    if (!b.is_free) return;
    if (const double both = area(around(a.box, b.box)); both < smallest) {
      smallest = both;
      pair = {i, j};
    }
  };
  for (const int i : free)
    for (const int j : nodes[static_cast<std::size_t>(i)].neighbours.numbers()) consider(i, j);
  if (pair.first >= 0) return pair;
  for (const int i : free)
    for (const int j : free)
      if (i != j) consider(i, j);
  return pair;
}

void merge(std::vector<Draft>& nodes, int i, int j) {
  const int joined = static_cast<int>(nodes.size());
  Draft& a = nodes[static_cast<std::size_t>(i)];
  Draft& b = nodes[static_cast<std::size_t>(j)];
  Draft node;
  node.box = around(a.box, b.box);
  node.children = {i, j};
  a.is_free = b.is_free = false;
  for (const int k : a.neighbours.numbers()) node.neighbours.insert(k);
  for (const int k : b.neighbours.numbers()) node.neighbours.insert(k);
  node.neighbours.erase(i);
  node.neighbours.erase(j);
  for (const int k : node.neighbours.numbers()) {
    HashOrder& of_neighbour = nodes[static_cast<std::size_t>(k)].neighbours;
    of_neighbour.erase(i);
    of_neighbour.erase(j);
    of_neighbour.insert(joined);
  }
  nodes.push_back(std::move(node));
}

}  // namespace

BoundingTree make_bounding_tree(std::span<const TreeCell> cells) {
  std::vector<Draft> drafts = draft_leaves(cells);
  std::vector<int> free(drafts.size());
  std::iota(free.begin(), free.end(), 0);
  while (free.size() > 1) {
    const auto [i, j] = next_pair(drafts, free);
    free.erase(std::find(free.begin(), free.end(), i));
    free.erase(std::find(free.begin(), free.end(), j));
    free.push_back(static_cast<int>(drafts.size()));
    merge(drafts, i, j);
  }

  BoundingTree tree;
  tree.nodes.resize(drafts.size());
  tree.leaf_of.resize(cells.size());
  const auto lay = [&](const auto& self, int i) -> void {
    const Draft& draft = drafts[static_cast<std::size_t>(i)];
    BoundingTree::Node& node = tree.nodes[static_cast<std::size_t>(i)];
    node.left = draft.children[0];
    node.right = draft.children[1];
    node.first = static_cast<std::int32_t>(tree.leaves.size());
    node.area = area(draft.box);
    if (draft.cell >= 0) {
      tree.leaf_of[static_cast<std::size_t>(draft.cell)] = node.first;
      tree.leaves.push_back(draft.cell);
      tree.node_of_leaf.push_back(i);
    } else {
      for (const int child : draft.children) {
        tree.nodes[static_cast<std::size_t>(child)].parent = i;
        self(self, child);
      }
    }
    node.last = static_cast<std::int32_t>(tree.leaves.size());
  };
  if (!drafts.empty()) lay(lay, static_cast<int>(drafts.size()) - 1);
  return tree;
}

}  // namespace evo
