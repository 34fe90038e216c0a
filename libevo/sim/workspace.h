// The arrays a group of environments is stepped in. They belong to the calling
// thread and are kept from step to step, so that stepping does not allocate.
#pragma once

#include <hwy/aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "libevo/sim/physics.h"
#include "libevo/sim/plan.h"

namespace evo {

// Numbers within a substep. Positions and velocities from substep to substep, and
// all of contact, are double in either arithmetic.
template <Arithmetic arithmetic>
using StageReal = std::conditional_t<arithmetic == Arithmetic::exact, double, float>;

// A slot's record in Arrays::motion holds (x, y) pairs of these; with W lanes, the
// x of a pair is at [n*W], n being its number here, its y at [n*W + W].
struct Motion {
  static constexpr std::size_t velocity = 0;
  static constexpr std::size_t contact = 2;  // contact force, constant in a substep
  // Exact arithmetic only:
  static constexpr std::size_t stage_velocity = 4;
  static constexpr std::size_t position_sum = 6;  // k1 + 2 k2 + 2 k3 + k4
  static constexpr std::size_t velocity_sum = 8;

  static constexpr std::size_t pairs(Arithmetic arithmetic) {
    return arithmetic == Arithmetic::exact ? 5 : 2;
  }
};

// The same in Arrays::stage_motion, of fast arithmetic.
struct StageMotion {
  static constexpr std::size_t velocity_of(int stage) {  // that stage 1, 2, 3 or 4 sees
    return 2 * static_cast<std::size_t>(stage - 1);
  }
  static constexpr std::size_t load = 8;  // contact and gravity
  static constexpr std::size_t pairs = 5;
};

// Offsets of a spring's ends in arrays of positions.
struct SpringEnds {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
};

// How a kernel lays out its arrays.
struct Layout {
  std::size_t lanes = 1;
  std::size_t force_record = 2;  // values a spring in Arrays::force
  std::size_t force_offset = 0;  // of the force in that record
};

// The arrays. Kernels keep a copy of these pointers in locals: values stored
// through vectors might change any other copy, for all that the compiler knows.
template <Arithmetic arithmetic>
struct Arrays {
  using Real = StageReal<arithmetic>;

  // Positions: for W lanes, slot i has its W values of x at [2*i*W], its W
  // values of y at [2*i*W + W].
  double* position = nullptr;        // at the start of the substep
  double* previous = nullptr;        // one substep earlier; then the next positions
  double* self_reference = nullptr;  // where contact lists were made
  double* pair_reference = nullptr;
  double* motion = nullptr;  // a record a slot
  double* travel = nullptr;  // W values a block, of what is static and of the fastest (contact.h)
  double* correction = nullptr;       // springs: of those beyond their strain limit, in turn
  std::int32_t* corrected = nullptr;  // springs: which they are

  // Within a substep. Fast arithmetic keeps positions there relative to the origin
  // of their block.
  Real* stage_position[2] = {};  // where a Runge-Kutta stage evaluates, and the next
  Real* goal = nullptr;          // springs: goal length
  Real* kept = nullptr;          // springs: what SpringMath keeps, in Alone
  Real* force = nullptr;         // springs and the null spring: a record each
  double* origin = nullptr;      // a pair a block, in fast arithmetic, as all below
  Real* start = nullptr;         // `position`
  Real* stage_motion = nullptr;  // a record a slot

  // The plan's tables as numbers and offsets of these arrays.
  const Real* stiffness = nullptr;  // springs
  const SpringEnds* spring_ends = nullptr;
  const SpringEnds* strain_ends = nullptr;
  const std::uint32_t* point_offsets = nullptr;  // positions of Plan::points
  const std::uint32_t* ends = nullptr;           // forces of Plan::ends

  // Where stage 1 evaluates.
  const Real* stage_start() const {
    if constexpr (arithmetic == Arithmetic::exact)
      return position;
    else
      return start;
  }
};

class Workspace {
 public:
  // Makes room for a plan, and its tables.
  template <Arithmetic arithmetic>
  Arrays<arithmetic> prepare(const Plan& plan, const Layout& layout);

  std::size_t bytes() const;  // held at present

 private:
  template <Arithmetic arithmetic>
  Arrays<arithmetic> lay_out(const Plan& plan, const Layout& layout);

  hwy::AlignedFreeUniquePtr<std::byte[]> memory_;
  std::size_t capacity_ = 0;  // bytes
  std::vector<float> stiffness_;
  std::vector<std::int32_t> corrected_;
  std::vector<SpringEnds> spring_ends_, strain_ends_;
  std::vector<std::uint32_t> point_offsets_, ends_;
};

}  // namespace evo
