// From a world to the arrays of Model::Compiled.
#pragma once

#include "libevo/sim/compiled.h"

namespace evo {

// Throws Error(data) as the constructor of Model does.
Model::Compiled compile(const World& world, const Physics& physics);

}  // namespace evo
