// Rollouts for pictures: real tasks, bodies and physics, a sine for a
// controller. Rewards are how far the robot moved to the right.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "formats/rollout/rollout.h"
#include "libevo/task/spec.h"

namespace evo::example {

// The two bodies of the reference rollouts.
extern const std::vector<std::string> walker;     // 5x5
extern const std::vector<std::string> small_box;  // 3x3

TaskSpec task(const std::string& name);  // of the folder tasks/
Model build(const TaskSpec& task, const std::vector<std::string>& body);
Rollout simulate(const std::string& task, const std::vector<std::string>& body, int steps);
// The robot's points moved to where `place` says, of a point as it was at the start and as it is
// in a step, and nothing else.
using Place = std::function<Vec2(Vec2 start, Vec2 now, int step)>;
Rollout moved(Rollout rollout, const Place& place);
// The robot carried along by so much a step.
Rollout carried(Rollout rollout, Vec2 a_step);

}  // namespace evo::example
