// One control step of a group with either kernel (see kernels.cpp), in the rows of the
// group: only velocities go through the workspace, where kernels have them beside the
// forces. Included once per instruction set (see Highway's "-inl.h" files).
//
// A kernel, SideBySide or Alone, is the arithmetic of a substep over the arrays of a group. It
// says how it lays them out (Layout), how many springs and points one call of its loops' bodies
// does (springs_at_once, points_at_once), and whether points take turns with springs in a stage or
// come after all of them (points_follow). It can, `at` and `next` being positions:
//   springs, last_springs    find the forces of springs_at_once springs, or of all of a range
//   points<n>, point<n>      gather the forces of points_at_once regular points, or of one, and
//                            take it through stage n
//   limit_strain, limit_rigid_strain   after the stages
//   add_travel, square_moved, square_sheared   how far points have moved: since the last substep,
//                            and since lists were found (squares, one value per lane)

#if defined(LIBEVO_SIM_CONTROL_STEP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_SIM_CONTROL_STEP_INL_H_
#undef LIBEVO_SIM_CONTROL_STEP_INL_H_
#else
#define LIBEVO_SIM_CONTROL_STEP_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "libevo/sim/compiled.h"
#include "libevo/sim/contact.h"
#include "libevo/sim/contact_look-inl.h"
#include "libevo/sim/group.h"
#include "libevo/sim/step_record.h"
#include "libevo/sim/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class Kernel>
Layout LayoutOf() {
  return {Kernel::width, Kernel::record_points, Kernel::force_record, Kernel::force_offset,
          Kernel::dealt_springs};
}

template <class Kernel>
class ControlStep {
 public:
  static constexpr std::size_t width = Kernel::width;
  static constexpr std::size_t spacing = Kernel::record_points * width;
  static constexpr std::size_t springs_of_part = 360;

  ControlStep(Group& group, Workspace& workspace, StepRecord* record = nullptr)
      : lanes_(group.lanes),
        plan_(group.kind->plan()),
        physics_(group.kind->physics()),
        rows_(group.rows),
        workspace_(workspace),
        record_(record),
        w_(workspace.prepare(plan_, *group.tables, rows_)) {}

  void run() {
    begin();
    std::fill_n(w_.contact, pair_offset(plan_.sites, width), 0.0);
    workspace_.pushes.forces.clear();
    workspace_.pushes.touches = record_ == nullptr ? nullptr : &record_->touches;
    kernel().template last_springs<true>(w_.position, static_cast<std::size_t>(plan_.first_frozen),
                                         static_cast<std::size_t>(plan_.springs));
    std::size_t running = lanes_.size();
    for (int i = 0; i < physics_.substeps && running > 0; ++i) {
      if (i > 0) kernel().add_travel();
      substep();
      running -= stop_folded();
    }
    end();
  }

 private:
  void substep() {
    if (record_ != nullptr) record_start();
    contacts();
    stages();
    if (record_ != nullptr) record_stages();
    kernel().limit_strain(w_.previous);
    kernel().limit_rigid_strain(w_.previous);
    std::swap(w_.position, w_.previous);
  }

  void record_start() {
    record_->begin_substep(w_.previous);
    record_->keep(StepRecord::position, w_.position);
    double* velocities = record_->row(record_->substeps() - 1, StepRecord::velocity);
    for (std::size_t i = 0; i < plan_.points.size(); ++i)
      std::copy_n(velocity(i), 2 * width, velocities + w_.point_offsets[i]);
  }

  void record_stages() {
    record_->keep(StepRecord::third_stage, w_.stage_position[1]);
    record_->keep(StepRecord::fourth_stage, w_.stage_position[0]);
    record_->keep(StepRecord::after_stages, w_.previous);
  }

  // How far a stage has come.
  struct Progress {
    std::size_t springs = 0;
    std::size_t points = 0;  // regular ones
    bool over = false;
  };

  // The four stages of Runge-Kutta. Where a body is too large for the cache, every
  // stage follows the one before as closely as it can: a part of the body goes through
  // all of them while the cache has it.
  void stages() {
    const std::size_t part = is_large() ? springs_of_part : springs_in_all();
    std::array<Progress, 4> done;
    while (!done[3].over) {
      stage<1>(w_.position, w_.stage_position[0], done[0], done[0].springs + part);
      stage<2>(w_.stage_position[0], w_.stage_position[1], done[1], springs_after(done[0]));
      stage<3>(w_.stage_position[1], w_.stage_position[0], done[2], springs_after(done[1]));
      stage<4>(w_.stage_position[0], w_.previous, done[3], springs_after(done[2]));
    }
  }

