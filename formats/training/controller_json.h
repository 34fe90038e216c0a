// The controller of a policy that is a JSON document (policy_json.h writes them), to be
// driven by.
#pragma once

#include "formats/io/json.h"
#include "libevo/control/controller.h"

namespace evo {

// What does not act may be missing: critic, log_std, curve, identity. Throws Error(data)
// with `where` and the JSON path.
TrainedController controller_from_json(const Json& document, const std::string& where);

}  // namespace evo
