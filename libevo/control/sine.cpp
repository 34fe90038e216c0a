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

void save_sine(Checkpoint& checkpoint, const std::string& name, const SineController& controller) {
  checkpoint.put(name + "/amplitude", controller.amplitude);
  checkpoint.put(name + "/phase", controller.phase);
  checkpoint.put(name + "/shift", controller.shift);
  checkpoint.put<double>(name + "/period", {controller.period});
  checkpoint.put<double>(name + "/middle", {controller.middle});
}

SineController load_sine(const Checkpoint& checkpoint, const std::string& name) {
  SineController controller;
  controller.amplitude = checkpoint.get<double>(name + "/amplitude");
  controller.phase = checkpoint.get<double>(name + "/phase", controller.amplitude.size());
  controller.shift = checkpoint.get<double>(name + "/shift");
  controller.period = checkpoint.get<double>(name + "/period", 1)[0];
  controller.middle = checkpoint.get<double>(name + "/middle", 1)[0];
  return controller;
}

}  // namespace evo
