// Open-loop controllers: a sine wave for every actuator, all of one period, or recorded targets,
// step by step.
#pragma once

#include <span>
#include <variant>
#include <vector>

namespace evo {

class Archive;

// a_i(t) = middle + shift_i + amplitude_i sin(2 pi t / period + phase_i), with t in
// control steps from 0; the simulator clips it to [0.6, 1.6].
struct SineController {
  std::vector<double> amplitude;  // [A], share of the rest length
  std::vector<double> phase;      // [A], radian
  double period = 25.0;           // control steps
  double middle = 1.1;
  std::vector<double> shift = {};  // [A], share of the rest length; empty: none
  bool operator==(const SineController&) const = default;
};

// The episode ends with the targets.
struct ReplayController {
  std::vector<double> actions;  // [T x A], row-major
  int actuators = 0;            // A
  int steps() const { return actuators > 0 ? static_cast<int>(actions.size()) / actuators : 0; }
  bool operator==(const ReplayController&) const = default;
};

// What a network's actions can be added to: waves, or a sequence, whose last targets
// continue to the end of the episode.
using OpenLoop = std::variant<SineController, ReplayController>;

// Targets of step t, [A]; after the last step of a sequence those of the last.
void act(const SineController& controller, int t, std::span<double> targets);
void act(const ReplayController& controller, int t, std::span<double> targets);

// The same wave for every actuator, `phase_step` radian further at each
// (`--actions sine:A,PERIOD,PHASE` of evo-eval).
SineController travelling_wave(int actuators, double amplitude, double period, double phase_step);

// As long as an episode of so many steps: cut, or continuing with its last targets.
// There is at least one step.
void fit(ReplayController& controller, int steps);

// The nearest multiple of 1/1024 in [low, high]: sequences of such targets make small files.
double recorded_target(double value, double low, double high);

void serialize(const Archive& archive, SineController& controller);

}  // namespace evo
