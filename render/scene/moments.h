// Which moments of an episode stand for the whole.
#pragma once

#include <optional>
#include <vector>

#include "render/scene/clip.h"

namespace evo::render {

enum class Choice {
  event,  // those that stand best for all: more where more changes
  time,   // the same number of steps apart
  gait,   // about that
};

// Steps after which the robot has the same shape again, if it moves in cycles
// between the steps `from` and `to`.
std::optional<int> gait_period(const Clip& clip, int from, int to);

// `count` whole steps from `from` to `to`, both among them, not decreasing.
//
// Choice::event cuts the episode into as many parts as there are moments, so that the
// positions of all that moves, and the return, differ least within the parts, summed over all
// steps; it shows the step in the middle of each. A long rest is one moment, a leap many.
//
// Where moments are a multiple of a gait's period apart, every picture would show the same
// pose; all choices but `time` move each by half a period at most, so that together they show
// the cycle.
std::vector<int> choose_moments(const Clip& clip, int from, int to, int count, Choice choice);

}  // namespace evo::render
