// Training profiles as YAML: every setting of libevo/control/settings.h by name;
// a profile may start from another one (paper, if it names none) and give only
// what differs.
#pragma once

#include "formats/io/profile.h"
#include "libevo/control/settings.h"

namespace evo {

extern template class Profiles<TrainingSettings>;

const Profiles<TrainingSettings>& training_profiles();

}  // namespace evo
