// The stepping kernels, compiled once an instruction set (kernels.cpp).
#pragma once

#include <cstddef>
#include <span>

#include "libevo/sim/compiled.h"
#include "libevo/sim/state.h"
#include "libevo/sim/workspace.h"

namespace evo {

// How environments side by side are laid out under the instruction set in force;
// `lanes` is what one register of the stages holds.
Layout lane_layout(Arithmetic arithmetic);

// One control step of up to a register of environments with equal dynamics and
// physics, side by side in the lanes of vector registers.
void step_side_by_side(std::span<Lane> lanes, Workspace& workspace);

// One control step of one environment, its springs side by side.
void step_alone(Lane& lane, Workspace& workspace);

}  // namespace evo
