// Where the camera looks at every step of an episode. Known before the first
// frame is drawn, so that it can look ahead and move without lag, and so that
// frames can be drawn in any order.
#pragma once

#include <span>
#include <vector>

#include "render/scene/scene.h"

namespace evo::render {

// `points` [(steps+1) x mesh points], voxels. One view per step, of the given
// proportions. `follow`: indices of objects.
std::vector<ViewRect> camera_path(const Mesh& mesh, std::span<const Vec2> points,
                                  const Camera& camera, const std::vector<int>& follow,
                                  double aspect);

}  // namespace evo::render
