// What cells feel, at every step of an episode: strain, stress, commanded length.
// Strain needs positions alone; the others follow from actions and the physics that a
// rollout carries, without simulating. And what pushes an object, from its motion alone.
#pragma once

#include <span>
#include <vector>

#include "formats/rollout/rollout.h"
#include "libevo/sim/physics.h"
#include "render/scene/mesh.h"
#include "render/scene/options.h"
#include "render/scene/value_scale.h"

namespace evo::render {

class Quantity {
 public:
  // Of `what`, one of
  //   strain     area of the cell, of that at rest, less 1;
  //   stress     mean of its two normal stresses, pull positive: of the springs of the
  //              cell, the sum of force times length by twice its area, a side shared
  //              by two cells counted half; in weights of the robot per voxel;
  //   stiffness  log10 of the factor that the robot gives the voxel's springs;
  //   commanded  the target of an actuator in the step that ends here; at the start 1.
  // `points` are all positions of the episode in voxels. Throws Error(data) for a
  // rollout without the actions or the physics that are needed.
  Quantity(Tint what, const Rollout& rollout, const RolloutEpisode& episode, const Mesh& mesh,
           std::span<const Vec2> points);

  // Values of every cell of the mesh; NaN for cells of terrain and others that have none.
  std::span<const float> values(int step) const {
    return std::span(values_).subspan(static_cast<std::size_t>(step) * cells_, cells_);
  }
  // The same for all steps: symmetric, and as wide as all values but the outermost need.
  const ValueScale& scale() const { return scale_; }

 private:
  std::size_t cells_ = 0;
  std::vector<float> values_;  // [(steps+1) x cells]
  ValueScale scale_;
};

// The scale of commanded lengths, whatever the episode.
ValueScale command_scale();

// The physics of a rollout's steps (a held action is one), from its `physics_yaml`. Throws
// Error(data) where there is none.
Physics physics_of(const Rollout& rollout);

// Targets of the first robot's actuators: the cell of each, in the order of actions.
std::vector<int> actuators_of(const Mesh& mesh);

// What everything outside presses on an object with, in its own weights, y upwards: the
// force that its centre's acceleration, its weight and the drag leave to explain, a mean
// over the steps around `step`. `centres` in voxels, one per step; zero for fewer than
// three.
Vec2 outside_force(std::span<const Vec2> centres, int step, const Physics& physics);

}  // namespace evo::render
