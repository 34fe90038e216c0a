// Worlds and comparisons that several tests of the simulator use.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/sim/batch.h"
#include "libevo/sim/isa.h"
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

inline void draw_targets(std::span<double> targets, Stream& random) {
  for (double& target : targets) target = 0.6 + random.uniform();
}

// One control step of a state in a batch of its own.
inline LaneStatus step_alone(const Model& model, State& state) {
  Batch batch(1);
  batch.place(0, model);
  batch.set_state(0, state);
  batch.step();
  state = batch.state(0);
  return batch.status(0);
}

// The bits of everything that continues; -0 and 0 count as different.
std::uint64_t hash_of(const State& state);

}  // namespace evo
