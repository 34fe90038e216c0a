// A policy's actor as an ONNX graph (docs/formats/policy.md).
#pragma once

#include <optional>
#include <string>

#include "formats/robot/robot.h"
#include "formats/training/policy.h"

namespace evo {

// Normaliser, network and action map: "observation" [N, D] to "target" [N, A], both
// double; the network computes in float. Operator set 13. Throws Error(data) for a
// policy that is no network.
//
// A modular policy becomes the graph of one body, `robot` or else the policy's own: "local" [N, V,
// L] and "task" [N, T] (voxel_views.h), with a clock "step" [N, 1], to "target" [N, A]; what is
// fixed in a view and who exchanges with whom are constants. Throws Error(usage) for a robot and
// any other policy.
std::string policy_to_onnx(const PolicyFile& policy, const std::optional<Robot>& robot = {});

}  // namespace evo
