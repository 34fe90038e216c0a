#include "libevo/control/replay.h"

#include <algorithm>
#include <cmath>

namespace evo {

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

}  // namespace evo
