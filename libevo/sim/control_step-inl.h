// One control step with either kernel (see kernels.cpp): loads states into the
// workspace, runs the substeps, stores them back. Included once an instruction
// set (see Highway's "-inl.h" files).

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
#include <span>
#include <utility>

#include "libevo/sim/compiled.h"
#include "libevo/sim/contact.h"
#include "libevo/sim/state.h"
#include "libevo/sim/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class Kernel>
class ControlStep {
 public:
  static constexpr std::size_t width = Kernel::width;
  static constexpr Arithmetic arithmetic = Kernel::arithmetic;
  static constexpr std::size_t motion_pairs = Motion::pairs(arithmetic);
  using Real = StageReal<arithmetic>;

  ControlStep(std::span<Lane> lanes, Workspace& workspace)
      : lanes_(lanes),
        plan_(lanes[0].model->compiled().plan),
        physics_(lanes[0].model->physics()),
        w_(workspace.prepare<Kernel::arithmetic>(
            plan_, {width, Kernel::force_record, Kernel::force_offset})),
        lead_(lead_of(plan_)) {}

  void run() {
    for (std::size_t i = 0; i < width; ++i) load(i, lanes_[std::min(i, lanes_.size() - 1)]);
    clear_contacts();
    prepare_stages();
    kernel().template last_springs<true>(w_.stage_start(),
                                         static_cast<std::size_t>(plan_.first_frozen),
                                         static_cast<std::size_t>(plan_.springs));
    std::size_t running = lanes_.size();
    for (int i = 0; i < physics_.substeps && running > 0; ++i) {
      if (i > 0) kernel().add_travel();
      substep();
      running -= stop_folded();
    }
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (lanes_[i].result == StepResult::done) store(i);
  }

 private:
  void substep() {
    contacts();
    if constexpr (arithmetic == Arithmetic::fast) start_stages();
    stage<1>(w_.stage_start(), w_.stage_position[0]);
    stage<2>(w_.stage_position[0], w_.stage_position[1]);
    stage<3>(w_.stage_position[1], w_.stage_position[0]);
    stage<4>(w_.stage_position[0], w_.previous);
    kernel().limit_strain(w_.previous);
    kernel().limit_rigid_strain(w_.previous);
    std::swap(w_.position, w_.previous);
  }

  // Where stages find the points that no substep moves.
  void prepare_stages() {
    for (std::size_t block = 0; block < plan_.blocks.size(); ++block) {
      const PlanBlock& slots = plan_.blocks[block];
      if constexpr (arithmetic == Arithmetic::fast) {
        kernel().choose_origin(block);
        for (int slot = slots.first; slot < slots.first + slots.count; ++slot)
          kernel().store_start(slot, block);
      }
      const auto held = 2 * width * static_cast<std::size_t>(slots.first + slots.integrated);
      const auto end = 2 * width * static_cast<std::size_t>(slots.first + slots.count);
      for (Real* stage : w_.stage_position)
        std::copy(w_.stage_start() + held, w_.stage_start() + end, stage + held);
    }
  }

  // What the stages of a substep start from, in their precision.
  void start_stages() {
    const Kernel kernel = this->kernel();
    bool near_floor = false;
    for (std::size_t block = 0; block < plan_.blocks.size(); ++block) {
      const PlanBlock& slots = plan_.blocks[block];
      for (int slot = slots.first; slot < slots.first + slots.integrated; ++slot) {
        kernel.store_start(slot, block);
        kernel.store_motion(slot);
        near_floor |= kernel.is_near_floor(2 * width * static_cast<std::size_t>(slot));
      }
    }
    near_floor_ = near_floor;
  }

  // One stage of Runge-Kutta. Points follow the springs at a distance: while
  // the divider works on springs, the rest of the processor integrates points.
  template <int n, class Next>
  void stage(const Real* HWY_RESTRICT at, Next* HWY_RESTRICT next) {
    const auto springs = static_cast<std::size_t>(plan_.live_springs);
    const std::size_t regular = n < 3 ? plan_.regular : plan_.free_regular;
    constexpr int few = Plan::regular_ends;
    constexpr std::size_t ends_a_point = 2UL * few;
    const std::uint32_t* points = w_.point_offsets;
    const std::uint32_t* ends = w_.ends;
    const Kernel kernel = this->kernel();
    std::size_t s = 0;
    std::size_t i = 0;
    for (; s < lead_ && s + Kernel::springs_at_once <= springs; s += Kernel::springs_at_once)
      kernel.template springs<n == 1>(at, s);
    for (; i + Kernel::points_at_once <= regular && s + Kernel::springs_at_once <= springs;
         s += Kernel::springs_at_once) {
      kernel.template springs<n == 1>(at, s);
      for (std::size_t k = 0; k < Kernel::points_at_once; ++k, ++i, ends += ends_a_point)
        kernel.template point<n>(points[i], ends, few, few, at, next);
    }
    kernel.template last_springs<n == 1>(at, s, springs);
    for (; i < regular; ++i, ends += ends_a_point)
      kernel.template point<n>(points[i], ends, few, few, at, next);
    for (; i < plan_.regular; ++i) anchored_point<n>(w_.point_offsets[i], next);
    for (; i < plan_.free_irregular; ++i) irregular_point<n>(i, at, next);
    for (; i < plan_.points.size(); ++i) {
      if constexpr (n < 3)
        irregular_point<n>(i, at, next);
      else
        anchored_point<n>(w_.point_offsets[i], next);
    }
  }

