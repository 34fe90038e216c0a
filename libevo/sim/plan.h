// The moving part of a world arranged for the stepping kernels: which points
// have to be integrated, in what order, and which springs each one gathers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libevo/sim/physics.h"

namespace evo {

struct Dynamics;

// The kernels number points by slot. Every moving object has a block of slots:
// first its free points, then its anchored, then its held ones, the first two
// sorted by how many springs they gather, so that loops have steady lengths.
//
//   free      not fixed
//   anchored  fixed, but joined by a spring to a point that can move: its final
//             update is zero, its motion within a substep is felt by the other
//   held      fixed and felt by nothing that moves; never touched
struct PlanBlock {
  int first = 0;
  int integrated = 0;  // free and anchored
  int count = 0;
};

// Slots in a row that gather equally many springs, all free or all anchored.
struct PlanRun {
  int first = 0;
  int count = 0;
  int a_ends = 0;     // springs whose first end this point is, then
  int b_ends = 0;     // springs whose second end it is
  int first_end = 0;  // into Plan::ends; a_ends + b_ends entries a point
  bool anchored = false;
};

// What strain limiting compares with. A spring is within its limits when the
// square of its length is in [shortest_square, longest_square]: the very same
// answer as comparing length / rest, roundings included, without a root.
struct StrainLimit {
  double shortest_square = 0.0;
  double longest_square = 0.0;
  double shortest = 0.0;  // lengths that a spring beyond a limit is brought back to
  double longest = 0.0;
};

struct Plan {
  int slots = 0;
  std::vector<std::int32_t> slot_of;   // State index -> slot
  std::vector<std::int32_t> state_of;  // slot -> State index
  std::vector<PlanBlock> blocks;       // one a moving object, world order
  std::vector<PlanRun> runs;
  std::vector<std::int32_t> ends;  // spring numbers, in the order forces are summed

  // Springs in the order of Dynamics. The first `live_springs` change: an end
  // can move. Frozen ones follow, between fixed points, one of them anchored:
  // their force is the same in every substep of a control step. The arrays are
  // padded with copies of the last spring up to a multiple of spring_padding.
  static constexpr int spring_padding = 8;
  int live_springs = 0;
  int springs = 0;
  std::vector<std::int32_t> a, b;            // slots of the ends
  std::vector<std::uint8_t> a_free, b_free;  // strain limiting may move this end
  std::vector<double> rest;
  std::vector<double> stiffness;
  std::vector<double> shortest_square, longest_square;  // of `limits`, for vector loads
  std::vector<StrainLimit> limits;

  std::vector<std::int32_t> rigid_edges;  // springs of rigid cells, in order of correction
  std::vector<StrainLimit> rigid_limits;

  // Drives whose spring something feels.
  struct Drive {
    std::int32_t spring = 0;
    std::int32_t first_actuator = 0;
    std::int32_t second_actuator = 0;
  };
  std::vector<Drive> drives;
};

// `first_points`: the State indices at which the moving objects start, and one
// more entry, the number of points.
Plan make_plan(const Dynamics& dynamics, const std::vector<int>& first_points,
               const Physics& physics);

}  // namespace evo
