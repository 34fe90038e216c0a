// A policy's actor as an ONNX graph (docs/formats/policy.md).
#pragma once

#include <string>

#include "formats/training/policy.h"

namespace evo {

// Normaliser, network and action map: "observation" [N, D] to "target" [N, A], both
// double; the network computes in float. Operator set 13. Throws Error(data) for a
// policy that is no network.
std::string policy_to_onnx(const PolicyFile& policy);

}  // namespace evo
