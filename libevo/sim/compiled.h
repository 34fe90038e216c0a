// What a Model holds: the world as arrays that stepping reads. Private to libevo/sim and its tests.
//
// Points are named by an index: i < moving_points is the i-th point of the
// objects that can move, its index in State; i >= moving_points is point
// i - moving_points of the static terrain.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libevo/sim/bounding_tree.h"
#include "libevo/sim/model.h"
#include "libevo/sim/plan.h"

namespace evo {

// The four sides of a cell in the order contact and strain limiting visit them,
// and its corners in the order of ModelCell::points.
enum Side { top, right, bottom, left };
enum Corner { top_left, top_right, bottom_left, bottom_right };

struct Spring {
  int a = 0;  // ends, oriented as the outward normal demands (docs/physics.md, "Surface")
  int b = 0;
  double rest = 0.0;
  double stiffness = 0.0;
  bool operator==(const Spring&) const = default;
};

// A driven spring; its goal length is the mean target of its one or two
// actuators times its rest length. One actuator is listed twice.
struct Drive {
  int spring = 0;
  int first_actuator = 0;
  int second_actuator = 0;
  bool operator==(const Drive&) const = default;
};

// A spring's stiffness is the sum of its voxels' factors, each times what stands here.
struct VoxelSpring {
  int cell = 0;  // of Model::cells()
  int spring = 0;
  double stiffness = 0.0;
};

// A cell with at least one side that has no linked neighbour. Its points by site of the plan,
// static ones from Plan::sites on.
struct SurfaceCell {
  std::array<std::int32_t, 4> corners{};               // by Corner
  std::array<std::array<std::int32_t, 2>, 4> edges{};  // ends a, b by Side
  std::array<bool, 4> surface{};                       // by Side
  std::int32_t object = 0;                             // world order
  std::int32_t row = 0;                                // in the object's matrix
  std::int32_t col = 0;
};

// The part of the world that can move, over State's points. Models with equal
// dynamics can share vector registers wherever their objects and terrain lie.
struct Dynamics {
  int points = 0;
  std::vector<std::uint8_t> fixed;  // [points] 1 for corners of fixed cells
  std::vector<Spring> springs;      // objects in world order: edges, then diagonals
  std::vector<int> rigid_edges;     // springs, four per rigid cell by Side, world order
  std::vector<Drive> drives;
  int actuators = 0;  // of all robots
  bool operator==(const Dynamics&) const = default;
};

// Range of surface cells of one object.
struct SurfaceRange {
  int first = 0;
  int count = 0;
};

// Which surface cell lies at a cell of the world's grid, for terrain.
struct TerrainGrid {
  int x0 = 0;  // world cell of the lower-left entry
  int y0 = 0;
  int width = 0;
  int height = 0;
  std::vector<std::int32_t> cells;  // row-major, bottom row first; -1 for none
};

// What the order of contacts has room for (contact_search.cpp).
inline constexpr std::size_t max_objects = 1U << 10;
inline constexpr std::size_t max_surface_cells = 1U << 22;

struct Model::Compiled {
  Physics physics;
  double length_scale = 1.0;  // a voxel's length in those of the benchmark, 0.1
  std::vector<ModelObject> objects;
  std::vector<ModelCell> cells;
  std::vector<Vec2> initial_positions;  // world order
  std::vector<int> point_indices;       // of every point in world order
  int actuators = 0;                    // of the first object

  int moving_points = 0;
  std::vector<Vec2> static_points;  // by index - moving_points
  Dynamics dynamics;
  std::vector<VoxelSpring> voxel_springs;

  std::vector<SurfaceCell> surface;          // world order
  std::vector<SurfaceRange> surface_ranges;  // [objects]
  std::vector<std::uint8_t> is_robot;        // [objects] it has an actuator
  std::vector<int> block;                    // [objects] of the plan, -1 for static ones
  std::vector<int> object_of_block;

  Plan plan;
  TerrainGrid terrain;
  std::vector<BoundingTree> trees;  // [objects]

  bool is_static(const SurfaceCell& cell) const { return cell.corners[0] >= plan.sites; }
};

// Throws Error(data) as the constructor of Model does.
Model::Compiled compile(const World& world, const Physics& physics);

}  // namespace evo
