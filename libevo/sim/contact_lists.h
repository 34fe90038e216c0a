// Which points may touch which cells: found once, kept while nothing has moved
// far (a neighbour list with a skin, as molecular dynamics uses them).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace evo {

// A corner of one surface cell against another surface cell.
struct ContactCandidate {
  std::uint32_t corner = 0;  // 4 * surface cell + Corner
  std::uint32_t cell : 31 = 0;
  std::uint32_t rectangle : 1 = 0;  // the cell cannot move and is an upright rectangle
};

struct ContactLists {
  // Within one moving object.
  struct Self {
    std::vector<ContactCandidate> candidates;
    // Pairs of surface cells that count for self-folding and whose boxes may
    // overlap; empty when there are too few of them to fold the object.
    std::vector<std::array<std::uint32_t, 2>> folding;
    bool valid = false;
  };
  std::vector<Self> self;  // one a block of the plan
  // Between objects, one range an object i in world order, of pairs (i, j>i).
  std::vector<ContactCandidate> pairs;
  std::vector<std::uint32_t> first_pair;  // objects + 1 entries
  bool pairs_valid = false;
  // Positions the lists were found at, by slot: x, y interleaved.
  std::vector<double> self_reference;
  std::vector<double> pair_reference;

  void invalidate() {
    pairs_valid = false;
    for (Self& s : self) s.valid = false;
  }
};

}  // namespace evo
