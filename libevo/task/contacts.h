// Where a robot touches something, from the positions of one moment alone.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libevo/sim/model.h"

namespace evo {

// Points that the contact model of another object's cell reaches, 0.06
// voxels; the world's floor counts as terrain.
struct Contacts {
  std::vector<Vec2> points;       // of the robot and what it touches, on either side
  std::vector<Vec2> ground;       // those of them where the robot or what it holds meets terrain
  std::vector<std::size_t> held;  // objects that move and touch the robot
};
// Contacts of the first object. `points` are all of the world, voxels.
Contacts contacts_of(std::span<const ModelObject> objects, std::span<const ModelCell> cells,
                     std::span<const Vec2> points);

}  // namespace evo
