// Worlds and comparisons that several tests of the simulator use.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/sim/state.h"
#include "libevo/sim/world.h"

namespace evo {

inline Object fixed_ground(int length) {
  return {"ground",
          Body(1, length, std::vector<Voxel>(static_cast<std::size_t>(length), Voxel::fixed)), 0,
          0};
}

// Restores the best instruction set when a test ends.
struct IsaGuard {
  IsaGuard() = default;
  IsaGuard(const IsaGuard&) = delete;
  IsaGuard& operator=(const IsaGuard&) = delete;
  ~IsaGuard() { select_isa(best_isa()); }
};

inline void draw_targets(State& state, Stream& random) {
  for (double& target : state.targets) target = 0.6 + random.uniform();
}

// The bits of everything that goes on; -0 and 0 count as different.
std::uint64_t hash_of(const State& state);

}  // namespace evo
