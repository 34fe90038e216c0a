// A policy for other programs (docs/formats/policy.md): the whole file as one JSON
// document.
#pragma once

#include <string>
#include <vector>

#include "formats/io/json.h"
#include "formats/training/policy.h"

namespace evo {

// Numbers have the same bits. Throws Error(data) for one that is not finite, which
// JSON cannot say.
std::string policy_to_json(const PolicyFile& policy);

// Where the parts of an observation are: [{"name", "offset", "length"}].
Json layout_to_json(const std::vector<ObservationSlice>& layout);

}  // namespace evo
