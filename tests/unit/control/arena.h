// Small worlds for the tests of this room.
#pragma once

#include <string>
#include <vector>

#include "libevo/task/env.h"

namespace evo::test {

// Flat ground to walk on, as in Walker-v0, with episodes of `steps` steps.
inline TaskSpec walker(int steps, int length = 40) {
  TaskSpec task;
  task.name = "Walker-test";
  task.episode_steps = steps;
  task.robot_x = 1;
  task.robot_y = 1;
  const Body ground(1, length, std::vector<Voxel>(static_cast<std::size_t>(length), Voxel::fixed));
  task.objects.push_back({Object{"ground", ground, 0, 0}, "", ""});
  task.observation = {observation::Velocity{robot_name},
                      observation::RelativePositions{robot_name}};
  task.reward.push_back({1.0, reward::Displacement{robot_name, Axis::x}, {}});
  return task;
}

inline Body body_a() { return Body::from_rows({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"}); }

inline Body small_body() { return Body::from_rows({"HHH", "V.V"}); }

}  // namespace evo::test
