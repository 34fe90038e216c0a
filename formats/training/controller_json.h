// The controller of a policy that is a JSON document (policy_json.h writes them), to be
// driven by.
#pragma once

#include "formats/io/node.h"
#include "libevo/control/controller.h"

namespace evo {

// What does not act may be missing: critic, log_std, curve, identity. Throws Error(data).
TrainedController read_controller(const Node& document);

}  // namespace evo
