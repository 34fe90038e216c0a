#include "libevo/control/controller.h"

#include <numbers>

#include "libevo/base/elementary.h"

namespace evo {

Controller to_controller(const TrainedController& controller) {
  return std::visit([](const auto& c) { return Controller(c); }, controller);
}

SineController travelling_wave(int actuators, double amplitude, double period, double phase_step) {
  SineController controller;
  controller.period = period;
  for (int i = 0; i < actuators; ++i) {
    controller.amplitude.push_back(amplitude);
    controller.phase.push_back(phase_step * i);
  }
  return controller;
}

void act(const SineController& controller, int t, std::span<double> targets) {
  const double turn = 2.0 * std::numbers::pi * t / controller.period;
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i] =
        controller.middle + controller.amplitude[i] * math::sin(turn + controller.phase[i]);
}

}  // namespace evo
