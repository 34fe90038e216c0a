// Gradients: reverse mode through control steps. A Tape keeps what a batch did in one step and
// turns derivatives by the states after it into derivatives by the states before it, by the
// targets, by the stiffness of voxels and by constants of the physics. See docs/gradients.md.
//
// What is differentiated is the step as it was computed, with its contacts, but for their onset,
// which is smoothed ("What is smoothed"). All derivatives of a lane are 0 where its robot folds
// onto itself or the simulation becomes unstable.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "libevo/base/parallel.h"
#include "libevo/sim/state.h"

namespace evo {

// Constants of the physics (physics.h) that a gradient can be by.
enum class GradientConstant {
  gravity,
  drag,
  contact_stiffness,
  contact_damping,
  friction_multiplier  // friction is viscous: the coefficient decides nothing
};
inline constexpr std::size_t gradient_constants = 5;

// Derivatives of one number, as a sum of rewards, in the units of that number per those of the
// entry.
struct Gradient {
  State state;                    // by positions, velocities, previous positions and targets
  std::vector<double> stiffness;  // [model.cells()] by voxels' factors; empty: not wanted
  std::vector<double> constants;  // [gradient_constants], in their order; empty: not wanted
};

struct GradientParts {  // that are wanted besides the state
  bool stiffness = false;
  bool constants = false;
};
// All 0, in the sizes of the model.
Gradient zero_gradient(const Model& model, GradientParts wanted = {});

// Voxels. 0.02 to 0.04 make the best gradients of all values tried (docs/gradients.md).
inline constexpr double usual_onset = 0.04;

class Tape {
 public:
  // `onset`: half the width that the onset of contact is spread over, voxels; 0: the derivative
  // of the step as it is. Throws Error(usage) beyond [0, 0.1].
  explicit Tape(double onset = usual_onset);
  ~Tape();
  Tape(Tape&&) noexcept;

  // For every lane that the step moved: from derivatives by the state after it to those by the
  // state before, whose targets are those of the step. They are in the state after it, too: who
  // sets other targets before the next step takes their derivatives, and leaves 0. Those by
  // stiffness and constants are added to. [lanes of the batch], each in the sizes of its model; the
  // others are left alone.
  void pull_back(std::span<Gradient> gradients, ThreadPool* pool = nullptr) const;

  struct Impl;  // private to libevo/sim
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace evo
