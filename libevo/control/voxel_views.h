// What the voxels of a robot see, for controllers that are the same for every body. A view
// has three parts, none of which depends on how large the body is or where it stands:
//   local   the voxel's own state, relative to the body's centre
//   task    what the task shows of the world, the same for all voxels
//   fixed   where the voxel sits in its body, the same at every step
#pragma once

#include <array>
#include <span>
#include <vector>

#include "libevo/control/matrix.h"
#include "libevo/task/env.h"
#include "libevo/task/terrain.h"

namespace evo {

class VoxelViews {
 public:
  // Four corners, top left, top right, bottom left, bottom right: x and y of each minus
  // the centre of the body's points, in voxels; their velocities minus the body's mean one;
  // then how far the voxel is stretched, as a share of its length at rest: top, bottom, left
  // and right edge, falling and rising diagonal; and how high each corner is above what lies
  // below it, terrain or an object, in voxels: 1 where nothing is that near, less than 0 where it
  // has sunk in.
  static constexpr int local_length = 8 + 8 + 6 + 4;
  // Which of the five materials each of the 3 x 3 cells around the voxel is made of, row by row
  // (all 0: empty); the voxel's place from the middle of the body, in voxels, to the right
  // and up; for the whole body the share of each material, and its voxels, columns and rows.
  static constexpr int fixed_length = 9 * 5 + 2 + 5 + 3;

  // Keeps what it needs of the arena.
  explicit VoxelViews(const Arena& arena);

  int voxels() const { return static_cast<int>(cells_.size()); }  // in scan order
  int task_length() const { return task_length_; }
  // The voxel of each action, in the order of actions.
  const std::vector<int>& actuators() const { return actuators_; }
  const Matrix& fixed() const { return fixed_; }  // [V x fixed_length]

  // As environment `environment` is now: local [V x local_length], task [task_length].
  void look(const VecEnv& env, int environment, std::span<double> local,
            std::span<double> task) const;

 private:
  std::vector<std::array<int, 4>> cells_;  // points of each voxel
  int points_ = 0;                         // of the body: the first of its world
  double voxel_length_ = 0.0;
  Terrain ground_;
  std::vector<ObservationSlice> task_;  // the parts that do not grow with the body
  int task_length_ = 0;
  std::vector<int> actuators_;
  Matrix fixed_;
};

}  // namespace evo
