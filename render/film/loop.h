// One cycle of a gait as an SVG that plays for ever: a picture for a README, which needs no
// player and is a few dozen kB.
#pragma once

#include <string>

#include "render/scene/clip.h"

namespace evo::render {

// The robot and what it carries, seen by a camera that moves along with its centre, over a
// floor whose marks go by; shapes move by SMIL, so that the file also plays as an <img>. The
// cycle is the one between `from` and `to` that ends nearest to how it began. Colours follow
// the reader's scheme, light or dark. Throws Error(data) where the robot has no gait, or the
// ground under the cycle is not flat.
std::string gait_loop(const Clip& clip, int from, int to, int width, const std::string& title);

}  // namespace evo::render
