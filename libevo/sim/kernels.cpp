// The solver: one substep of 1e-4 after the other (docs/physics.md, "Order of one substep"); how
// arrays are laid out: workspace.h.
//
// Everything in a substep but contact is the same arithmetic for every spring, then for every
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
// registers are.
//
// The rest length L ("Actuation") needs the length that stage 1 of Runge-Kutta
// needs, so a spring takes four roots per substep.
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
#include "libevo/sim/kernels.h"
#include "libevo/sim/side_by_side-inl.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

// Some dividers take about 40 cycles for the root and the quotient of eight doubles:
// there, of three springs one goes to the divider and two through the multipliers. With
// four lanes (measured on Zen 3 and 4) it is quicker alone everywhere.
inline constexpr bool may_help = HWY_NATIVE_FMA && hn::MaxLanes(hn::ScalableTag<double>()) >= 8;
using Several = SideBySide<Divider::alone>;
using SeveralHelped = SideBySide<may_help ? Divider::helped : Divider::alone>;

#if HWY_TARGET != HWY_SCALAR
// A slow divider keeps the rest waiting, and is kept busier by shorter registers.
using One = Alone<8>;
using OneNarrow = Alone<4>;
#else
using One = Several;
using OneNarrow = Several;
#endif

std::size_t MostLanes() { return Several::width; }

Layout LayoutFor(std::size_t lanes) {
  if (lanes > 1) return LayoutOf<Several>();
  return has_quick_divider() ? LayoutOf<One>() : LayoutOf<OneNarrow>();
}

template <class Single, class Together>
void StepWith(Group& group, Workspace& workspace, StepRecord* record) {
  if (group.lanes.size() == 1)
    ControlStep<Single>(group, workspace, record).run();
  else
    ControlStep<Together>(group, workspace, record).run();
}

void StepGroup(Group& group, Workspace& workspace, StepRecord* record) {
  if (has_quick_divider())
    StepWith<One, Several>(group, workspace, record);
  else
    StepWith<OneNarrow, SeveralHelped>(group, workspace, record);
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

Layout layout_of(std::size_t lanes) { return HWY_DYNAMIC_DISPATCH(LayoutFor)(lanes); }
std::size_t most_lanes() { return HWY_DYNAMIC_DISPATCH(MostLanes)(); }
void step_group(Group& group, Workspace& workspace, StepRecord* record) {
  HWY_DYNAMIC_DISPATCH(StepGroup)(group, workspace, record);
}

}  // namespace evo
#endif  // HWY_ONCE
