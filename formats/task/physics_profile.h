// Physics profiles as YAML (docs/physics.md, "Profiles"): every constant of
// libevo/sim/physics.h by name; a profile may start from another one (evogym, if
// it names none) and give only what differs.
#pragma once

#include "formats/io/profile.h"
#include "libevo/sim/physics.h"

namespace evo {

extern template class Profiles<Physics>;

const Profiles<Physics>& physics_profiles();

}  // namespace evo
