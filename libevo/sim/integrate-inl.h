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

struct Constants {
  explicit Constants(const Physics& p)
      : rate(p.actuation_rate),
        drag(p.drag),
        gravity(p.gravity),
        substep(p.substep),
        correction(p.strain_correction),
        rigid_correction(p.rigid_strain_correction) {}
  double rate, drag, gravity, substep, correction, rigid_correction;
};

// Force of the world floor on a point that is at y < 0 with velocity vx.
HWY_INLINE void AddFloor(const Physics& physics, double y, double vx, double& fx, double& fy) {
  const double up = -physics.floor_stiffness * y;
  fy += up;
  fx -= physics.floor_friction_multiplier * physics.floor_friction_coefficient * up *
        math::tanh(vx * up * physics.floor_friction_coefficient);
}

// One coordinate (or both) of one point: k_p = v dt, k_v = f dt, and where they
// lead (Runge-Kutta of fourth order). `position` is where the substep started,
// `next` where the next stage, or substep, evaluates; `motion` is this
// coordinate in the point's record of the workspace.
template <int stage, std::size_t width, class D, class V = hn::Vec<D>>
HWY_INLINE void AdvanceExactly(D d, V v, V f, double substep, const double* HWY_RESTRICT position,
                               double* HWY_RESTRICT next, double* HWY_RESTRICT motion) {
  double* const velocity = motion + Motion::velocity * width;
  double* const stage_velocity = motion + Motion::stage_velocity * width;
  double* const position_sum = motion + Motion::position_sum * width;
  double* const velocity_sum = motion + Motion::velocity_sum * width;
  const V dt = hn::Set(d, substep);
  const V kp = hn::Mul(v, dt);
  const V kv = hn::Mul(f, dt);
  const V p0 = hn::Load(d, position);
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
    hn::Store(hn::Add(p0, hn::Mul(step, kp)), d, next);
    hn::Store(hn::Add(v0, hn::Mul(step, kv)), d, stage_velocity);
  } else {
    const V p_sum = hn::Add(hn::Load(d, position_sum), kp);
    const V v_sum = hn::Add(hn::Load(d, velocity_sum), kv);
    hn::Store(hn::Add(p0, SixthOf(d, p_sum)), d, next);
    hn::Store(hn::Add(v0, SixthOf(d, v_sum)), d, velocity);
  }
}

// The same without sums: as v2 = v0 + k1/2, v3 = v0 + k2/2 and v4 = v0 + k3 (k of
// the velocities),
//   v0 + (k1 + 2 k2 + 2 k3 + k4)/6 = v0 + (v2 + 2 v3 + v4 - 4 v0)/3 + k4/6
// and the positions' own sum is (v0 + 2 v2 + 2 v3 + v4) dt.
template <int stage, std::size_t width, class D, class V = hn::Vec<D>>
HWY_INLINE void AdvanceFast(D d, V v, V f, double substep, const double* HWY_RESTRICT position,
                            double* HWY_RESTRICT next, double* HWY_RESTRICT motion) {
  const auto velocity = [motion](int of) { return motion + Motion::velocity_of(of, true) * width; };
  const V p0 = hn::Load(d, position);
  const V v0 = stage == 1 ? v : hn::Load(d, velocity(1));
  if constexpr (stage < 4) {
    const V step = hn::Set(d, stage == 3 ? substep : 0.5 * substep);
    hn::Store(hn::MulAdd(step, v, p0), d, next);
    hn::Store(hn::MulAdd(step, f, v0), d, velocity(stage + 1));
  } else {
    const V two = hn::Set(d, 2.0);
    const V v2 = hn::Load(d, velocity(2));
    const V v3 = hn::Load(d, velocity(3));
    const V sixth = hn::Set(d, substep / 6.0);
    const V p_sum = hn::MulAdd(two, hn::Add(v2, v3), hn::Add(v0, v));
    const V rise = hn::NegMulAdd(hn::Set(d, 4.0), v0, hn::MulAdd(two, v3, hn::Add(v2, v)));
    hn::Store(hn::MulAdd(sixth, p_sum, p0), d, next);
    hn::Store(hn::MulAdd(hn::Set(d, 1.0 / 3.0), rise, hn::MulAdd(sixth, f, v0)), d, velocity(1));
  }
}

template <Arithmetic arithmetic, int stage, std::size_t width, class D, class V = hn::Vec<D>>
HWY_INLINE void Advance(D d, V v, V f, double substep, const double* HWY_RESTRICT position,
                        double* HWY_RESTRICT next, double* HWY_RESTRICT motion) {
  if constexpr (arithmetic == Arithmetic::exact)
    AdvanceExactly<stage, width>(d, v, f, substep, position, next, motion);
  else
    AdvanceFast<stage, width>(d, v, f, substep, position, next, motion);
}

// Spring forces f on a point, plus drag, gravity and contact.
template <Arithmetic arithmetic, class D, class V = hn::Vec<D>>
HWY_INLINE V AddLoads(D d, V f, V v, V gravity, double drag, const double* contact) {
  const V held = hn::Load(d, contact);
  if constexpr (arithmetic == Arithmetic::exact)
    return hn::Add(hn::Sub(hn::Sub(f, hn::Mul(hn::Set(d, drag), v)), gravity), held);
  else
    return hn::NegMulAdd(hn::Set(d, drag), v, hn::Add(f, hn::Sub(held, gravity)));
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
