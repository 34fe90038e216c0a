// What there is to see, before any pixel: shapes in voxels, and how they are
// laid out in a panel of a drawing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/rollout.h"
#include "render/drawing.h"
#include "render/options.h"
#include "render/theme.h"

namespace evo::render {

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

struct Arrow {
  Vec2 from;
  Vec2 to;
};

// One moment. Lengths in voxels.
struct Scene {
  const Mesh* mesh = nullptr;
  std::vector<Vec2> points;
  ViewRect view;
  bool sky = true;  // a background of its own; else what was drawn before
  bool grid = true;
  bool fine_grid = true;  // a line every voxel where there is room, not every ten
  bool floor = true;      // the world's floor at y = 0
  bool tint = true;
  std::vector<Vec2> trail;  // oldest first
  std::vector<Arrow> arrows;
  std::optional<Vec2> goal;  // where the robot is sent, on the ground
};

// Fills `panel` with the scene, cut at its border. Line widths follow the size
// of a voxel in pixels, text follows the size of the panel.
void draw_scene(const Scene& scene, const Theme& theme, const Rect& panel, Drawing& drawing);

// `view` enlarged, not cut, to the panel's proportions.
ViewRect fit(ViewRect view, double aspect);

// The size of label text in a panel, pixels.
float label_size(const Rect& panel);

}  // namespace evo::render
