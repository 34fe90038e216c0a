// Where a robot touches something, and what pushes it, from its motion alone.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libevo/sim/physics.h"
#include "render/mesh.h"

namespace evo::render {

// Points no farther from a cell of another object than the contact model reaches, 0.06
// voxels; the world's floor counts as terrain.
struct Contacts {
  std::vector<Vec2> points;       // of the robot and what it touches, on either side
  std::vector<Vec2> ground;       // those of them where the robot or what it holds meets terrain
  std::vector<std::size_t> held;  // objects that move and touch the robot
};
// Of the first object. `points` are all of the world at one moment, voxels.
Contacts contacts_of(const Mesh& mesh, std::span<const Vec2> points);

// What everything outside presses on an object with, in its own weights, y upwards: the
// force that its centre's acceleration, its weight and the drag leave to explain, a mean
// over the steps around `step`. `centres` in voxels, one per step; zero for fewer than
// three.
Vec2 outside_force(std::span<const Vec2> centres, int step, const Physics& physics);

}  // namespace evo::render
