// What both kernels do to a point once its forces are known. Included once an
// instruction set (see Highway's "-inl.h" files).

#if defined(LIBEVO_SIM_INTEGRATE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_SIM_INTEGRATE_INL_H_
#undef LIBEVO_SIM_INTEGRATE_INL_H_
#else
#define LIBEVO_SIM_INTEGRATE_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "libevo/base/elementary.h"
#include "libevo/sim/exact-inl.h"
#include "libevo/sim/physics.h"
#include "libevo/sim/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class Real>
struct Constants {
  explicit Constants(const Physics& p)
      : rate(static_cast<Real>(p.actuation_rate)),
        drag(static_cast<Real>(p.drag)),
        gravity(p.gravity),
        substep(p.substep),
        floor_reach(p.voxel_length / 4.0),
        correction(p.strain_correction),
        rigid_correction(p.rigid_strain_correction) {}
  Real rate, drag;
  double gravity, substep;
  double floor_reach;  // farther than any point gets in a substep
  double correction, rigid_correction;
};

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
HWY_INLINE void AdvanceExactly(D d, V v, V f, double substep, const double* HWY_RESTRICT position,
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

// The same without sums, in single precision: as v2 = v1 + k1/2, v3 = v1 + k2/2 and
// v4 = v1 + k3 (k of the velocities), the velocity rises by
//   (k1 + 2 k2 + 2 k3 + k4)/6 = (v2 + 2 v3 + v4 - 4 v1)/3 + k4/6
// and the position by (v1 + 2 v2 + 2 v3 + v4) dt/6. Stages 1 to 3 lead to the next one;
// `velocities` is this coordinate in the point's record of Arrays::stage_motion.
template <int stage, std::size_t spacing, class D, class V = hn::Vec<D>>
HWY_INLINE void AdvanceFast(D d, V v, V f, double substep, const float* HWY_RESTRICT start,
                            float* HWY_RESTRICT next, float* HWY_RESTRICT velocities) {
  static_assert(stage < 4);
  const V v1 = stage == 1 ? v : hn::Load(d, velocities + StageMotion::velocity_of(1) * spacing);
  const V step = hn::Set(d, static_cast<float>(stage == 3 ? substep : 0.5 * substep));
  hn::StoreU(hn::MulAdd(step, v, hn::LoadU(d, start)), d, next);
  hn::Store(hn::MulAdd(step, f, v1), d, velocities + StageMotion::velocity_of(stage + 1) * spacing);
}

template <class V>
struct Rise {
  V position, velocity;
};

// What stage 4, with velocity v and force f, adds to position and velocity.
template <std::size_t spacing, class D, class V = hn::Vec<D>>
HWY_INLINE Rise<V> RiseOf(D d, V v, V f, double substep, const float* velocities) {
  const V v1 = hn::Load(d, velocities + StageMotion::velocity_of(1) * spacing);
  const V v2 = hn::Load(d, velocities + StageMotion::velocity_of(2) * spacing);
  const V v3 = hn::Load(d, velocities + StageMotion::velocity_of(3) * spacing);
  const V two = hn::Set(d, 2.0F);
  const V sixth = hn::Set(d, static_cast<float>(substep / 6.0));
  const V p_sum = hn::MulAdd(two, hn::Add(v2, v3), hn::Add(v1, v));
  const V v_sum = hn::NegMulAdd(hn::Set(d, 4.0F), v1, hn::MulAdd(two, v3, hn::Add(v2, v)));
  return {hn::Mul(sixth, p_sum), hn::MulAdd(hn::Set(d, 1.0F / 3.0F), v_sum, hn::Mul(sixth, f))};
}

// The lanes of v from `first` on in double, as many as L has: all or half of them.
template <class L, class D, class V = hn::Vec<D>>
HWY_INLINE hn::Vec<L> PromotePart(L wide, [[maybe_unused]] D d, V v,
                                  [[maybe_unused]] std::size_t first) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (hn::MaxLanes(L()) < hn::MaxLanes(D())) {
    static_assert(2 * hn::MaxLanes(L()) == hn::MaxLanes(D()));
    const hn::Half<D> half;
    return hn::PromoteTo(wide, first == 0 ? hn::LowerHalf(half, v) : hn::UpperHalf(half, v));
  } else
#endif
    return hn::PromoteTo(wide, v);
}

// Ends the substep of one coordinate (or both) in fast arithmetic.
template <class D, class V>
HWY_INLINE void AddRise(D d, const Rise<V>& rise, const double* HWY_RESTRICT position,
                        double* HWY_RESTRICT velocity, double* HWY_RESTRICT next) {
  const hn::CappedTag<double, hn::MaxLanes(D())> wide;
  constexpr std::size_t part = hn::MaxLanes(decltype(wide)());
  for (std::size_t h = 0; h < hn::MaxLanes(D()); h += part) {
    const auto dp = PromotePart(wide, d, rise.position, h);
    const auto dv = PromotePart(wide, d, rise.velocity, h);
    hn::StoreU(hn::Add(hn::LoadU(wide, position + h), dp), wide, next + h);
    hn::Store(hn::Add(hn::Load(wide, velocity + h), dv), wide, velocity + h);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
