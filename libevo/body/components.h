// Connected components of cells, grown link by link (disjoint sets: union under
// the smaller root, path halving). Private to libevo/body.
#pragma once

#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace evo {

class Components {
 public:
  explicit Components(std::size_t cells) : parent_(cells) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  // A cell that nothing is joined to any more, by itself again.
  void reset(int cell) { parent(cell) = cell; }

  // The cell that stands for the component of `cell`: its smallest.
  int root(int cell) {
    while (parent(cell) != cell) {
      parent(cell) = parent(parent(cell));
      cell = parent(cell);
    }
    return cell;
  }

  // Whether the two were apart until now.
  bool join(int a, int b) {
    a = root(a);
    b = root(b);
    if (a == b) return false;
    if (a > b) std::swap(a, b);
    parent(b) = a;
    return true;
  }

 private:
  int& parent(int cell) { return parent_[static_cast<std::size_t>(cell)]; }

  std::vector<int> parent_;
};

}  // namespace evo
