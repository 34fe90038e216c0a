#include "libevo/sim/workspace.h"

#include <algorithm>
#include <new>

namespace evo {
namespace {

// Lays arrays out one after the other: first without memory, to know how much
// they need, then in it.
class Layer {
 public:
  explicit Layer(std::byte* memory) : memory_(memory) {}

  // Every array starts at a cache line, and one line more keeps equal indices of
  // two arrays out of the same cache set.
  template <class T>
  void take(T*& array, std::size_t n) {
    constexpr std::size_t line = HWY_ALIGNMENT;
    if (memory_) array = reinterpret_cast<T*>(memory_ + bytes_);
    bytes_ += (n * sizeof(T) + line - 1) / line * line + line;
  }
  std::size_t bytes() const { return bytes_; }

 private:
  std::byte* memory_;
  std::size_t bytes_ = 0;
};

std::size_t pairs(std::size_t count, const Layout& layout) { return 2 * count * layout.lanes; }

std::size_t lay_out(Arrays& arrays, const Plan& plan, const Layout& layout, std::byte* memory) {
  const std::size_t springs = plan.a.size();
  const std::size_t positions = pairs(static_cast<std::size_t>(plan.sites), layout);
  const std::size_t r = layout.record_points;
  const std::size_t points = pairs((plan.points.size() + r - 1) / r * r, layout);
  Layer layer(memory);
  layer.take(arrays.stage_position[0], positions);
  layer.take(arrays.stage_position[1], positions);
  layer.take(arrays.contact, positions);
  layer.take(arrays.motion, Motion::pairs * points);
  layer.take(arrays.travel, (plan.blocks.size() + 2) * layout.lanes);
  layer.take(arrays.goal, springs * layout.lanes);
  layer.take(arrays.kept, springs * layout.lanes);
  layer.take(arrays.force, (springs + 1) * layout.force_record);
  layer.take(arrays.correction, pairs(springs, layout));
  layer.take(arrays.corrected, plan.strain.a.size());
  return layer.bytes();
}

// Highway answers with nothing when there is no memory.
hwy::AlignedFreeUniquePtr<std::byte[]> aligned_bytes(std::size_t count) {
  auto memory = hwy::AllocateAligned<std::byte>(count);
  if (!memory) throw std::bad_alloc();
  return memory;
}

}  // namespace

Rows::Rows(const Plan& plan, std::size_t lanes) {
  const std::size_t values = pair_offset(plan.sites, lanes);
  for (std::byte* memory = nullptr;; memory = memory_.get()) {
    Layer layer(memory);
    for (double** array : {&position, &previous, &velocity, &self_listing, &pair_listing})
      layer.take(*array, values);
    if (memory) return;
    memory_ = aligned_bytes(layer.bytes());
    std::fill_n(memory_.get(), layer.bytes(), std::byte{0});
  }
}

Tables::Tables(const Plan& plan, const Layout& laid_out) : layout(laid_out) {
  const auto at = [&](std::int32_t site) {
    return static_cast<std::uint32_t>(pair_offset(site, layout.lanes));
  };
  spring_ends.reserve(plan.a.size());
  for (std::size_t s = 0; s < plan.a.size(); ++s)
    spring_ends.push_back({at(plan.a[s]), at(plan.b[s])});
  strain_ends.reserve(plan.strain.a.size());
  for (std::size_t s = 0; s < plan.strain.a.size(); ++s)
    strain_ends.push_back({at(plan.strain.a[s]), at(plan.strain.b[s])});
  point_offsets.reserve(plan.points.size());
  for (const PlanPoint& point : plan.points) point_offsets.push_back(at(point.site));
  ends.reserve(plan.ends.size());
  for (const std::int32_t end : plan.ends)
    ends.push_back(static_cast<std::uint32_t>(
        place_of_force(static_cast<std::size_t>(end), layout.dealt_springs) * layout.force_record +
        layout.force_offset));
}

Arrays Workspace::prepare(const Plan& plan, const Tables& tables, const Rows& rows) {
  const Layout& layout = tables.layout;
  Arrays arrays;
  const std::size_t needed = lay_out(arrays, plan, layout, nullptr);
  if (needed > capacity_) {
    capacity_ = 0;  // should there be no memory
    memory_ = aligned_bytes(needed);
    capacity_ = needed;
  }
  lay_out(arrays, plan, layout, memory_.get());
  std::fill_n(arrays.force + plan.a.size() * layout.force_record, layout.force_record, 0.0);
  std::fill_n(arrays.travel, (plan.blocks.size() + 2) * layout.lanes, 0.0);

  arrays.position = rows.position;
  arrays.previous = rows.previous;
  arrays.self_listing = rows.self_listing;
  arrays.pair_listing = rows.pair_listing;
  arrays.stiffness = plan.stiffness.data();
  arrays.spring_ends = tables.spring_ends.data();
  arrays.strain_ends = tables.strain_ends.data();
  arrays.point_offsets = tables.point_offsets.data();
  arrays.ends = tables.ends.data();
  return arrays;
}

}  // namespace evo
