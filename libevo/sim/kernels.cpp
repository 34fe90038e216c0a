// The solver: one substep of 1e-4 after the other (spec: physics, sections 3-8).
//
// Design. What moves is a set of point masses joined by springs; everything in
// a substep but contact is the same arithmetic for every spring, then for every
// point. It is done in one of two ways:
//
//   SideBySide  environments with equal springs share registers: lane i of
//               every vector belongs to environment i. No lane ever looks at
//               another one.
//   Alone       one environment: vectors of springs, then points as (x, y).
//
// Both do, value for value, the operations of the specification in its order,
// each rounded once (no fused multiply-add, IEEE sqrt and divide), so the bits
// of a trajectory depend neither on which way was taken nor on how wide the
// registers are. tests/unit/sim compares both with a plain scalar simulator.
//
// Physics::arithmetic `fast` takes the same ways in mixed precision: what a
// substep adds to positions and velocities is computed in single precision, from
// positions relative to the object, with one root a spring and fused operations
// (arithmetic-inl.h, integrate-inl.h); positions, velocities and contact stay
// double. A register holds twice as many lanes. Its bits are others, and still
// depend on neither way nor width; only processors without fused multiply-adds
// have a result of their own.
//
// A substep is
//   contacts      scalar, environment by environment (contact.h)
//   4 x { springs: length, force
//         points: gather, integrate }   following the springs at a distance
//   strain limits, first all springs at once, then rigid cells one by one
//
// Forces are stored a spring and gathered a point, in the order in which the
// specification sums them: no scatter, no read-modify-write. The rest length L
// of section 4 needs the length that stage 1 of Runge-Kutta needs, so a spring
// takes four roots a substep. Strain limits compare squares against bounds
// found when the model was compiled (plan.h); only springs beyond them compute.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libevo/sim/kernels.cpp"
// Highway's macros: which instruction sets; then this file once for each of them.
#include "libevo/sim/targets.h"
//
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <span>

#include "libevo/sim/alone-inl.h"
#include "libevo/sim/control_step-inl.h"
#include "libevo/sim/kernels.h"
#include "libevo/sim/side_by_side-inl.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

// In exact arithmetic lanes are what a register of doubles holds. Fast arithmetic
// has twice as many single ones, at most what callers have at hand, or half of them.
inline constexpr std::size_t double_lanes = hn::MaxLanes(hn::ScalableTag<double>());
inline constexpr std::size_t most_single_lanes = 8;
using ExactSideBySide = SideBySide<Arithmetic::exact, double_lanes>;
using FastSideBySide = SideBySide<Arithmetic::fast, most_single_lanes>;
using FewFastSideBySide = SideBySide<Arithmetic::fast, most_single_lanes / 2>;

#if HWY_TARGET != HWY_SCALAR
using ExactAlone = Alone<Arithmetic::exact>;
using FastAlone = Alone<Arithmetic::fast>;
#else
using ExactAlone = SideBySide<Arithmetic::exact, 1>;
using FastAlone = SideBySide<Arithmetic::fast, 1>;
#endif

template <class Kernel>
Layout LayoutOf() {
  return {Kernel::width, Kernel::force_record, Kernel::force_offset};
}
Layout LaneLayout(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::exact ? LayoutOf<ExactSideBySide>() : LayoutOf<FastSideBySide>();
}
void StepSideBySide(std::span<Lane> lanes, Workspace& workspace) {
  if (lanes[0].model->physics().arithmetic == Arithmetic::exact)
    ControlStep<ExactSideBySide>(lanes, workspace).run();
  else if (lanes.size() > FewFastSideBySide::width)
    ControlStep<FastSideBySide>(lanes, workspace).run();
  else
    ControlStep<FewFastSideBySide>(lanes, workspace).run();
}
void StepAlone(Lane& lane, Workspace& workspace) {
  if (lane.model->physics().arithmetic == Arithmetic::exact)
    ControlStep<ExactAlone>({&lane, 1}, workspace).run();
  else
    ControlStep<FastAlone>({&lane, 1}, workspace).run();
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace evo {
namespace {

HWY_EXPORT(LaneLayout);
HWY_EXPORT(StepSideBySide);
HWY_EXPORT(StepAlone);

}  // namespace

Layout lane_layout(Arithmetic arithmetic) { return HWY_DYNAMIC_DISPATCH(LaneLayout)(arithmetic); }
void step_side_by_side(std::span<Lane> lanes, Workspace& workspace) {
  HWY_DYNAMIC_DISPATCH(StepSideBySide)(lanes, workspace);
}
void step_alone(Lane& lane, Workspace& workspace) {
  HWY_DYNAMIC_DISPATCH(StepAlone)(lane, workspace);
}

}  // namespace evo
#endif  // HWY_ONCE
