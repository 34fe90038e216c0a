// Everything that can drive a robot through an episode.
#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "libevo/control/policy.h"
#include "libevo/control/sine.h"

namespace evo {

// Uniform targets in [low, high], episode k from the stream (evaluation's seed,
// "random", k).
struct RandomController {
  double low = 0.6;
  double high = 1.6;
  bool operator==(const RandomController&) const = default;
};

// Recorded targets; the episode ends with them.
struct ReplayController {
  std::vector<double> actions;  // [T x A], row-major
  int actuators = 0;            // A
  int steps() const { return actuators > 0 ? static_cast<int>(actions.size()) / actuators : 0; }
  bool operator==(const ReplayController&) const = default;
};

// Targets of step t, [A]; after the last step those of the last.
void act(const ReplayController& controller, int t, std::span<double> targets);

// As long as an episode of so many steps: cut, or going on with its last targets.
// There is at least one step.
void fit(ReplayController& controller, int steps);

using Controller = std::variant<Policy, SineController, RandomController, ReplayController>;

// Those that a training can find, and a policy file can hold.
using TrainedController = std::variant<Policy, SineController, ReplayController>;
Controller to_controller(const TrainedController& controller);

}  // namespace evo
