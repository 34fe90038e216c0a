// Trajectories measured on the benchmark's simulator (tests/data/reference) and
// the worlds they were measured in.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libevo/sim/model.h"
#include "libevo/sim/world.h"

namespace evo {

struct ReferenceCase {
  std::string name;
  World world;
  int steps = 0;
  int points = 0;
  std::vector<double> actions;  // [steps x actuators]
  std::vector<Vec2> positions;  // [steps+1 x points], raw units, world order

  std::span<const double> action(int step) const;
  std::span<const Vec2> positions_after(int steps) const;
};

// All of tests/data/reference by name: "Walker-v0_A", "extra/floor", ...
std::vector<std::string> reference_names();
ReferenceCase read_reference(const std::string& name);

}  // namespace evo
