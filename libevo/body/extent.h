// The smallest rectangle around a body's voxels.
#pragma once

#include <algorithm>

#include "libevo/body/body.h"

namespace evo {

// First and last row and column; of a body without voxels none.
struct Extent {
  int top = 0;
  int bottom = -1;
  int left = 0;
  int right = -1;
  int rows() const { return bottom - top + 1; }
  int cols() const { return right - left + 1; }
};

inline Extent extent(const Body& body) {
  Extent around{body.rows, -1, body.cols, -1};
  for (int row = 0; row < body.rows; ++row)
    for (int col = 0; col < body.cols; ++col) {
      if (body.at(row, col) == Voxel::empty) continue;
      around.top = std::min(around.top, row);
      around.bottom = row;
      around.left = std::min(around.left, col);
      around.right = std::max(around.right, col);
    }
  return around.bottom < 0 ? Extent{} : around;
}

}  // namespace evo
