// A policy for other programs (docs/formats/policy.md): the whole file as one JSON
// document.
#pragma once

#include <string>

#include "formats/training/policy.h"

namespace evo {

// Numbers have the same bits. Throws Error(data) for one that is not finite, which
// JSON cannot say.
std::string policy_to_json(const PolicyFile& policy);

}  // namespace evo
