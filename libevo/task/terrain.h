// How far the ground is below the robot, or the ceiling above it, column by
// column. See docs/tasks.md, "Floor and ceiling".
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libevo/sim/model.h"
#include "libevo/task/measure.h"

namespace evo {

// Points of terrain, prepared for looking near the robot only: those that never
// move are sorted into columns. Coordinates in voxels (raw / voxel length).
class Terrain {
 public:
  // `objects`: indices of the model's objects that count. Those of `drawn` among them stand
  // elsewhere in other episodes: they are looked up where they are, even if they never move.
  Terrain(const Model& model, const std::vector<int>& objects, const std::vector<int>& drawn = {});

  enum class Side { below, above };

  // Bin i of 2*width+1 is the vertical distance, at most `range` voxels, from
  // `centre` (voxels) to the nearest terrain point on that side whose x lies
  // strictly between centre.x + (i - width) -+ 0.5. Result in raw units.
  // `positions`: all points of the world, raw units.
  void clearance(Side side, const Vec2& centre, double range, std::span<const Vec2> positions,
                 std::span<double> bins) const;
  // From derivatives by the bins to that by centre.y, which it returns, and to those by
  // positions, which are added to. A bin that is at 0 or at its range has none.
  double pull_back(Side side, const Vec2& centre, double range, std::span<const Vec2> positions,
                   std::span<const double> by_bins, std::span<Vec2> by_positions) const;

 private:
  struct Column {
    double x = 0.0;
    std::size_t first = 0;  // into y_, ascending
    std::size_t last = 0;
  };

  double voxel_length_ = 0.1;
  std::vector<Column> columns_;  // ascending x
  std::vector<double> y_;
  std::vector<PointRange> moving_;  // of objects that may move, or are drawn
};

}  // namespace evo
