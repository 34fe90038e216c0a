#include "libevo/sim/workspace.h"

#include <algorithm>

namespace evo {

Arrays Workspace::prepare(const Plan& plan, const Layout& layout) {
  Arrays arrays = lay_out(plan, layout);
  const auto slot = [&](std::int32_t s) {
    return static_cast<std::uint32_t>(2 * static_cast<std::size_t>(s) * layout.lanes);
  };
  spring_ends_.clear();
  for (std::size_t s = 0; s < plan.a.size(); ++s)
    spring_ends_.push_back({slot(plan.a[s]), slot(plan.b[s]), plan.stiffness[s]});
  strain_ends_.clear();
  for (std::size_t s = 0; s < plan.strain.a.size(); ++s)
    strain_ends_.push_back({slot(plan.strain.a[s]), slot(plan.strain.b[s]), 0.0});
  point_offsets_.clear();
  for (const PlanPoint& point : plan.points) point_offsets_.push_back(slot(point.slot));
  ends_.clear();
  for (const std::int32_t end : plan.ends)
    ends_.push_back(static_cast<std::uint32_t>(static_cast<std::size_t>(end) * layout.force_record +
                                               layout.force_offset));
  corrected_.resize(plan.strain.a.size());
  arrays.spring_ends = spring_ends_.data();
  arrays.strain_ends = strain_ends_.data();
  arrays.point_offsets = point_offsets_.data();
  arrays.ends = ends_.data();
  arrays.corrected = corrected_.data();
  return arrays;
}

std::size_t Workspace::bytes() const {
  return capacity_ * sizeof(double) + corrected_.capacity() * sizeof(std::int32_t) +
         (spring_ends_.capacity() + strain_ends_.capacity()) * sizeof(SpringEnds) +
         (point_offsets_.capacity() + ends_.capacity()) * sizeof(std::uint32_t);
}

Arrays Workspace::lay_out(const Plan& plan, const Layout& layout) {
  const std::size_t slots = static_cast<std::size_t>(plan.slots);
  const std::size_t springs = plan.a.size();
  // Every array starts at a cache line, and one line more keeps equal indices
  // of two arrays out of the same cache set.
  constexpr std::size_t line = HWY_ALIGNMENT / sizeof(double);
  constexpr std::size_t most_kept = 2;
  const auto rounded = [](std::size_t n) { return (n + line - 1) / line * line + line; };
  const std::size_t positions = rounded(2 * slots * layout.lanes);
  const std::size_t motions = rounded(Motion::records * 2 * slots * layout.lanes);
  const std::size_t travels = rounded((plan.blocks.size() + 2) * layout.lanes);
  const std::size_t lengths = rounded(springs * layout.lanes);
  const std::size_t kept_values = rounded(most_kept * springs * layout.lanes);
  const std::size_t forces = rounded((springs + 1) * layout.force_record);
  const std::size_t corrections = rounded(2 * springs * layout.lanes);
  const std::size_t needed =
      6 * positions + motions + travels + lengths + kept_values + forces + corrections;
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
  Arrays arrays;
  for (double** array : {&arrays.position, &arrays.previous, &arrays.stage_position[0],
                         &arrays.stage_position[1], &arrays.self_reference, &arrays.pair_reference})
    *array = take(positions);
  arrays.motion = take(motions);
  arrays.travel = take(travels);
  arrays.goal = take(lengths);
  arrays.kept = take(kept_values);
  arrays.force = take(forces);
  arrays.correction = take(corrections);
  std::fill_n(arrays.force + springs * layout.force_record, layout.force_record, 0.0);
  std::fill_n(arrays.travel, travels, 0.0);
  return arrays;
}

}  // namespace evo
