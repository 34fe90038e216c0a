#include "libevo/control/controller.h"

namespace evo {

Controller to_controller(const TrainedController& controller) {
  return std::visit([](const auto& c) -> Controller { return c; }, controller);
}

}  // namespace evo
