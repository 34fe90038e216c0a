// A motion as an SVG that plays for ever: a picture for a README, which needs no player and is
// 20 to 300 kB.
#pragma once

#include <string>

#include "render/scene/clip.h"

namespace evo::render {

// The robot and what it carries. Where it has a gait over flat ground: the cycle between `from`
// and `to` that ends nearest to how it began, seen by a camera that moves along with its centre,
// over a floor whose cells go by. Else the two seconds in which most moves, or fewer within which
// the robot goes eight voxels, there and back, before what stands around. Shapes move by SMIL, so
// that the file also plays as an <img>; colours follow the reader's scheme, light or dark.
std::string gait_loop(const Clip& clip, int from, int to, Size size, const std::string& title);

}  // namespace evo::render
