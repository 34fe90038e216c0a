// The places a robot is sent to, one after the other, in tasks that draw goals.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "formats/rollout/rollout.h"

namespace evo::render {

struct GoalOfStep {
  double x = 0;             // voxels
  std::size_t reached = 0;  // goals before it; at the end, all
};

// The goal of every step; empty where the task has none or the file
// does not say. `centres` are the robot's, voxels, one per step. A goal counts as
// reached as in the tasks (docs/tasks.md, "Rewards and ends"): centre nearer than the radius.
std::vector<GoalOfStep> goals_by_step(const Rollout& rollout, const RolloutEpisode& episode,
                                      std::span<const Vec2> centres);

}  // namespace evo::render
