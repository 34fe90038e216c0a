// What a simulation is built from: named bodies placed in a grid of cells, and
// the constants of the physics.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "libevo/body/body.h"

namespace evo {

struct Object {
  std::string name;
  Body body;
  int x = 0;  // world cell of the lower-left corner of the whole matrix;
  int y = 0;  // y counts upwards, 0 is the world floor
};

// Objects in any order; Model brings them into world order (objects with an
// actuator first, then by name; docs/physics.md, "World order").
struct World {
  std::vector<Object> objects;
};

// The first object that cannot be where or what it is: its name is an earlier one's, it lies left
// of the world or below it, or shares a cell with an earlier one. Bodies are without defect.
struct WorldDefect {
  std::size_t object = 0;
  std::string text;  // names it
};
std::optional<WorldDefect> defect(const World& world);

}  // namespace evo
