// The moving part of a world arranged for the stepping kernels: which points
// have to be integrated, in what order, and which springs each one gathers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libevo/sim/physics.h"

namespace evo {

struct Dynamics;

// The kernels number points by site. Every moving object has a block of sites:
// first its free points, then its anchored, then its held ones.
//
//   free      not fixed
//   anchored  fixed, but joined by a spring to a point that can move: its final
//             update is zero, its motion within a substep is felt by the other
//   held      fixed and felt by nothing that moves; never touched
//
//   sites  0 ........................ n0 | n0 ................ n0+n1 |
//          block 0, first object         | block 1, second object    |
//          free ... anchored ... held    | free ... anchored ... held|
//          <--- integrated --->          | <--- integrated --->      |
//          <--------- count ---------->  |
struct PlanBlock {
  int first = 0;
  int integrated = 0;  // free and anchored
  int count = 0;
};

// Where the pair of a site begins in arrays of one pair per site.
constexpr std::size_t pair_offset(std::int32_t site, std::size_t lanes) {
  return 2 * static_cast<std::size_t>(site) * lanes;
}

// A point with the springs it gathers, in the order in which forces are summed:
// first those whose end a it is, then those whose end b.
struct PlanPoint {
  std::int32_t site = 0;
  std::int32_t first_end = 0;  // into Plan::ends
  std::int32_t a_ends = 0;
  std::int32_t b_ends = 0;
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
  int sites = 0;
  std::vector<std::int32_t> site_of;   // State index -> site
  std::vector<std::int32_t> state_of;  // site -> State index
  std::vector<PlanBlock> blocks;       // one per moving object, world order

  // Springs in the order forces are computed: the first `live_springs` change,
  // as an end can move. Frozen ones, [first_frozen, springs), lie between fixed
  // points, one of them anchored: their force is the same in every substep of a
  // control step. Both are padded with copies of the last spring to a multiple of
  // spring_padding; the spring after that, null_spring, has no force. Some
  // springs are there twice, the second time with their ends exchanged: their
  // mirror images, whose force is the same but for its sign.
  //
  //   | live ............ pad | frozen .... pad | null |
  //   0       live_springs    first_frozen springs  null_spring
  static constexpr int spring_padding = 8;
  int live_springs = 0;
  int first_frozen = 0;
  int springs = 0;
  int null_spring = 0;
  std::vector<std::int32_t> a, b;  // sites of the ends
  std::vector<double> rest;
  std::vector<double> stiffness;

  // Points in the order they are integrated: regular ones, free then anchored;
  // irregular ones, free then anchored. `springs_before` of the i-th regular
  // point: how many springs must have been computed before it; it never falls.
  // `points_before` of a live spring: how many points must have been through the
  // stage before; it never falls, either.
  //
  // A regular point has exactly regular_ends springs of either kind, so that
  // loops over points have no branches: lists are filled up with null_spring, and
  // what one list cannot hold the other one gets as a mirror image, since f - x is
  // f + (-x). No point of a body with all its links has more than eight springs.
  //
  //   | a a a -   b b b b |      - is null_spring
  //     F -= f     F += f
  static constexpr int regular_ends = 4;
  std::vector<PlanPoint> points;
  std::size_t free_regular = 0;  // where the groups of points end
  std::size_t regular = 0;
  std::size_t free_irregular = 0;
  std::vector<std::int32_t> springs_before;
  std::vector<std::int32_t> points_before;
  std::vector<std::int32_t> ends;  // springs

  // Live springs once more, in the order of Dynamics: that of corrections.
  struct Strain {
    std::size_t springs = 0;  // the arrays are padded as above
    std::vector<std::int32_t> a, b;
    std::vector<std::uint8_t> a_free, b_free;             // this end may be moved
    std::vector<double> shortest_square, longest_square;  // of `limits`, for vector loads
    std::vector<StrainLimit> limits;
  } strain;

  // Edges of rigid cells in order of correction.
  struct RigidEdge {
    std::int32_t a = 0;
    std::int32_t b = 0;
    StrainLimit limit;
  };
  std::vector<RigidEdge> rigid_edges;

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
