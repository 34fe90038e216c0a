// The shapes of a world: cells, the borders between them, and outlines.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "formats/rollout/rollout.h"

namespace evo::render {

inline double distance(Vec2 a, Vec2 b) { return std::hypot(a.x - b.x, a.y - b.y); }

// Cells and their borders; made once for all frames.
struct Mesh {
  struct Edge {
    int a = 0;  // points
    int b = 0;
    int cell = 0;    // one of the cells it belongs to
    int other = -1;  // the other one, or -1: a surface
  };
  // Surfaces one after the other, as far as they look alike.
  struct Outline {
    std::vector<int> points;
    bool closed = false;
    bool fixed = false;  // of fixed cells: terrain
  };
  std::vector<ModelObject> objects;
  std::vector<ModelCell> cells;  // of object k: [first_cell, first_cell + cells)
  std::vector<Edge> edges;
  std::vector<std::size_t> first_edge;         // of object k; one more than objects
  std::vector<std::vector<Outline>> outlines;  // of object k

  int object_index(const std::string& name) const;  // -1 when there is none
};
Mesh make_mesh(const RolloutWorld& world);
// One object "robot"; cells that touch without a link have surfaces between
// them. `corners` gets the points, voxels, (0, 0) the lower left of the matrix.
Mesh make_mesh(const Body& body, std::vector<Vec2>& corners);

}  // namespace evo::render
