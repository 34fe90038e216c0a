// Every constant of the physics, with unit. Raw units: a voxel is 0.1 long, a
// point mass weighs 1. Defaults are the profile `evogym`: the released
// benchmark simulator (docs/physics.md; profiles in tasks/physics/*.yaml).
#pragma once

#include <algorithm>

namespace evo {

struct SpringStiffness {
  double edge;      // force per length, the four sides of a cell
  double diagonal;  // the two diagonals
  bool operator==(const SpringStiffness&) const = default;
};

struct Physics {
  double voxel_length = 0.1;      // raw length
  double substep = 1e-4;          // dt, raw time
  int substeps = 30;              // per control step
  double gravity = 110.0;         // downward acceleration
  double drag = 0.1;              // force per velocity, on every point
  double actuation_rate = 0.006;  // share of (goal - length) a spring's rest length takes

  SpringStiffness rigid{3e8 / 3.5, 3e8 / 7.0};  // fixed cells, too
  SpringStiffness soft{3e8 / 6.0, 3e8 / 24.0};
  SpringStiffness actuator{3e8 / 5.0, 3e8 / 10.0};

  double contact_stiffness = 2.1e6;  // k_c, force per penetration
  double contact_margin = 0.005;     // added to every penetration, length
  double contact_damping = 140.0;    // force per normal velocity
  double friction_coefficient = 0.2;
  double friction_multiplier = 1200.0;

  double floor_stiffness = 1.4e7;  // the world floor at y = 0
  double floor_friction_coefficient = 0.2;
  double floor_friction_multiplier = 10.0;

  double strain_limit = 0.25;  // every spring, share of its rest length
  double strain_correction = 0.8;
  double rigid_strain_limit = 0.03;  // edges of rigid cells, second pass
  double rigid_strain_correction = 0.5;

  double min_target = 0.6;  // actuator targets, share of the rest length
  double max_target = 1.6;

  // An actuator's target within its range. One of single precision is clipped in it by whoever
  // gives it, as in the benchmark: its bounds are 0.600000023841858 and 1.600000023841858, and
  // are not clipped again.
  double clip(double target) const {
    for (const double bound : {min_target, max_target})
      if (target == static_cast<double>(static_cast<float>(bound))) return target;
    return std::clamp(target, min_target, max_target);
  }

  bool operator==(const Physics&) const = default;
};

}  // namespace evo
