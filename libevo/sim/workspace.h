// The arrays a group of environments is stepped in. They belong to the calling
// thread and are kept from step to step, so that stepping does not allocate.
#pragma once

#include <hwy/aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libevo/sim/plan.h"

namespace evo {

// A point's record in Arrays::motion holds (x, y) pairs of these; with W
// lanes, the x of the n-th pair is at [2*n*W], its y at [2*n*W + W].
struct Motion {
  static constexpr std::size_t velocity = 0;
  static constexpr std::size_t stage_velocity = 2;
  static constexpr std::size_t position_sum = 4;  // k1 + 2 k2 + 2 k3 + k4
  static constexpr std::size_t velocity_sum = 6;
  static constexpr std::size_t contact = 8;  // contact force, constant in a substep
  static constexpr std::size_t records = 5;  // pairs

  // Where the velocity is that stage 1, 2, 3 or 4 sees. Fast arithmetic keeps all
  // of them in place of the sums; exact arithmetic keeps the last.
  static constexpr std::size_t velocity_of(int stage, bool keeps_all) {
    if (stage == 1) return velocity;
    return keeps_all ? 2 * static_cast<std::size_t>(stage - 1) : stage_velocity;
  }
};

// Offsets of a spring's ends in arrays of positions.
struct SpringEnds {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  double stiffness = 0.0;
};

// How a kernel lays out its arrays.
struct Layout {
  std::size_t lanes = 1;
  std::size_t force_record = 2;  // values a spring in Arrays::force
  std::size_t force_offset = 0;  // of the force in that record
};

// The arrays. Kernels keep a copy of these pointers in locals: values stored
// through vectors might change any other copy, for all that the compiler knows.
struct Arrays {
  // Positions: for W lanes, slot i has its W values of x at [2*i*W], its W
  // values of y at [2*i*W + W].
  double* position = nullptr;        // at the start of the substep
  double* previous = nullptr;        // one substep earlier; then the next positions
  double* stage_position[2] = {};    // where a Runge-Kutta stage evaluates, and the next
  double* self_reference = nullptr;  // where contact lists were made
  double* pair_reference = nullptr;
  double* motion = nullptr;  // a record a slot
  double* travel = nullptr;  // W values a block, of what is static and of the fastest (contact.h)

  double* goal = nullptr;             // springs: goal length
  double* kept = nullptr;             // springs: what SpringMath keeps, in Alone
  double* force = nullptr;            // springs and the null spring: a record each
  double* correction = nullptr;       // springs: of those beyond their strain limit, in turn
  std::int32_t* corrected = nullptr;  // springs: which they are

  // The plan's tables as offsets in these arrays.
  const SpringEnds* spring_ends = nullptr;
  const SpringEnds* strain_ends = nullptr;
  const std::uint32_t* point_offsets = nullptr;  // positions of Plan::points
  const std::uint32_t* ends = nullptr;           // forces of Plan::ends
};

class Workspace {
 public:
  // Makes room for a plan, and its tables.
  Arrays prepare(const Plan& plan, const Layout& layout);

  std::size_t bytes() const;  // held at present

 private:
  Arrays lay_out(const Plan& plan, const Layout& layout);

  hwy::AlignedFreeUniquePtr<double[]> memory_;
  std::size_t capacity_ = 0;
  std::vector<std::int32_t> corrected_;
  std::vector<SpringEnds> spring_ends_, strain_ends_;
  std::vector<std::uint32_t> point_offsets_, ends_;
};

}  // namespace evo
