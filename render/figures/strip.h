// A panorama: the whole way of a robot in one picture, the robot as it was at
// some moments, paler the longer ago.
#pragma once

#include <vector>

#include "render/painters/text.h"
#include "render/scene/clip.h"

namespace evo::render {

// Whether the robot of the clip, or an object, goes so far that a panorama tells more than
// pictures side by side: what it is about lies over itself only here and there.
bool suits_strip(const Clip& clip, const std::vector<int>& moments);

// The moments, not decreasing, on one axis of the world with a ruler and the way of
// the robot's centre; step and return at each. As wide as `most`, and as high as it
// takes; a robot that climbs more than it walks gets a picture as high as `most`,
// and as wide as it takes. Objects that go as far as a voxel are shown at each
// moment, too; of the others every point is where it was when the robot was nearest.
Drawing strip(const Clip& clip, const std::vector<int>& moments, const Theme& theme, Size most,
              Typesetter& typesetter);

}  // namespace evo::render