  // What others feel of an anchored point is where stages 3 and 4 see it, which
  // the forces of stages 1 and 2 decide; it ends the substep where it began.
  template <int n, class Next>
  HWY_INLINE void anchored_point(std::size_t o, Next* next) {
    if constexpr (n == 3) {
      const Real* velocity = nullptr;
      if constexpr (arithmetic == Arithmetic::exact)
        velocity = w_.motion + motion_pairs * o + Motion::stage_velocity * width;
      else
        velocity = w_.stage_motion + StageMotion::pairs * o + StageMotion::velocity_of(3) * width;
      const Real* start = w_.stage_start();
      for (std::size_t k = 0; k < 2 * width; ++k)
        next[o + k] = start[o + k] + velocity[k] * static_cast<Real>(physics_.substep);
    } else if constexpr (n == 4) {
      std::copy_n(w_.position + o, 2 * width, next + o);
    }
  }

  template <int n, class Next>
  HWY_NOINLINE void irregular_point(std::size_t i, const Real* at, Next* next) {
    const PlanPoint& point = plan_.points[i];
    kernel().template point<n>(w_.point_offsets[i], w_.ends + point.first_end, point.a_ends,
                               point.b_ends, at, next);
  }

  // How many springs the points stay behind: enough for every one of them, and
  // for the roots and quotients under way.
  static std::size_t lead_of(const Plan& plan) {
    constexpr std::size_t under_way = 2;
    std::size_t rounds = 0;
    for (std::size_t i = 0; i < plan.regular; ++i) {
      const auto needed = static_cast<std::size_t>(plan.springs_before[i]);
      const std::size_t done = (needed + Kernel::springs_at_once - 1) / Kernel::springs_at_once;
      const std::size_t round = i / Kernel::points_at_once + 1;
      if (done > round) rounds = std::max(rounds, done - round);
    }
    return (rounds + under_way) * Kernel::springs_at_once;
  }

  // Made where it is used, so that its pointers are locals there.
  Kernel kernel() const { return {plan_, physics_, w_, near_floor_}; }

  const Model::Compiled& world(std::size_t i) const { return lanes_[i].model->compiled(); }
  PointView view(std::size_t i) const {
    return {w_.position + i, w_.previous + i, w_.motion + Motion::contact * width + i,
            w_.travel + i,   width,           motion_pairs};
  }

  void clear_contacts() {
    for (std::size_t slot = 0; slot < static_cast<std::size_t>(plan_.slots); ++slot)
      std::fill_n(w_.motion + (motion_pairs * 2 * slot + Motion::contact) * width, 2 * width, 0.0);
  }

  void contacts() {
    renew_lists();
    if (std::exchange(touching_, false)) clear_contacts();
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (lanes_[i].result != StepResult::done) continue;
      ContactLists& lists = lanes_[i].state->contacts;
      touching_ |= push_contacts(world(i), lists, view(i));
      folding_[i] = is_folding(world(i), lists, view(i));
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
      if (lanes_[i].result == StepResult::done &&
          !(w_.travel[travel * width + i] < due(lanes_[i].state->contacts)))
        return true;
    return false;
  }

