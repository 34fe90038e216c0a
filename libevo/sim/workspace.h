// The arrays that environments are stepped in, in three parts by who owns them:
// what lasts from step to step (Rows, of a group), what follows from the plan alone
// (Tables, shared by groups), and what a control step needs for itself (Workspace,
// of a thread). Kernels see all three as Arrays.
//
// Shapes below are of W lanes, N sites (Plan::sites), P points (Plan::points, R to a
// record), S springs (Plan::springs with their padding) and B blocks (Plan::blocks).
// Every pair (x, y) is W values of x, then W values of y.
#pragma once

#include <hwy/aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libevo/sim/contact_push.h"
#include "libevo/sim/contact_search.h"
#include "libevo/sim/plan.h"

namespace evo {

// ---- addresses ------------------------------------------------------------------------

// A record of Arrays::motion: what is known of R successive points of the plan, R being
// Layout::record_points. Every quantity is R pairs side by side, the first at [n*W*R], n
// being its number here: neighbours share a register.
struct Motion {
  static constexpr std::size_t velocity = 0;        // length/time, at the start of the substep
  static constexpr std::size_t stage_velocity = 2;  // of the stage that comes next
  static constexpr std::size_t position_sum = 4;    // k1 + 2 k2 + 2 k3 + k4
  static constexpr std::size_t velocity_sum = 6;
  static constexpr std::size_t pairs = 4;
};

// Offsets of a spring's ends in arrays of positions.
struct SpringEnds {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
};

// How a kernel lays out its arrays.
struct Layout {
  std::size_t lanes = 1;          // W
  std::size_t record_points = 1;  // R, points per record of Motion
  std::size_t force_record = 2;   // values per spring in Arrays::force
  std::size_t force_offset = 0;   // of the force in that record
  std::size_t dealt_springs = 1;  // how many records are dealt together (place_of_force)
  bool operator==(const Layout&) const = default;
};

// Which record of Arrays::force is a spring's. A register of x and one of y are stored
// with the fewest shuffles as the pairs of its even springs, then those of its odd ones.
constexpr std::size_t place_of_force(std::size_t spring, std::size_t dealt_springs) {
  const std::size_t s = spring % dealt_springs;
  return spring - s + s % 2 * (dealt_springs / 2) + s / 2;
}

// Where the first quantity of a point is in Arrays::motion.
template <std::size_t lanes, std::size_t record_points>
constexpr std::size_t record_offset(std::size_t point) {
  const std::size_t within = point % record_points;
  return 2 * lanes * (Motion::pairs * (point - within) + within);
}

// ---- what lasts -------------------------------------------------------------------------

// The states of a group of environments.
class Rows {
 public:
  Rows() = default;
  Rows(const Plan& plan, std::size_t lanes);  // all zero

  double* position = nullptr;      // [N pairs] raw length
  double* previous = nullptr;      // [N pairs] one substep earlier
  double* velocity = nullptr;      // [N pairs] length/time
  double* self_listing = nullptr;  // [N pairs] where contact lists of blocks were found
  double* pair_listing = nullptr;  // [N pairs] the same of lists between objects

 private:
  hwy::AlignedFreeUniquePtr<std::byte[]> memory_;
};

// ---- what follows from the plan --------------------------------------------------------

// The plan's tables as numbers and offsets that a kernel of one layout reads. The
// plan must outlive them.
struct Tables {
  Tables(const Plan& plan, const Layout& layout);

  Layout layout;
  std::vector<SpringEnds> spring_ends;       // [S] into positions
  std::vector<SpringEnds> strain_ends;       // of Plan::strain
  std::vector<std::uint32_t> point_offsets;  // of Plan::points, into positions
  std::vector<std::uint32_t> ends;           // of Plan::ends, into forces
};

// ---- what a control step needs -----------------------------------------------------------

// Kernels keep a copy of these pointers in locals: values stored through vectors
// might change any other copy, for all that the compiler knows.
struct Arrays {
  // The group's; position and previous change places in every substep.
  double* position = nullptr;  // [N pairs] at the start of the substep
  double* previous = nullptr;  // [N pairs] before it; stage 4 puts the next positions here
  double* self_listing = nullptr;
  double* pair_listing = nullptr;

  // From substep to substep.
  double* contact = nullptr;          // [N pairs] force, constant in a substep, by contacts
  double* motion = nullptr;           // [P records of Motion] by stages 1 to 4
  double* travel = nullptr;           // [B + 2] x W, raw length, by add_travel (contact.h)
  double* correction = nullptr;       // [S pairs] raw length, by limit_strain: of springs
  std::int32_t* corrected = nullptr;  // [S] beyond their limit, in turn, and which they are
  double* goal = nullptr;             // [S] x W goal length, at the start of a control step

  // Within a substep.
  double* stage_position[2] = {};  // [N pairs] where a stage evaluates, and the next, by stages
  double* kept = nullptr;          // [S] rest length, by stage 1 for the others, in Alone
  double* force = nullptr;         // [S + 1 records] by springs; the last is the null spring's

  // Tables, and the plan's stiffness: [S] force per length.
  const double* stiffness = nullptr;
  const SpringEnds* spring_ends = nullptr;
  const SpringEnds* strain_ends = nullptr;
  const std::uint32_t* point_offsets = nullptr;
  const std::uint32_t* ends = nullptr;
};

// A thread's own memory, kept from step to step, so that stepping does not allocate.
class Workspace {
 public:
  // Room for one control step of a group; forces of the null spring and travel are 0.
  Arrays prepare(const Plan& plan, const Tables& tables, const Rows& rows);

  ContactSearch search;
  std::vector<const ContactCandidate*> inside;  // of all lanes, in turn
  ContactPushes pushes;
  std::vector<double> folded;  // states of lanes that stopped before the others

 private:
  hwy::AlignedFreeUniquePtr<std::byte[]> memory_;
  std::size_t capacity_ = 0;  // bytes
};

}  // namespace evo
