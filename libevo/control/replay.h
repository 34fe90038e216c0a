// Open-loop controllers: recorded targets, step by step.
#pragma once

#include <span>
#include <vector>

namespace evo {

// The episode ends with the targets.
struct ReplayController {
  std::vector<double> actions;  // [T x A], row-major
  int actuators = 0;            // A
  int steps() const { return actuators > 0 ? static_cast<int>(actions.size()) / actuators : 0; }
  bool operator==(const ReplayController&) const = default;
};

// Targets of step t, [A]; after the last step those of the last.
void act(const ReplayController& controller, int t, std::span<double> targets);

// As long as an episode of so many steps: cut, or continuing with its last targets.
// There is at least one step.
void fit(ReplayController& controller, int steps);

// The nearest multiple of 1/1024 in [low, high]: sequences of such targets make small files.
double recorded_target(double value, double low, double high);

}  // namespace evo
