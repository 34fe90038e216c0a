// Small worlds for the tests of this room.
#pragma once

#include "libevo/task/env.h"
#include "tests/unit/sim/fixtures.h"

namespace evo::test {

// Flat ground to walk on, as in Walker-v0, with episodes of `steps` steps.
inline TaskSpec walker(int steps, int length = 40) {
  TaskSpec task;
  task.name = "Walker-test";
  task.episode_steps = steps;
  task.robot_x = 1;
  task.robot_y = 1;
  task.objects.push_back({fixed_ground(length), "", ""});
  task.observation = {observation::Velocity{robot_name},
                      observation::RelativePositions{robot_name}};
  task.reward.push_back({1.0, reward::Displacement{robot_name, Axis::x}, {}});
  return task;
}

using evo::body_a;

inline Body small_body() { return Body::from_rows({"HHH", "V.V"}); }

}  // namespace evo::test
