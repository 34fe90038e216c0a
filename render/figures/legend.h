// What the colours and signs of a picture mean, and how large it is.
#pragma once

#include <set>
#include <span>

#include "render/painters/text.h"
#include "render/scene/clip.h"

namespace evo::render {

// Kinds of voxels that are seen in their colours.
struct Kinds {
  std::set<Voxel> of_robots;
  std::set<Voxel> of_objects;

  Kinds() = default;
  // `values`: of cells that have another colour, as in Scene.
  explicit Kinds(const Mesh& mesh, std::span<const float> values = {}) { add(mesh, values); }
  void add(const Mesh& mesh, std::span<const float> values = {});
  void add(const Body& robot) { of_robots.insert(robot.cells.begin(), robot.cells.end()); }
};

// A row of voxels with their names, from the left of `area`, as large as fits; nothing where that
// cannot be read; at its right, if `scale` (pixels a voxel) is given, a bar of some voxels. Over a
// scene it needs a plate.
void draw_legend(const Kinds& kinds, double scale, const Theme& theme, const Rect& area, float size,
                 Typesetter& typesetter, Drawing& drawing, bool plate = false);

}  // namespace evo::render
