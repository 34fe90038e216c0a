// The stepping kernels, compiled once per instruction set (kernels.cpp).
#pragma once

#include <cstddef>

#include "libevo/sim/group.h"

namespace evo {

class StepRecord;

// With fewer in a register, stepping them one by one is faster.
inline constexpr std::size_t fewest_side_by_side = 3;

// How so many environments, at most most_lanes(), are laid out under the instruction
// set in force; one is stepped alone, its springs side by side.
Layout layout_of(std::size_t lanes);

// What one register of the stages holds.
std::size_t most_lanes();

// One control step of a group laid out as layout_of() says. What it did is kept in `record`, if
// there is one.
void step_group(Group& group, Workspace& workspace, StepRecord* record);

}  // namespace evo
