// What a simulation is built from: named bodies placed in a grid of cells, and
// the constants of the physics.
#pragma once

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

}  // namespace evo
