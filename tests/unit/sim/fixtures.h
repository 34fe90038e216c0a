// Worlds and comparisons that several tests of the simulator use.
#pragma once

#include <bit>
#include <catch2/catch.hpp>
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

// The first of the two bodies of the reference trajectories.
inline Body body_a() { return Body::from_rows({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"}); }

// Restores the best instruction set when a test ends.
struct IsaGuard {
  IsaGuard() = default;
  IsaGuard(const IsaGuard&) = delete;
  IsaGuard& operator=(const IsaGuard&) = delete;
  ~IsaGuard() { select_isa(best_isa()); }
};

// Runs `f` under every instruction set compiled in that this processor has.
template <typename F>
void for_each_isa(F f) {
  const IsaGuard guard;
  for (const std::string& isa : available_isas()) {
    select_isa(isa);
    INFO("instruction set " << isa);
    f();
  }
}

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

class Hash {  // FNV-1a, a word at a time
 public:
  void add(std::uint64_t word) {
    value_ = (value_ ^ word) * 0x100000001B3U;
    value_ ^= value_ >> 32;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }  // -0 and 0 differ
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325U;
};

// The bits of everything that continues; -0 and 0 count as different.
inline std::uint64_t hash_of(const State& state) {
  Hash hash;
  for (const auto* points : {&state.positions, &state.velocities, &state.previous})
    for (const auto axis : {&Vec2::x, &Vec2::y})
      for (const Vec2& point : *points) hash.add(point.*axis);
  return hash.value();
}

}  // namespace evo
