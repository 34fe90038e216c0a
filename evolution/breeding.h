// Robot documents of what the methods of evolution make.
#pragma once

#include <optional>
#include <string>

#include "formats/io/data_folders.h"
#include "formats/robot/robot.h"
#include "formats/run/neat.h"
#include "libevo/evolve/method.h"

namespace evo {

// Throws Error(usage) for what is out of range, by the names of evo-mutate's options.
void check(const Breeding& breeding);

constexpr int default_population = 25;

// Settings of NEAT from a file, else from neat.yaml in the folders, for a population of
// `count`: if none is given, the file's, else the default. Throws what reading throws, and
// Error(data) for a file whose runs would end by their fitness.
NeatSettings neat_settings(const std::optional<std::string>& file, std::optional<int> count,
                           const DataFolders& folders);

// The document of a proposal, `index` counting under `seed`.
Robot robot_of(Proposal proposal, std::uint64_t seed, int index);

}  // namespace evo
