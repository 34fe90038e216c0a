// Small worlds and whole trainings for the tests of this room.
#pragma once

#include "libevo/control/trainer.h"
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

// Of an arena, or of several that get one controller.
inline TrainResult trained(const auto& robots, const TrainingSettings& settings, std::uint64_t seed,
                           const char* name, std::optional<Inheritance> inheritance = {}) {
  Trainer trainer(robots, settings, seed, name, std::move(inheritance));
  return train(trainer);
}

inline Inheritance heritage(const Arena& arena, const TrainResult& result) {
  return {*result.controller, anatomy(arena)};
}

}  // namespace evo::test
