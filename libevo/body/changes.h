// What differs between two bodies, voxel by voxel.
#pragma once

#include <vector>

#include "libevo/body/body.h"

namespace evo {

struct Change {
  int row = 0;
  int col = 0;
  Voxel before = Voxel::empty;
  Voxel after = Voxel::empty;
};

// None where the two differ in size: their cells have nothing in common.
inline std::vector<Change> changes(const Body& before, const Body& after) {
  std::vector<Change> found;
  if (before.rows != after.rows || before.cols != after.cols) return found;
  for (int row = 0; row < after.rows; ++row)
    for (int col = 0; col < after.cols; ++col)
      if (before.at(row, col) != after.at(row, col))
        found.push_back({row, col, before.at(row, col), after.at(row, col)});
  return found;
}

}  // namespace evo
