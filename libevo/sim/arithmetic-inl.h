// What the kernels compute: of a spring from its length, of a point once its forces are
// known. Every operation of docs/physics.md, each rounded once; both kernels and all widths
// call these. Included once per instruction set (see Highway's "-inl.h" files).

#if defined(LIBEVO_SIM_ARITHMETIC_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_SIM_ARITHMETIC_INL_H_
#undef LIBEVO_SIM_ARITHMETIC_INL_H_
#else
#define LIBEVO_SIM_ARITHMETIC_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "libevo/base/elementary.h"
#include "libevo/sim/exact-inl.h"
#include "libevo/sim/physics.h"
#include "libevo/sim/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

struct Constants {
  explicit Constants(const Physics& p)
      : rate(p.actuation_rate),
        drag(p.drag),
        gravity(p.gravity),
        substep(p.substep),
        correction(p.strain_correction),
        rigid_correction(p.rigid_strain_correction) {}
  double rate, drag, gravity, substep;
  double correction, rigid_correction;
};

// ---- springs -------------------------------------------------------------------------

// |q|^2
template <class D, class V = hn::Vec<D>>
HWY_INLINE V SquareOf(D /*d*/, V qx, V qy) {
  return hn::Add(hn::Mul(qx, qx), hn::Mul(qy, qy));
}

// k (d - L), the rest length L being kept from the first stage for the others.
template <bool first_stage, class D, class V = hn::Vec<D>>
HWY_INLINE V TensionOf(D d, V length, V stiffness, double rate, const double* goal, double* kept) {
  V rest;
  if constexpr (first_stage) {
    rest = hn::Add(length, hn::Mul(hn::Set(d, rate), hn::Sub(hn::LoadU(d, goal), length)));
    hn::StoreU(rest, d, kept);
  } else {
    rest = hn::LoadU(d, kept);
  }
  return hn::Mul(stiffness, hn::Sub(length, rest));
}

// k (d - L) / d, the factor of q in the force.
template <bool first_stage, class D, class V = hn::Vec<D>>
HWY_INLINE V PullOf(D d, V square, V stiffness, double rate, const double* goal, double* kept) {
  const V length = hn::Sqrt(square);
  return hn::Div(TensionOf<first_stage>(d, length, stiffness, rate, goal, kept), length);
}

// (d - target) / (2 d), the factor of q that takes a spring back to `target`.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V CorrectionOf(D d, V square, V target) {
  const V length = hn::Sqrt(square);
  return hn::Div(hn::Sub(length, target), hn::Mul(hn::Set(d, 2.0), length));
}

// ---- points --------------------------------------------------------------------------

// The forces at the ends of springs, from `force`, values of a point; `end` lists
// first a_ends of them that are subtracted, then b_ends that are added.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V SumForces(D d, const double* force, const std::uint32_t* HWY_RESTRICT end, int a_ends,
                       int b_ends) {
  V sum = hn::Zero(d);
  for (int i = 0; i < a_ends; ++i) sum = hn::Sub(sum, hn::Load(d, force + end[i]));
  for (int i = a_ends; i < a_ends + b_ends; ++i) sum = hn::Add(sum, hn::Load(d, force + end[i]));
  return sum;
}

// Force of the world floor on a point that is at y < 0 with velocity vx.
HWY_INLINE void AddFloor(const Physics& physics, double y, double vx, double& fx, double& fy) {
  const double up = -physics.floor_stiffness * y;
  fy += up;
  fx -= physics.floor_friction_multiplier * physics.floor_friction_coefficient * up *
        math::reference_tanh(vx * up * physics.floor_friction_coefficient);
}

// One coordinate (or both) of one point: k_p = v dt, k_v = f dt, and where they
// lead (Runge-Kutta of fourth order). `position` is where the substep started,
// `next` where the next stage, or substep, evaluates; `motion` is this coordinate in
// the point's record of Arrays::motion, whose quantities begin 2 * spacing apart. With
// both coordinates of several neighbours in a register, positions may start anywhere.
template <int stage, std::size_t spacing, class D, class V = hn::Vec<D>>
HWY_INLINE void Advance(D d, V v, V f, double substep, const double* HWY_RESTRICT position,
                        double* HWY_RESTRICT next, double* HWY_RESTRICT motion) {
  double* const velocity = motion + Motion::velocity * spacing;
  double* const stage_velocity = motion + Motion::stage_velocity * spacing;
  double* const position_sum = motion + Motion::position_sum * spacing;
  double* const velocity_sum = motion + Motion::velocity_sum * spacing;
  const V dt = hn::Set(d, substep);
  const V kp = hn::Mul(v, dt);
  const V kv = hn::Mul(f, dt);
  const V p0 = hn::LoadU(d, position);
  const V v0 = stage == 1 ? v : hn::Load(d, velocity);
  if constexpr (stage < 4) {
    V p_sum = kp;  // k1 + 2 k2 + 2 k3 + k4, from left to right
    V v_sum = kv;
    if constexpr (stage > 1) {
      const V two = hn::Set(d, 2.0);
      p_sum = hn::Add(hn::Load(d, position_sum), hn::Mul(two, kp));
      v_sum = hn::Add(hn::Load(d, velocity_sum), hn::Mul(two, kv));
    }
    hn::Store(p_sum, d, position_sum);
    hn::Store(v_sum, d, velocity_sum);
    const V step = hn::Set(d, stage == 3 ? 1.0 : 0.5);
    hn::StoreU(hn::Add(p0, hn::Mul(step, kp)), d, next);
    hn::Store(hn::Add(v0, hn::Mul(step, kv)), d, stage_velocity);
  } else {
    const V p_sum = hn::Add(hn::Load(d, position_sum), kp);
    const V v_sum = hn::Add(hn::Load(d, velocity_sum), kv);
    hn::StoreU(hn::Add(p0, SixthOf(d, p_sum)), d, next);
    hn::Store(hn::Add(v0, SixthOf(d, v_sum)), d, velocity);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