  // Whether what the stages read and write is more than a second-level cache holds: per
  // spring its force and what belongs to it, and a third of a point.
  bool is_large() const {
    constexpr std::size_t bytes_per_spring = 9 * width * sizeof(double);
    constexpr std::size_t cache = 1U << 19U;
    return Kernel::points_follow && springs_in_all() * bytes_per_spring > cache;
  }

  std::size_t springs_in_all() const { return static_cast<std::size_t>(plan_.live_springs); }

  // How many springs the next stage may compute. It overwrites nothing that this one
  // still needs: the points at both ends of a spring have gathered all their forces.
  std::size_t springs_after(const Progress& done) const {
    if (done.over) return springs_in_all();
    const std::vector<std::int32_t>& before = plan_.points_before;
    const auto points = static_cast<std::int32_t>(done.points);
    return static_cast<std::size_t>(std::upper_bound(before.begin(), before.end(), points) -
                                    before.begin());
  }

  // One stage, from where it is to spring `end`. Points follow the springs: while the
  // divider works on springs, the rest of the processor integrates points.
  template <int n>
  void stage(const double* HWY_RESTRICT at, double* HWY_RESTRICT next, Progress& done,
             std::size_t end) {
    if (done.over) return;
    const std::size_t springs = std::min(end, springs_in_all());
    const std::size_t regular = n < 3 ? plan_.regular : plan_.free_regular;
    constexpr int few = Plan::regular_ends;
    constexpr std::size_t ends_a_point = 2UL * few;
    const std::uint32_t* ends = w_.ends;
    const Kernel kernel = this->kernel();
    std::size_t s = done.springs;
    std::size_t i = done.points;
    const std::int32_t* const before = plan_.springs_before.data();
    std::size_t ahead = springs_ahead(before, i, regular);
    while (s + Kernel::springs_at_once <= springs) {
      kernel.template springs<n == 1>(at, s);
      s += Kernel::springs_at_once;
      if (HWY_UNLIKELY(s < ahead)) continue;
      kernel.template points<n>(i, ends + ends_a_point * i, at, next);
      i += Kernel::points_at_once;
      ahead = springs_ahead(before, i, regular);
    }
    done = {s, i, springs == springs_in_all()};
    if (!done.over) return;
    kernel.template last_springs<n == 1>(at, s, springs);
    for (; i + Kernel::points_at_once <= regular; i += Kernel::points_at_once)
      kernel.template points<n>(i, ends + ends_a_point * i, at, next);
    for (; i < regular; ++i)
      kernel.template point<n>(i, ends + ends_a_point * i, few, few, at, next);
    for (; i < plan_.regular; ++i) anchored_point<n>(i, next);
    for (; i < plan_.free_irregular; ++i) irregular_point<n>(i, at, next);
    for (; i < plan_.points.size(); ++i) {
      if constexpr (n < 3)
        irregular_point<n>(i, at, next);
      else
        anchored_point<n>(i, next);
    }
  }

  // What others feel of an anchored point is where stages 3 and 4 see it, which
  // the forces of stages 1 and 2 decide; it ends the substep where it began.
  template <int n>
  HWY_INLINE void anchored_point(std::size_t i, double* next) {
    const std::size_t o = w_.point_offsets[i];
    if constexpr (n == 3) {
      const double* velocity = motion(i) + Motion::stage_velocity * spacing;
      for (std::size_t k = 0; k < 2 * width; ++k)
        next[o + k] = w_.position[o + k] + velocity[k] * physics_.substep;
    } else if constexpr (n == 4) {
      std::copy_n(w_.position + o, 2 * width, next + o);
    }
  }

  template <int n>
  HWY_NOINLINE void irregular_point(std::size_t i, const double* at, double* next) {
    const PlanPoint& point = plan_.points[i];
    kernel().template point<n>(i, w_.ends + point.first_end, point.a_ends, point.b_ends, at, next);
  }

  // How many springs are computed before points from the i-th on are integrated: all of
  // theirs, and those whose roots and quotients are under way. `before` is
  // Plan::springs_before, `points` how many there are.
  static HWY_INLINE std::size_t springs_ahead(const std::int32_t* before, std::size_t i,
                                              std::size_t points) {
    constexpr std::size_t at_once = Kernel::points_at_once;
    constexpr std::size_t under_way = 3 * Kernel::springs_at_once;
    if (!Kernel::points_follow || i + at_once > points) return SIZE_MAX;
    return static_cast<std::size_t>(before[i + at_once - 1]) + under_way;
  }

