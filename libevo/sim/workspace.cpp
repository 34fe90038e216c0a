#include "libevo/sim/workspace.h"

#include <algorithm>

namespace evo {

template <Arithmetic arithmetic>
Arrays<arithmetic> Workspace::prepare(const Plan& plan, const Layout& layout) {
  Arrays<arithmetic> arrays = lay_out<arithmetic>(plan, layout);
  const auto slot = [&](std::int32_t s) {
    return static_cast<std::uint32_t>(2 * static_cast<std::size_t>(s) * layout.lanes);
  };
  spring_ends_.clear();
  for (std::size_t s = 0; s < plan.a.size(); ++s)
    spring_ends_.push_back({slot(plan.a[s]), slot(plan.b[s])});
  strain_ends_.clear();
  for (std::size_t s = 0; s < plan.strain.a.size(); ++s)
    strain_ends_.push_back({slot(plan.strain.a[s]), slot(plan.strain.b[s])});
  point_offsets_.clear();
  for (const PlanPoint& point : plan.points) point_offsets_.push_back(slot(point.slot));
  ends_.clear();
  for (const std::int32_t end : plan.ends)
    ends_.push_back(static_cast<std::uint32_t>(static_cast<std::size_t>(end) * layout.force_record +
                                               layout.force_offset));
  corrected_.resize(plan.strain.a.size());
  if constexpr (arithmetic == Arithmetic::exact) {
    arrays.stiffness = plan.stiffness.data();
  } else {
    stiffness_.clear();
    for (const double k : plan.stiffness) stiffness_.push_back(static_cast<float>(k));
    arrays.stiffness = stiffness_.data();
  }
  arrays.spring_ends = spring_ends_.data();
  arrays.strain_ends = strain_ends_.data();
  arrays.point_offsets = point_offsets_.data();
  arrays.ends = ends_.data();
  arrays.corrected = corrected_.data();
  return arrays;
}

std::size_t Workspace::bytes() const {
  return capacity_ + stiffness_.capacity() * sizeof(float) +
         corrected_.capacity() * sizeof(std::int32_t) +
         (spring_ends_.capacity() + strain_ends_.capacity()) * sizeof(SpringEnds) +
         (point_offsets_.capacity() + ends_.capacity()) * sizeof(std::uint32_t);
}

template <Arithmetic arithmetic>
Arrays<arithmetic> Workspace::lay_out(const Plan& plan, const Layout& layout) {
  using Real = StageReal<arithmetic>;
  const std::size_t springs = plan.a.size();
  constexpr bool fast = arithmetic == Arithmetic::fast;
  constexpr std::size_t most_kept = 2;
  const std::size_t pair = 2 * layout.lanes;
  const std::size_t positions = pair * static_cast<std::size_t>(plan.slots);
  const std::size_t travels = (plan.blocks.size() + 2) * layout.lanes;

  Arrays<arithmetic> arrays;
  std::byte* memory = nullptr;  // first pass: how much is needed; second: there it is
  std::size_t taken = 0;
  // Every array starts at a cache line, and one line more keeps equal indices
  // of two arrays out of the same cache set.
  const auto take = [&]<class T>(T*& array, std::size_t n) {
    if (memory) array = reinterpret_cast<T*>(memory + taken);
    constexpr std::size_t line = HWY_ALIGNMENT;
    taken += (n * sizeof(T) + line - 1) / line * line + line;
  };
  const auto take_all = [&] {
    take(arrays.position, positions);
    take(arrays.previous, positions);
    take(arrays.stage_position[0], positions);
    take(arrays.stage_position[1], positions);
    take(arrays.self_reference, positions);
    take(arrays.pair_reference, positions);
    take(arrays.motion, Motion::pairs(arithmetic) * positions);
    take(arrays.travel, travels);
    take(arrays.goal, springs * layout.lanes);
    take(arrays.kept, most_kept * springs * layout.lanes);
    take(arrays.force, (springs + 1) * layout.force_record);
    take(arrays.correction, pair * springs);
    if (!fast) return;
    take(arrays.origin, pair * plan.blocks.size());
    take(arrays.start, positions);
    take(arrays.stage_motion, StageMotion::pairs * positions);
  };
  take_all();
  if (taken > capacity_) {
    memory_ = hwy::AllocateAligned<std::byte>(taken);
    capacity_ = taken;
  }
  memory = memory_.get();
  taken = 0;
  take_all();
  std::fill_n(arrays.force + springs * layout.force_record, layout.force_record, Real{0});
  std::fill_n(arrays.travel, travels, 0.0);
  return arrays;
}

template Arrays<Arithmetic::exact> Workspace::prepare<Arithmetic::exact>(const Plan&,
                                                                         const Layout&);
template Arrays<Arithmetic::fast> Workspace::prepare<Arithmetic::fast>(const Plan&, const Layout&);

}  // namespace evo
