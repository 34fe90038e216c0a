// What pushes an object from outside, from its motion alone.
#pragma once

#include <span>

#include "libevo/sim/model.h"
#include "libevo/sim/physics.h"

namespace evo::render {

// What everything outside presses on an object with, in its own weights, y upwards: the
// force that its centre's acceleration, its weight and the drag leave to explain, a mean
// over the steps around `step`. `centres` in voxels, one per step; zero for fewer than
// three.
Vec2 outside_force(std::span<const Vec2> centres, int step, const Physics& physics);

}  // namespace evo::render
