// A world compiled into what stepping needs: point masses, springs, surface
// cells, static terrain. Immutable, shared by all environments and threads
// (the Model/State split of MuJoCo). See docs/physics.md, "Building an object".
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libevo/sim/physics.h"
#include "libevo/sim/vec2.h"
#include "libevo/sim/world.h"

namespace evo {

// One object in world order. Its points are [first_point, first_point+points)
// of the world's points, its cells [first_cell, first_cell+cells).
struct ModelObject {
  std::string name;
  int first_point = 0;
  int points = 0;
  int first_cell = 0;
  int cells = 0;
  bool is_static = false;  // made of fixed cells only: terrain, never integrated
};

// One non-empty cell, in world order of objects and scan order of cells.
struct ModelCell {
  int object = 0;
  Voxel type = Voxel::empty;
  std::array<int, 4> points{};  // top-left, top-right, bottom-left, bottom-right
};

class Model {
 public:
  // Throws Error(data) for an object that is not connected, for two objects
  // that share a cell, for duplicate names, for a negative position.
  Model(const World& world, const Physics& physics);
  ~Model();
  Model(Model&&) noexcept;

  const Physics& physics() const;
  const std::vector<ModelObject>& objects() const;  // world order
  const std::vector<ModelCell>& cells() const;
  const std::vector<Vec2>& initial_positions() const;  // all points, raw units
  int points() const;                                  // all points of the world
  int actuators() const;  // of the first object; length of an action vector
  int object_index(const std::string& name) const;  // -1 when there is none

  struct Compiled;  // what the stepping kernels see; private to libevo/sim
  const Compiled& compiled() const { return *compiled_; }

 private:
  std::unique_ptr<const Compiled> compiled_;
};

}  // namespace evo
