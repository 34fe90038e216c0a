// The tree of bounding boxes over an object's surface cells in which the benchmark's
// simulator looks for contacts. evo finds them otherwise (contact_search.h); the tree says
// in which order their forces are added (docs/physics.md, "Order of contacts").
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libevo/sim/vec2.h"

namespace evo {

struct BoundingTree {
  struct Node {
    std::int32_t left = -1;  // nodes; -1 for a leaf
    std::int32_t right = -1;
    std::int32_t parent = -1;
    std::int32_t first = 0;  // its leaves are [first, last) of `leaves`
    std::int32_t last = 0;
    double area = 0.0;  // at the start: of what never moves, for good
  };
  std::vector<Node> nodes;            // children before parents, the root last
  std::vector<std::int32_t> leaves;   // surface cells of the object, from 0, left to right
  std::vector<std::int32_t> leaf_of;  // of each surface cell, its place among the leaves
  std::vector<std::int32_t> node_of_leaf;
};

// What the tree is made from: a surface cell at the start.
struct TreeCell {
  int number = 0;  // among all cells of the object
  int row = 0;
  int col = 0;
  std::array<bool, 4> linked{};           // by Side
  std::array<bool, 4> linked_diagonal{};  // by Corner: over two links
  Box box;
};

// How many cells a tree may have: it takes their square of time.
inline constexpr std::size_t max_tree_cells = 20753;

BoundingTree make_bounding_tree(std::span<const TreeCell> cells);

}  // namespace evo
