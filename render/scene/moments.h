// Which moments of an episode stand for the whole.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/scene/clip.h"

namespace evo::render {

enum class Choice {
  time,  // the same number of steps apart
  gait,  // about that, each in another part of the gait's cycle
};

// Steps after which the robot has the same shape again, if it moves in cycles
// between the steps `from` and `to`.
std::optional<int> gait_period(const Clip& clip, int from, int to);

// `count` whole steps from `from` to `to`, both among them, not decreasing. Where
// steps are even and their distance happens to be a multiple of a gait's period,
// every picture would show the same pose; Choice::gait moves each by half a period
// at most, so that together they show the cycle.
std::vector<int> choose_moments(const Clip& clip, int from, int to, int count, Choice choice);

}  // namespace evo::render
