// Open-loop controllers: a sine wave for every actuator, all of one period.
#pragma once

#include <span>
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

// The same wave for every actuator, `phase_step` radian further at each
// (`--actions sine:A,PERIOD,PHASE` of evo-eval).
SineController travelling_wave(int actuators, double amplitude, double period, double phase_step);

// Targets of step t, [A].
void act(const SineController& controller, int t, std::span<double> targets);

void serialize(const Archive& archive, SineController& controller);

}  // namespace evo
