// The solver: one substep of 1e-4 after the other (docs/physics.md, "Order of one substep"; how
// arrays are laid out: "How it is laid out").
//
// Design. What moves is a set of point masses joined by springs; everything in
// a substep but contact is the same arithmetic for every spring, then for every
// point. It is done in one of two ways:
//
//   SideBySide  environments with equal springs share registers: lane i of
//               every vector belongs to environment i. No lane ever looks at
//               another one.
//   Alone       one environment: vectors of springs, then of points as (x, y).
//
// Both do, value for value, the operations of docs/physics.md in its order,
// each rounded once (no fused multiply-add, IEEE sqrt and divide), so the bits
// of a trajectory depend neither on which way was taken nor on how wide the
// registers are. tests/unit/sim compares both with a plain scalar simulator.
//
// Physics::arithmetic `fast` takes the same ways in mixed precision: what a
// substep adds to positions and velocities is computed in single precision, from
// positions relative to the object, with one root per spring and fused operations
// (arithmetic-inl.h, integrate-inl.h); positions, velocities and contact stay
// double. A register holds twice as many lanes. Its bits are others, and still
// depend on neither way nor width; only processors without fused multiply-adds
// have a result of their own.
//
// A substep is
//   contacts      candidates side by side, forces one by one (contact.h)
//   4 x { springs: length, force
//         points: gather, integrate }   in turns, where environments fill the lanes
//   strain limits, first all springs at once, then rigid cells one by one
//
// Forces are stored by spring and gathered by point, in the order in which
// that page sums them: no scatter, no read-modify-write. The rest length L
// ("Actuation") needs the length that stage 1 of Runge-Kutta needs, so a spring
// takes four roots per substep. Strain limits compare squares against bounds
// found when the model was compiled (plan.h); only springs beyond them compute.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libevo/sim/kernels.cpp"
// Highway's macros: which instruction sets; then this file once for each of them.
#include "libevo/sim/targets.h"
//
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include "libevo/sim/alone-inl.h"
#include "libevo/sim/control_step-inl.h"
#include "libevo/sim/isa.h"
#include "libevo/sim/kernel-inl.h"
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
// Some dividers take about 40 cycles for the root and the quotient of eight doubles:
// there, of three springs one goes to the divider and two through the multipliers. With
// four lanes (measured on Zen 3 and 4) it is quicker alone everywhere.
inline constexpr bool may_help = HWY_NATIVE_FMA && double_lanes >= 8;
using HelpedSideBySide =
    SideBySide<Arithmetic::exact, double_lanes, may_help ? Divider::helped : Divider::alone>;
using FastSideBySide = SideBySide<Arithmetic::fast, most_single_lanes>;
using FewFastSideBySide = SideBySide<Arithmetic::fast, most_single_lanes / 2>;

#if HWY_TARGET != HWY_SCALAR
// A slow divider keeps the rest waiting, and is kept busier by shorter registers.
using ExactAlone = Alone<Arithmetic::exact, 8>;
using NarrowAlone = Alone<Arithmetic::exact, 4>;
using FastAlone = Alone<Arithmetic::fast, 8>;
#else
using ExactAlone = SideBySide<Arithmetic::exact, 1>;
using NarrowAlone = ExactAlone;
using FastAlone = SideBySide<Arithmetic::fast, 1>;
#endif

std::size_t MostLanes(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::exact ? ExactSideBySide::width : FastSideBySide::width;
}

Layout LayoutFor(Arithmetic arithmetic, std::size_t lanes) {
  const bool exact = arithmetic == Arithmetic::exact;
  if (lanes == 1 && exact)
    return has_quick_divider() ? LayoutOf<ExactAlone>() : LayoutOf<NarrowAlone>();
  if (lanes == 1) return LayoutOf<FastAlone>();
  if (exact) return LayoutOf<ExactSideBySide>();
  return lanes > FewFastSideBySide::width ? LayoutOf<FastSideBySide>()
                                          : LayoutOf<FewFastSideBySide>();
}

template <class One, class Several>
void StepExactly(Group& group, Workspace& workspace) {
  if (group.lanes.size() == 1)
    ControlStep<One>(group, workspace).run();
  else
    ControlStep<Several>(group, workspace).run();
}

void StepGroup(Group& group, Workspace& workspace) {
  const std::size_t lanes = group.lanes.size();
  if (group.kind->physics().arithmetic == Arithmetic::exact) {
    if (has_quick_divider())
      StepExactly<ExactAlone, ExactSideBySide>(group, workspace);
    else
      StepExactly<NarrowAlone, HelpedSideBySide>(group, workspace);
  } else {
    if (lanes == 1)
      ControlStep<FastAlone>(group, workspace).run();
    else if (lanes > FewFastSideBySide::width)
      ControlStep<FastSideBySide>(group, workspace).run();
    else
      ControlStep<FewFastSideBySide>(group, workspace).run();
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace evo {
namespace {

HWY_EXPORT(LayoutFor);
HWY_EXPORT(MostLanes);
HWY_EXPORT(StepGroup);

}  // namespace

Layout layout_of(Arithmetic arithmetic, std::size_t lanes) {
  return HWY_DYNAMIC_DISPATCH(LayoutFor)(arithmetic, lanes);
}
std::size_t most_lanes(Arithmetic arithmetic) {
  return HWY_DYNAMIC_DISPATCH(MostLanes)(arithmetic);
}
void step_group(Group& group, Workspace& workspace) {
  HWY_DYNAMIC_DISPATCH(StepGroup)(group, workspace);
}

}  // namespace evo
#endif  // HWY_ONCE
