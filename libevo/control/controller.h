// Everything that can drive a robot through an episode.
#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "libevo/control/policy.h"

namespace evo {

// Open loop: a_i(t) = middle + amplitude_i sin(2 pi t / period + phase_i), with t
// in control steps from 0; the simulator clips it to [0.6, 1.6].
struct SineController {
  std::vector<double> amplitude;  // [A], share of the rest length
  std::vector<double> phase;      // [A], radian
  double period = 25.0;           // control steps
  double middle = 1.1;
  bool operator==(const SineController&) const = default;
};

// The same wave for every actuator, `phase_step` radian further at each
// (spec: cli, evo-eval --sine).
SineController travelling_wave(int actuators, double amplitude, double period, double phase_step);

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
  bool operator==(const ReplayController&) const = default;
};

using Controller = std::variant<Policy, SineController, RandomController, ReplayController>;

// Those that a training can find, and a policy file can hold.
using TrainedController = std::variant<Policy, SineController>;
Controller to_controller(const TrainedController& controller);

// Targets of step t, [A].
void act(const SineController& controller, int t, std::span<double> targets);

}  // namespace evo
