// The places a robot is sent to, one after the other, in tasks that draw goals.
#pragma once

#include <span>
#include <vector>

#include "formats/rollout.h"

namespace evo::render {

// The goal of every step, x in voxels; empty where the task has none or the file
// does not say. `centres` are the robot's, voxels, one per step. A goal counts as
// reached as in the tasks (spec: tasks, C): centre nearer than the radius.
std::vector<double> goals_by_step(const Rollout& rollout, const RolloutEpisode& episode,
                                  std::span<const Vec2> centres);

}  // namespace evo::render
