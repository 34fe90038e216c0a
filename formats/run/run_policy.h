// Which policy a robot of a run has.
#pragma once

#include <filesystem>
#include <optional>

#include "formats/run/run.h"
#include "formats/training/policy.h"

namespace evo {

// The policy of a run's robot, as that of this robot: its own, that of all robots of a
// generation, or the champion's copy. Nothing where the file is gone. Throws what reading it
// throws.
struct RunPolicy {
  PolicyFile policy;
  std::filesystem::path file;
  std::optional<int> sharing;  // the generation whose robots all have it
};
std::optional<RunPolicy> policy_of(const RunFolder& folder, const Robot& robot);

}  // namespace evo
