// New bodies by number: each is drawn from the random stream of its own number, so
// that it does not depend on which others are made in the same call.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "libevo/body/operators.h"

namespace evo {

struct Breeding {
  MutationSettings mutation;
  double crossover = 0.0;  // chance of a child to have two parents
};

struct Child {
  Body body;
  std::vector<std::size_t> parents;  // one or two, by their places among those given
};

// A random valid body whose id is not in `seen`, which it joins. Throws Error(work)
// when none is found.
Body sample_new(int rows, int cols, const VoxelWeights& weights, std::uint64_t seed, int index,
                std::set<std::string>& seen);

// A child of bodies drawn uniformly from `parents`, likewise.
Child breed_new(std::span<const Body> parents, const Breeding& breeding, std::uint64_t seed,
                int index, std::set<std::string>& seen);

}  // namespace evo
