#include "tests/unit/sim/fixtures.h"

#include <bit>

namespace evo {

std::uint64_t hash_of(const State& state) {
  std::uint64_t hash = 0xCBF29CE484222325U;  // FNV-1a, a word at a time
  for (const auto* values :
       {&state.x, &state.y, &state.vx, &state.vy, &state.previous_x, &state.previous_y})
    for (const double value : *values) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001B3U;
      hash ^= hash >> 32;
    }
  return hash;
}

}  // namespace evo
