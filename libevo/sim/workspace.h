// The arrays a group of environments is stepped in. They belong to the calling
// thread and are kept from step to step, so that stepping does not allocate.
#pragma once

#include <hwy/aligned_allocator.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libevo/sim/plan.h"

namespace evo {

// Lane-interleaved: for W lanes, point (or spring) i has its W values of x at
// [2*i*W] and its W values of y at [(2*i+1)*W]; scalars of springs at [i*W].
struct Workspace {
  double* position = nullptr;         // slots: at the start of the substep
  double* previous = nullptr;         // slots: one substep earlier; then the next positions
  double* velocity = nullptr;         // slots
  double* stage_position = nullptr;   // slots: where a Runge-Kutta stage evaluates
  double* stage_velocity = nullptr;   // slots
  double* position_sum = nullptr;     // slots: k1 + 2 k2 + 2 k3 + k4
  double* velocity_sum = nullptr;     // slots
  double* contact = nullptr;          // slots: contact forces of the substep
  double* self_reference = nullptr;   // slots: where contact lists were made
  double* pair_reference = nullptr;   // slots
  double* goal = nullptr;             // springs, one value: goal length
  double* length = nullptr;           // springs, one value: rest length L of the substep
  double* force = nullptr;            // springs
  double* correction = nullptr;       // springs: of those beyond their strain limit, in turn
  std::int32_t* corrected = nullptr;  // springs: which they are

  // Lays the arrays out for a plan and a number of lanes.
  void prepare(const Plan& plan, std::size_t lanes);

 private:
  hwy::AlignedFreeUniquePtr<double[]> memory_;
  std::size_t capacity_ = 0;
  std::vector<std::int32_t> corrected_;
};

}  // namespace evo