  void renew_pair_lists() {
    const double* travel = w_.travel + (plan_.blocks.size() + 1) * width;
    HWY_ALIGN double moved[width];
    kernel().square_moved(moved);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      ContactLists& lists = lanes_[i].state->contacts;
      if (lanes_[i].result != StepResult::done) continue;
      if (!lists.pairs_valid || !(moved[i] <= pair_move_limit * pair_move_limit)) {
        find_pair_contacts(world(i), view(i), lists);
        load_reference(i, lists.pair_reference, w_.pair_reference, 0, plan_.slots);
        moved[i] = 0.0;
      }
      lists.pairs_due = travel[i] + (pair_move_limit - std::sqrt(moved[i]));
    }
  }

  void renew_self_lists(std::size_t block) {
    const double* travel = w_.travel + block * width;
    HWY_ALIGN double sheared[width];
    kernel().square_sheared(plan_.blocks[block], sheared);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      ContactLists& lists = lanes_[i].state->contacts;
      if (lanes_[i].result != StepResult::done) continue;
      if (!lists.self[block].valid || !(sheared[i] <= self_move_limit * self_move_limit)) {
        find_self_contacts(world(i), world(i).object_of_block[block], view(i), lists);
        load_reference(i, lists.self_reference, w_.self_reference, plan_.blocks[block].first,
                       plan_.blocks[block].count);
        sheared[i] = 0.0;
      }
      lists.self[block].due = travel[i] + (self_move_limit - std::sqrt(sheared[i])) / 2.0;
    }
  }

  // Lanes that folded keep the state at the end of this substep.
  std::size_t stop_folded() {
    std::size_t stopped = 0;
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (!folding_[i] || lanes_[i].result != StepResult::done) continue;
      store(i);
      lanes_[i].result = StepResult::self_folding;
      ++stopped;
    }
    return stopped;
  }

  void load(std::size_t i, Lane& lane) {
    State& state = *lane.state;
    lane.result = StepResult::done;
    if (state.contacts.self_reference.size() != 2 * state.x.size())
      prepare_lists(lane.model->compiled(), state.contacts);
    state.contacts.rewind();
    for (std::size_t slot = 0; slot < static_cast<std::size_t>(plan_.slots); ++slot) {
      const auto p = static_cast<std::size_t>(plan_.state_of[slot]);
      set(w_.position, i, slot, state.x[p], state.y[p]);
      set(w_.previous, i, slot, state.previous_x[p], state.previous_y[p]);
      set(w_.motion + Motion::velocity * width, i, motion_pairs * slot, state.vx[p], state.vy[p]);
    }
    for (const PlanBlock& block : plan_.blocks) {
      for (int held = block.first + block.integrated; held < block.first + block.count; ++held) {
        const auto slot = static_cast<std::size_t>(held);
        const auto p = static_cast<std::size_t>(plan_.state_of[slot]);
        set(w_.previous, i, slot, state.x[p], state.y[p]);
      }
    }
    load_reference(i, state.contacts.self_reference, w_.self_reference, 0, plan_.slots);
    load_reference(i, state.contacts.pair_reference, w_.pair_reference, 0, plan_.slots);
    for (std::size_t s = 0; s < plan_.rest.size(); ++s)
      w_.goal[s * width + i] = static_cast<Real>(plan_.rest[s]);
    for (const Plan::Drive& drive : plan_.drives) {
      const double mean =
          (target(state, drive.first_actuator) + target(state, drive.second_actuator)) / 2.0;
      const auto s = static_cast<std::size_t>(drive.spring);
      w_.goal[s * width + i] = static_cast<Real>(mean * plan_.rest[s]);
    }
  }

  double target(const State& state, std::int32_t actuator) const {
    return std::clamp(state.targets[static_cast<std::size_t>(actuator)], physics_.min_target,
                      physics_.max_target);
  }

  void store(std::size_t i) const {
    State& state = *lanes_[i].state;
    for (std::size_t slot = 0; slot < static_cast<std::size_t>(plan_.slots); ++slot) {
      const auto p = static_cast<std::size_t>(plan_.state_of[slot]);
      const std::size_t o = 2 * slot * width + i;
      state.x[p] = w_.position[o];
      state.y[p] = w_.position[o + width];
      state.previous_x[p] = w_.previous[o];
      state.previous_y[p] = w_.previous[o + width];
      const double* velocity = w_.motion + (motion_pairs * 2 * slot + Motion::velocity) * width + i;
      state.vx[p] = velocity[0];
      state.vy[p] = velocity[width];
    }
  }

  static void set(double* array, std::size_t i, std::size_t slot, double x, double y) {
    array[2 * slot * width + i] = x;
    array[2 * slot * width + width + i] = y;
  }

  static void load_reference(std::size_t i, const std::vector<double>& from, double* to, int first,
                             int count) {
    const auto start = static_cast<std::size_t>(first);
    for (std::size_t slot = start; slot < start + static_cast<std::size_t>(count); ++slot)
      set(to, i, slot, from[2 * slot], from[2 * slot + 1]);
  }

  std::span<Lane> lanes_;
  const Plan& plan_;
  const Physics& physics_;
  Arrays<arithmetic> w_;
  std::size_t lead_;
  std::array<bool, width> folding_{};
  bool touching_ = false;
  bool near_floor_ = false;  // fast arithmetic: any point of any lane
};

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
