#include "libevo/control/open_loop.h"

#include <algorithm>
#include <cmath>
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

void act(const ReplayController& controller, int t, std::span<double> targets) {
  const auto row = static_cast<std::ptrdiff_t>(std::clamp(t, 0, controller.steps() - 1)) *
                   static_cast<std::ptrdiff_t>(targets.size());
  std::copy_n(controller.actions.begin() + row, targets.size(), targets.begin());
}

void fit(ReplayController& controller, int steps) {
  const auto width = static_cast<std::size_t>(controller.actuators);
  const std::size_t length = static_cast<std::size_t>(steps) * width;
  std::vector<double>& actions = controller.actions;
  actions.reserve(length);
  while (actions.size() < length) actions.push_back(actions[actions.size() - width]);
  actions.resize(length);
}

double recorded_target(double value, double low, double high) {
  constexpr double resolution = 1024.0;
  return std::clamp(std::round(value * resolution), std::ceil(low * resolution),
                    std::floor(high * resolution)) /
         resolution;
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
