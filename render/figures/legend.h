// What the colours and signs of a picture mean, and how large it is.
#pragma once

#include <span>

#include "formats/robot/robot.h"
#include "render/painters/text.h"
#include "render/scene/clip.h"

namespace evo::render {

// A row of voxels with their names, those whose colours the mesh shows, from the left of
// `area`, as large as fits; nothing where that cannot be read; at its right, if `scale` (pixels a
// voxel) is given, a bar of some voxels. `values`: of cells that have another colour, as in Scene.
void draw_legend(const Mesh& mesh, std::span<const float> values, double scale, const Theme& theme,
                 const Rect& area, float size, Typesetter& typesetter, Drawing& drawing);
// The same over a scene, on a plate.
void draw_legend_on_plate(const Mesh& mesh, std::span<const float> values, const Theme& theme,
                          const Rect& area, float size, Typesetter& typesetter, Drawing& drawing);
// The same of what any of several has.
void draw_legend(std::span<const Mesh* const> meshes, double scale, const Theme& theme,
                 const Rect& area, float size, Typesetter& typesetter, Drawing& drawing);
// The same of what any of the robots has.
void draw_legend(std::span<const Robot> robots, const Theme& theme, const Rect& area, float size,
                 Typesetter& typesetter, Drawing& drawing);

}  // namespace evo::render
