#include "libevo/control/controller.h"

namespace evo {

Controller to_controller(const TrainedController& controller) {
  return std::visit([](const auto& c) { return Controller(c); }, controller);
}

}  // namespace evo
