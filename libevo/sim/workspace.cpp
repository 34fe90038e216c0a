#include "libevo/sim/workspace.h"

namespace evo {

void Workspace::prepare(const Plan& plan, std::size_t lanes) {
  const std::size_t slots = static_cast<std::size_t>(plan.slots);
  const std::size_t springs = plan.a.size();
  // Every array starts at a cache line; a vector load of four or eight springs
  // may read a little past the last.
  constexpr std::size_t line = HWY_ALIGNMENT / sizeof(double);
  // One line more, so that equal indices of two arrays do not share a cache set.
  const auto rounded = [](std::size_t n) { return (n + line - 1) / line * line + line; };
  const std::size_t per_slot = rounded(2 * slots * lanes);
  const std::size_t per_spring = rounded(springs * lanes);
  const std::size_t needed = 10 * per_slot + 2 * per_spring + 2 * rounded(2 * springs * lanes);
  if (needed > capacity_) {
    memory_ = hwy::AllocateAligned<double>(needed);
    capacity_ = needed;
  }
  double* next = memory_.get();
  const auto take = [&next](std::size_t n) {
    double* taken = next;
    next += n;
    return taken;
  };
  for (double** array : {&position, &previous, &velocity, &stage_position, &stage_velocity,
                         &position_sum, &velocity_sum, &contact, &self_reference, &pair_reference})
    *array = take(per_slot);
  goal = take(per_spring);
  length = take(per_spring);
  force = take(rounded(2 * springs * lanes));
  correction = take(rounded(2 * springs * lanes));
  if (corrected_.size() < springs) corrected_.resize(springs);
  corrected = corrected_.data();
}

}  // namespace evo