  // Made where it is used, so that its pointers are locals there.
  Kernel kernel() const { return {plan_, physics_, w_}; }

  // The record of a point, and its velocity in there.
  double* motion(std::size_t i) const {
    return w_.motion + record_offset<width, Kernel::record_points>(i);
  }
  double* velocity(std::size_t i) const { return motion(i) + Motion::velocity * spacing; }

  const Model::Compiled& world(std::size_t i) const { return lanes_[i]->model->compiled(); }
  bool runs(std::size_t i) const { return lanes_[i]->status == LaneStatus::done; }
  PointView view(std::size_t i) const {
    return {w_.position + i, w_.previous + i, w_.contact + i, w_.travel + i, width};
  }

  void contacts() {
    renew_lists();
    for (double* force : workspace_.pushes.forces) force[0] = force[width] = 0.0;
    workspace_.pushes.forces.clear();
    ContactLook<width> look(workspace_.inside);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (!runs(i)) continue;
      look.add(world(i), lanes_[i]->contacts, view(i), i);
      folding_[i] = workspace_.search.is_folding(world(i), lanes_[i]->contacts, view(i));
    }
    const std::array<std::size_t, width>& counts = look.finish();
    const ContactCandidate* const* inside = workspace_.inside.data();
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      ContactLists& lists = lanes_[i]->contacts;
      if (counts[i] > 0)
        push_contacts(world(i), {inside, counts[i]}, view(i), lists, workspace_.pushes);
      inside += counts[i];
      if (record_ != nullptr && runs(i)) record_->end_touches(world(i), lists, view(i), i);
    }
  }

  // Finds contact candidates again where something has moved too far. How far is
  // only looked at once the travel since the last look would allow it.
  void renew_lists() {
    const std::size_t blocks = plan_.blocks.size();
    if (is_due(blocks + 1, [](const ContactLists& lists) { return lists.pairs_due; }))
      renew_pair_lists();
    for (std::size_t block = 0; block < blocks; ++block)
      if (is_due(block, [&](const ContactLists& lists) { return lists.self[block].due; }))
        renew_self_lists(block);
  }

  template <class Due>
  bool is_due(std::size_t travel, Due due) const {
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (runs(i) && !(w_.travel[travel * width + i] < due(lanes_[i]->contacts))) return true;
    return false;
  }

  void renew_pair_lists() {
    const double* travel = w_.travel + (plan_.blocks.size() + 1) * width;
    HWY_ALIGN double moved[width];
    kernel().square_moved(moved);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      ContactLists& lists = lanes_[i]->contacts;
      if (!runs(i)) continue;
      const double onset = record_ == nullptr ? 0.0 : record_->onset;  // missed, and yet listed
      const double limit = pair_move_limit * world(i).length_scale - onset;
      if (!lists.pairs_valid || !(moved[i] <= limit * limit)) {
        workspace_.search.find_pairs(world(i), view(i), w_.pair_listing + i, lists);
        moved[i] = 0.0;
      }
      lists.pairs_due = travel[i] + (limit - std::sqrt(moved[i]));
    }
  }

  void renew_self_lists(std::size_t block) {
    const double* travel = w_.travel + block * width;
    HWY_ALIGN double sheared[width];
    kernel().square_sheared(plan_.blocks[block], sheared);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      ContactLists& lists = lanes_[i]->contacts;
      if (!runs(i)) continue;
      const double limit = self_move_limit * world(i).length_scale;
      if (!lists.self[block].valid || !(sheared[i] <= limit * limit)) {
        workspace_.search.find_self(world(i), block, view(i), w_.self_listing + i, lists);
        sheared[i] = 0.0;
      }
      lists.self[block].due = travel[i] + (limit - std::sqrt(sheared[i])) / 2.0;
    }
  }

  // ---- from the rows, and back -------------------------------------------------------

  void begin() {
    for (std::size_t i = lanes_.size(); i < width; ++i) copy_lane(lanes_.size() - 1, i);
    for (std::size_t i = 0; i < plan_.points.size(); ++i)
      std::copy_n(rows_.velocity + w_.point_offsets[i], 2 * width, velocity(i));
    for (const PlanBlock& block : plan_.blocks) {
      const std::size_t held = pair_offset(block.first + block.integrated, width);
      const std::size_t end = pair_offset(block.first + block.count, width);
      // Where stages find the points that no substep moves.
      for (double* copy : {w_.previous, w_.stage_position[0], w_.stage_position[1]})
        std::copy(w_.position + held, w_.position + end, copy + held);
    }
    for (std::size_t s = 0; s < plan_.rest.size(); ++s)
      std::fill_n(w_.goal + s * width, width, plan_.rest[s]);
    for (Lane* lane : lanes_) {
      lane->status = LaneStatus::done;
      lane->contacts.rewind();
    }
    for (std::size_t i = 0; i < width; ++i) {
      const Lane& lane = *lanes_[std::min(i, lanes_.size() - 1)];
      for (const Plan::Drive& drive : plan_.drives) {
        const double mean =
            (target(lane, drive.first_actuator) + target(lane, drive.second_actuator)) / 2.0;
        const auto s = static_cast<std::size_t>(drive.spring);
        w_.goal[s * width + i] = mean * plan_.rest[s];
      }
    }
  }

  double target(const Lane& lane, std::int32_t actuator) const {
    return physics_.clip(lane.targets[static_cast<std::size_t>(actuator)]);
  }

  void copy_lane(std::size_t from, std::size_t to) const {
    for (double* row : {rows_.position, rows_.previous, rows_.velocity})
      for (std::size_t o = 0; o < pair_offset(plan_.sites, width); o += width)
        row[o + to] = row[o + from];
  }

  // Lanes that folded keep the state at the end of this substep. Where points fly past
  // whole cells from one substep to the next, it is the integrator that folded.
  std::size_t stop_folded() {
    std::size_t stopped = 0;
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (!folding_[i] || !runs(i)) continue;
      lanes_[i]->status = flies_apart(i) ? LaneStatus::unstable : LaneStatus::self_folding;
      set_aside_[i] = true;
      set_aside(i);
      ++stopped;
    }
    return stopped;
  }

  bool flies_apart(std::size_t lane) const {
    const double limit = physics_.voxel_length / physics_.substep;  // a cell per substep
    for (std::size_t i = 0; i < plan_.points.size(); ++i)
      for (const std::size_t k : {lane, lane + width})
        if (!(std::abs(velocity(i)[k]) <= limit)) return true;
    return false;
  }

  // Position, previous position and velocity of a lane, wherever they are at present.
  template <class Visit>
  void for_each_value(std::size_t lane, Visit visit) const {
    for (std::size_t i = 0; i < plan_.points.size(); ++i) {
      const std::size_t o = w_.point_offsets[i];
      for (double* pair : {w_.position + o, w_.previous + o, velocity(i)})
        for (const std::size_t k : {lane, lane + width}) visit(pair[k]);
    }
  }

  void set_aside(std::size_t lane) const {
    const std::size_t values = 6 * plan_.points.size();
    workspace_.folded.resize(std::max(workspace_.folded.size(), values * width));
    auto aside = workspace_.folded.begin() + static_cast<std::ptrdiff_t>(values * lane);
    for_each_value(lane, [&](double value) { *aside++ = value; });
  }

  void put_back(std::size_t lane) const {
    const std::size_t values = 6 * plan_.points.size();
    auto aside = workspace_.folded.begin() + static_cast<std::ptrdiff_t>(values * lane);
    for_each_value(lane, [&](double& value) { value = *aside++; });
  }

  void end() {
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (set_aside_[i]) put_back(i);
    rows_.position = w_.position;
    rows_.previous = w_.previous;
    for (std::size_t i = 0; i < plan_.points.size(); ++i)
      std::copy_n(velocity(i), 2 * width, rows_.velocity + w_.point_offsets[i]);
    HWY_ALIGN double nothing[2 * width] = {};  // 0 times every value: 0 where all are finite
    for (std::size_t o = 0; o < pair_offset(plan_.sites, width); o += 2 * width)
      for (std::size_t k = 0; k < 2 * width; ++k)
        nothing[k] += 0.0 * rows_.velocity[o + k] + 0.0 * w_.position[o + k];
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (!(nothing[i] + nothing[i + width] == 0.0)) lanes_[i]->status = LaneStatus::unstable;
    if (record_ != nullptr) record_->end(w_.position, lanes_);
  }

  const std::vector<Lane*>& lanes_;
  const Plan& plan_;
  const Physics& physics_;
  Rows& rows_;
  Workspace& workspace_;
  StepRecord* record_;  // none: nothing is kept
  Arrays w_;
  std::array<bool, width> folding_{};
  std::array<bool, width> set_aside_{};
};

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
