// How a robot came about: its line of parents, and what changed at each step.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "render/report/run.h"

namespace evo::report {

// A voxel that is not what it is in the parent.
struct Change {
  int row = 0;
  int col = 0;
  Voxel before = Voxel::empty;
  Voxel after = Voxel::empty;
};

// Nothing when the bodies differ in size: their cells have nothing in common.
std::optional<std::vector<Change>> changes(const Body& parent, const Body& child);

// The first parent that the robot names and that is in the run.
std::optional<std::size_t> parent(const Run& run, std::size_t robot);

// From the first ancestor to the robot itself, along first parents.
std::vector<std::size_t> lineage(const Run& run, std::size_t robot);

}  // namespace evo::report
