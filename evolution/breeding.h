// New robots by number: each is drawn from the random stream of its own number, so
// that it does not depend on which others are made in the same call.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "formats/io/data_folders.h"
#include "formats/io/values.h"
#include "formats/robot/robot.h"
#include "formats/run/neat.h"
#include "libevo/body/operators.h"
#include "libevo/evolve/cppn_neat.h"

namespace evo {

struct Breeding {
  MutationSettings mutation;
  double crossover = 0.0;  // chance of a child to have two parents

  // Throws Error(usage) for what is out of range, by the names of evo-mutate's options.
  void check() const;
};

// A random valid robot whose id is not in `seen`, which it joins. Throws Error(work)
// when none is found.
Robot sample_robot(const Shape& shape, const VoxelWeights& weights, std::uint64_t seed, int index,
                   std::set<std::string>& seen);

// A child of robots drawn uniformly from `parents`, likewise.
Robot breed_robot(const std::vector<Robot>& parents, const Breeding& breeding, std::uint64_t seed,
                  int index, std::set<std::string>& seen);

constexpr int default_population = 25;

// Settings of NEAT from a file, else from neat.yaml in the folders, for a population of
// `count`: if none is given, the file's, else the default. Throws what reading throws, and
// Error(data) for a file whose runs would end by their fitness.
NeatSettings neat_settings(const std::optional<std::string>& file, std::optional<int> count,
                           const DataFolders& folders);

// The document of a genome with its body, `index` counting under `seed`.
Robot cppn_robot(const CppnRobot& made, const std::vector<std::string>& parents, std::uint64_t seed,
                 int index);

}  // namespace evo
