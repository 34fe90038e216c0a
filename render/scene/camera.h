// Where the camera looks at every step of an episode. Known before the first
// frame is drawn, so that it can look ahead and move without lag, and so that
// frames can be drawn in any order.
#pragma once

#include <vector>

#include "libevo/task/bounds.h"
#include "render/scene/scene.h"

namespace evo::render {

// `boxes`: around what is to be in view at every step, voxels. One view per step, of the
// given proportions.
std::vector<ViewRect> camera_path(const std::vector<Bounds>& boxes, const Camera& camera,
                                  double aspect);

}  // namespace evo::render
