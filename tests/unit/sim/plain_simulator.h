// The physics page written down once more, as plainly as possible: no lists of
// neighbours, no vectors, every pair of cells at every substep. The oracle that
// the real stepping code is compared with, bit for bit.
#pragma once

#include "libevo/sim/batch.h"

namespace evo {

// One control step, as Batch::step does it for a lane; never `unstable`.
LaneStatus plain_step(const Model& model, State& state);

}  // namespace evo
