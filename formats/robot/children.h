// Robot documents of what the operators of evolution make.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/robot/robot.h"
#include "libevo/evolve/breeding.h"
#include "libevo/evolve/genome.h"

namespace evo {

// Throws Error(usage) for what is out of range, by the names of evo-mutate's options.
void check(const Breeding& breeding);

// A new body, and where it comes from.
struct Proposal {
  Body body;
  const char* tool = "evo-sample";        // that made it, as documents name it
  std::vector<std::string> parents = {};  // ids
  std::optional<Genome> genome = {};
};

// The document of a proposal, `index` counting under `seed`.
Robot robot_of(Proposal proposal, std::uint64_t seed, int index);

}  // namespace evo
