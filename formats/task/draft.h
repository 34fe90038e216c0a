// A world drawn elsewhere as the beginning of a task.
#pragma once

#include <string>

#include "libevo/sim/world.h"

namespace evo {

// A task of this name in the world, as YAML to continue with: an object with actuators
// marks where the robot stands; without one it stands on top of what is leftmost. Walking to
// the right is rewarded. Throws Error(data) for a world with several robots.
std::string draft_task(const World& world, const std::string& name);

}  // namespace evo
