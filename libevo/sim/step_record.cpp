#include "libevo/sim/step_record.h"

#include <new>

#include "libevo/sim/compiled.h"
#include "libevo/sim/contact_adjoint.h"

namespace evo {

void StepRecord::begin(const Group& group, const Lane* first_lane, double half_width) {
  const bool is_new = kind != group.kind || width != group.width();
  kind = group.kind;
  width = group.width();
  onset = half_width * kind->physics().voxel_length;
  members.clear();
  for (const Lane* lane : group.lanes)
    members.push_back(
        {static_cast<std::size_t>(lane - first_lane), lane->model, lane->targets, true});
  first_touch.clear();
  touches.clear();
  lane_touches_ = 0;
  n_ = pair_offset(kind->plan().sites, width);
  most_substeps_ = static_cast<std::size_t>(kind->physics().substeps);
  const std::size_t needed = (most_substeps_ * rows + 2) * n_;
  if (needed > capacity_) {
    capacity_ = 0;  // should there be no memory
    values_ = hwy::AllocateAligned<double>(needed);
    if (!values_) throw std::bad_alloc();
    capacity_ = needed;
  }
  if (is_new) std::fill_n(values_.get(), needed, 0.0);  // velocities of what is held stay 0
}

void StepRecord::begin_substep(const double* previous) {
  if (first_touch.empty()) std::copy_n(previous, n_, row(most_substeps_, position));
  first_touch.push_back(touches.size());
}

void StepRecord::end_touches(const Model::Compiled& world, const ContactLists& lists,
                             const PointView& view, std::size_t lane) {
  if (onset > 0.0) find_missed(world, lists, view, onset, touches);
  for (; lane_touches_ < touches.size(); ++lane_touches_)
    touches[lane_touches_].lane = static_cast<std::uint32_t>(lane);
}

void StepRecord::end(const double* positions, const std::vector<Lane*>& lanes) {
  std::copy_n(positions, n_, row(most_substeps_, position) + n_);
  for (std::size_t i = 0; i < lanes.size(); ++i)
    members[i].is_done = lanes[i]->status == LaneStatus::done;
}

}  // namespace evo
