#include "libevo/control/sine.h"

#include <numbers>

#include "libevo/base/elementary.h"
#include "libevo/control/checkpoint.h"

namespace evo {

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
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double middle =
        controller.shift.empty() ? controller.middle : controller.middle + controller.shift[i];
    targets[i] = middle + controller.amplitude[i] * math::sin(turn + controller.phase[i]);
  }
}

void serialize(const Archive& archive, SineController& controller) {
  archive.array("amplitude", controller.amplitude);
  controller.phase.resize(controller.amplitude.size());
  archive.row<double>("phase", controller.phase);
  archive.array("shift", controller.shift);
  archive.numbers<double>("period", controller.period);
  archive.numbers<double>("middle", controller.middle);
}

}  // namespace evo
