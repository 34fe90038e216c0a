#include "libevo/control/replay.h"

#include <algorithm>

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

}  // namespace evo
