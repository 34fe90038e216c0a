#include "formats/task/physics_profile.h"

namespace evo {
namespace {

void check_targets(const Physics& physics) {
  if (physics.min_target > physics.max_target)
    throw error(Failure::usage, "min_target {} is greater than max_target {}", physics.min_target,
                physics.max_target);
}

// In the order of libevo/sim/physics.h.
SettingTable<Physics> table() {
  return SettingTable<Physics>(
      {
          {"voxel_length", &Physics::voxel_length, above(0), "length", "side of a voxel"},
          {"substep", &Physics::substep, above(0), "time", "one step of the integrator"},
          {"substeps", &Physics::substeps, between(1, 10000), "count",
           "substeps in a control step"},
          {"gravity", &Physics::gravity, at_least(0), "length/time^2", "downward acceleration"},
          {"drag", &Physics::drag, at_least(0), "force/velocity", "on every point mass"},
          {"actuation_rate", &Physics::actuation_rate, at_least(0), "share",
           "of (goal - length) that a spring's rest length takes"},
          {"rigid.edge", within(&Physics::rigid, &SpringStiffness::edge), at_least(0),
           "force/length", "springs of rigid, fixed cells"},
          {"rigid.diagonal", within(&Physics::rigid, &SpringStiffness::diagonal), at_least(0),
           "force/length", "springs of rigid, fixed cells"},
          {"soft.edge", within(&Physics::soft, &SpringStiffness::edge), at_least(0), "force/length",
           "springs of soft cells"},
          {"soft.diagonal", within(&Physics::soft, &SpringStiffness::diagonal), at_least(0),
           "force/length", "springs of soft cells"},
          {"actuator.edge", within(&Physics::actuator, &SpringStiffness::edge), at_least(0),
           "force/length", "springs of actuators"},
          {"actuator.diagonal", within(&Physics::actuator, &SpringStiffness::diagonal), at_least(0),
           "force/length", "springs of actuators"},
          {"contact_stiffness", &Physics::contact_stiffness, at_least(0), "force/length",
           "per depth of penetration"},
          {"contact_margin", &Physics::contact_margin, at_least(0), "length",
           "added to every penetration"},
          {"contact_damping", &Physics::contact_damping, at_least(0), "force/velocity",
           "along the normal of a contact"},
          {"friction_coefficient", &Physics::friction_coefficient, at_least(0), "1",
           "between objects"},
          {"friction_multiplier", &Physics::friction_multiplier, at_least(0), "1",
           "between objects"},
          {"floor_stiffness", &Physics::floor_stiffness, at_least(0), "force/length",
           "of the world floor at y = 0"},
          {"floor_friction_coefficient", &Physics::floor_friction_coefficient, at_least(0), "1",
           "on the world floor"},
          {"floor_friction_multiplier", &Physics::floor_friction_multiplier, at_least(0), "1",
           "on the world floor"},
          {"strain_limit", &Physics::strain_limit, at_least(0), "share of rest length",
           "free strain of a spring"},
          {"strain_correction", &Physics::strain_correction, at_least(0), "share",
           "of the excess taken back"},
          {"rigid_strain_limit", &Physics::rigid_strain_limit, at_least(0), "share of rest length",
           "free strain of a rigid cell's edge"},
          {"rigid_strain_correction", &Physics::rigid_strain_correction, at_least(0), "share",
           "of the excess taken back"},
          {"min_target", &Physics::min_target, above(0), "share of rest length",
           "smallest actuator target"},
          {"max_target", &Physics::max_target, above(0), "share of rest length",
           "largest actuator target"},
      },
      check_targets);
}

}  // namespace

template class Profiles<Physics>;

const Profiles<Physics>& physics_profiles() {
  static const Profiles<Physics> profiles("physics", "constant", format::physics, "evogym",
                                          table());
  return profiles;
}

}  // namespace evo
