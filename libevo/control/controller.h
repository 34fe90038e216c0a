// Everything that can drive a robot through an episode.
#pragma once

#include <cstdint>
#include <variant>

#include "libevo/control/modular_policy.h"
#include "libevo/control/open_loop.h"
#include "libevo/control/policy.h"
#include "libevo/control/replanner.h"

namespace evo {

// Uniform targets in [low, high], episode k from the stream (evaluation's seed,
// "random", k).
struct RandomController {
  double low = 0.6;
  double high = 1.6;
  bool operator==(const RandomController&) const = default;
};

// Those that a training can find, and a policy file can hold.
using TrainedController = std::variant<Policy, SineController, ReplayController, ModularPolicy>;

using Controller = std::variant<TrainedController, RandomController, PlannerController>;

}  // namespace evo
