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
// A substep is
//   contacts      scalar, environment by environment (contact.h)
//   4 x { springs: length, force      one pass over the springs
//         points: gather, integrate } one pass over the points
//   strain limits, first all springs at once, then rigid cells one by one
//
// Forces are stored a spring and gathered a point, in the order in which the
// specification sums them: no scatter, no read-modify-write. The rest length L
// of section 4 needs the length that stage 1 of Runge-Kutta needs, so a spring
// takes four roots a substep. Strain limits compare squares against bounds
// found when the model was compiled (plan.h); only springs beyond them compute.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libevo/sim/kernels.cpp"
#include "libevo/sim/targets.h"
// Must come before highway.h: includes this file once an instruction set.
#include <hwy/foreach_target.h>
// clang-format does not know that the order matters.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "libevo/base/elementary.h"
#include "libevo/sim/contact.h"
#include "libevo/sim/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// ---- arithmetic of one vector -------------------------------------------------------

// x / 6, correctly rounded. With a fused multiply-add the remainder of x * (1/6)
// is exact and one correction gives the rounded quotient (Markstein 1990), the
// same bits as a division in a fraction of its time.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V SixthOf(D d, V x) {
  const V six = hn::Set(d, 6.0);
#if HWY_NATIVE_FMA
  const V sixth = hn::Set(d, 1.0 / 6.0);
  const V quotient = hn::Mul(x, sixth);
  const V remainder = hn::NegMulAdd(quotient, six, x);
  return hn::MulAdd(remainder, sixth, quotient);
#else
  return hn::Div(x, six);
#endif
}

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

// ---- environments in lanes ------------------------------------------------------------

class SideBySide {
 public:
  using D = hn::ScalableTag<double>;
  using V = hn::Vec<D>;
  static constexpr std::size_t width = hn::MaxLanes(D());

  SideBySide(const Plan& plan, const Physics& physics, Workspace& workspace)
      : plan_(plan), physics_(physics), constants_(physics), w_(workspace) {}

  // Forces of springs [begin, end) at the given positions. In the first stage
  // the rest length of the substep is found as well.
  template <bool first_stage>
  void springs(const double* HWY_RESTRICT at, int begin, int end) {
    const D d;
    const V rate = hn::Set(d, constants_.rate);
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      const double* a = at + offset(plan_.a[s]);
      const double* b = at + offset(plan_.b[s]);
      const V qx = hn::Sub(hn::Load(d, a), hn::Load(d, b));
      const V qy = hn::Sub(hn::Load(d, a + width), hn::Load(d, b + width));
      const V length = hn::Sqrt(hn::Add(hn::Mul(qx, qx), hn::Mul(qy, qy)));
      V rest;
      if constexpr (first_stage) {
        const V goal = hn::Load(d, w_.goal + s * width);
        rest = hn::Add(length, hn::Mul(rate, hn::Sub(goal, length)));
        hn::Store(rest, d, w_.length + s * width);
      } else {
        rest = hn::Load(d, w_.length + s * width);
      }
      const V k = hn::Set(d, plan_.stiffness[s]);
      const V f = hn::Div(hn::Mul(k, hn::Sub(length, rest)), length);
      hn::Store(hn::Mul(qx, f), d, w_.force + 2 * s * width);
      hn::Store(hn::Mul(qy, f), d, w_.force + 2 * s * width + width);
    }
  }

  // Gathers the forces of every point and does its part of Runge-Kutta's stage.
  template <int stage>
  void points() {
    for (const PlanRun& run : plan_.runs) {
      if (!run.anchored)
        free_points<stage>(run);
      else if (stage < 4)
        free_points<stage>(run);
      else
        copy(w_.position, w_.previous, run.first, run.count);
    }
  }

  void limit_strain(double* HWY_RESTRICT at) {
    const D d;
    std::size_t count = 0;
    const auto live = static_cast<std::size_t>(plan_.live_springs);
    for (std::size_t s = 0; s < live; ++s) {
      const double* a = at + offset(plan_.a[s]);
      const double* b = at + offset(plan_.b[s]);
      const V qx = hn::Sub(hn::Load(d, a), hn::Load(d, b));
      const V qy = hn::Sub(hn::Load(d, a + width), hn::Load(d, b + width));
      const V square = hn::Add(hn::Mul(qx, qx), hn::Mul(qy, qy));
      const auto long_ones = hn::Gt(square, hn::Set(d, plan_.longest_square[s]));
      const auto beyond = hn::Or(long_ones, hn::Lt(square, hn::Set(d, plan_.shortest_square[s])));
      if (HWY_LIKELY(hn::AllFalse(d, beyond))) continue;
      const V c = correction(square, long_ones, beyond, plan_.limits[s]);
      const V share = hn::Set(d, constants_.correction);
      hn::Store(hn::Mul(hn::Mul(qx, c), share), d, w_.correction + 2 * count * width);
      hn::Store(hn::Mul(hn::Mul(qy, c), share), d, w_.correction + 2 * count * width + width);
      w_.corrected[count++] = static_cast<std::int32_t>(s);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(w_.corrected[i]);
      if (plan_.a_free[s]) add<-1>(at + offset(plan_.a[s]), w_.correction + 2 * i * width);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(w_.corrected[i]);
      if (plan_.b_free[s]) add<+1>(at + offset(plan_.b[s]), w_.correction + 2 * i * width);
    }
  }

  void limit_rigid_strain(double* HWY_RESTRICT at) {
    const D d;
    const V share = hn::Set(d, constants_.rigid_correction);
    for (std::size_t i = 0; i < plan_.rigid_edges.size(); ++i) {
      const auto s = static_cast<std::size_t>(plan_.rigid_edges[i]);
      const StrainLimit& limit = plan_.rigid_limits[i];
      double* a = at + offset(plan_.a[s]);
      double* b = at + offset(plan_.b[s]);
      const V ax = hn::Load(d, a);
      const V ay = hn::Load(d, a + width);
      const V bx = hn::Load(d, b);
      const V by = hn::Load(d, b + width);
      const V qx = hn::Sub(ax, bx);
      const V qy = hn::Sub(ay, by);
      const V square = hn::Add(hn::Mul(qx, qx), hn::Mul(qy, qy));
      const auto long_ones = hn::Gt(square, hn::Set(d, limit.longest_square));
      const auto beyond = hn::Or(long_ones, hn::Lt(square, hn::Set(d, limit.shortest_square)));
      if (HWY_LIKELY(hn::AllFalse(d, beyond))) continue;
      const V c = correction(square, long_ones, beyond, limit);
      const V cx = hn::Mul(hn::Mul(qx, c), share);
      const V cy = hn::Mul(hn::Mul(qy, c), share);
      hn::Store(hn::Sub(ax, cx), d, a);
      hn::Store(hn::Sub(ay, cy), d, a + width);
      hn::Store(hn::Add(bx, cx), d, b);
      hn::Store(hn::Add(by, cy), d, b + width);
    }
  }

  // Square of the longest way that a point of any block has moved from the
  // reference, one value a lane.
  void square_moved(double* HWY_RESTRICT result) const {
    const D d;
    V farthest = hn::Zero(d);
    for (const PlanBlock& block : plan_.blocks) {
      for (int slot = block.first; slot < block.first + block.integrated; ++slot) {
        const std::size_t o = offset(slot);
        const V dx = hn::Sub(hn::Load(d, w_.position + o), hn::Load(d, w_.pair_reference + o));
        const V dy = hn::Sub(hn::Load(d, w_.position + o + width),
                             hn::Load(d, w_.pair_reference + o + width));
        farthest = hn::Max(farthest, hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
      }
    }
    hn::Store(farthest, d, result);
  }

  // A bound of the square of how far two points of a block have moved relative
  // to each other, one value a lane.
  void square_sheared(const PlanBlock& block, double* HWY_RESTRICT result) const {
    const D d;
    // Held points have not moved at all.
    const double start = block.integrated < block.count ? 0.0 : HUGE_VAL;
    V low_x = hn::Set(d, start);
    V low_y = low_x;
    V high_x = hn::Set(d, -start);
    V high_y = high_x;
    for (int slot = block.first; slot < block.first + block.integrated; ++slot) {
      const std::size_t o = offset(slot);
      const V dx = hn::Sub(hn::Load(d, w_.position + o), hn::Load(d, w_.self_reference + o));
      const V dy =
          hn::Sub(hn::Load(d, w_.position + o + width), hn::Load(d, w_.self_reference + o + width));
      low_x = hn::Min(low_x, dx);
      low_y = hn::Min(low_y, dy);
      high_x = hn::Max(high_x, dx);
      high_y = hn::Max(high_y, dy);
    }
    const V x = hn::Sub(high_x, low_x);
    const V y = hn::Sub(high_y, low_y);
    hn::Store(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), d, result);
  }

 private:
  static std::size_t offset(std::int32_t slot) {
    return 2 * static_cast<std::size_t>(slot) * width;
  }

  template <int stage>
  void free_points(const PlanRun& run) {
    const D d;
    const V drag = hn::Set(d, constants_.drag);
    const V gravity = hn::Set(d, constants_.gravity);
    const V dt = hn::Set(d, constants_.substep);
    const double* HWY_RESTRICT stage_at = stage == 1 ? w_.position : w_.stage_position;
    const double* HWY_RESTRICT stage_velocity = stage == 1 ? w_.velocity : w_.stage_velocity;
    const std::int32_t* end = plan_.ends.data() + run.first_end;
    for (int slot = run.first; slot < run.first + run.count; ++slot) {
      const std::size_t o = offset(slot);
      V fx = hn::Zero(d);
      V fy = hn::Zero(d);
      for (int i = 0; i < run.a_ends; ++i, ++end) {
        const double* f = w_.force + offset(*end);
        fx = hn::Sub(fx, hn::Load(d, f));
        fy = hn::Sub(fy, hn::Load(d, f + width));
      }
      for (int i = 0; i < run.b_ends; ++i, ++end) {
        const double* f = w_.force + offset(*end);
        fx = hn::Add(fx, hn::Load(d, f));
        fy = hn::Add(fy, hn::Load(d, f + width));
      }
      const V vx = hn::Load(d, stage_velocity + o);
      const V vy = hn::Load(d, stage_velocity + o + width);
      fx = hn::Sub(fx, hn::Mul(drag, vx));
      fy = hn::Sub(hn::Sub(fy, hn::Mul(drag, vy)), gravity);
      fx = hn::Add(fx, hn::Load(d, w_.contact + o));
      fy = hn::Add(fy, hn::Load(d, w_.contact + o + width));
      const V y = hn::Load(d, stage_at + o + width);
      if (HWY_UNLIKELY(!hn::AllFalse(d, hn::Lt(y, hn::Zero(d))))) add_floor(y, vx, fx, fy);

      advance<stage>(o, dt, vx, fx, w_.velocity + o);
      advance<stage>(o + width, dt, vy, fy, w_.velocity + o + width);
    }
  }

  // One coordinate of one point: k_p = v dt, k_v = f dt, and where they lead.
  template <int stage>
  HWY_INLINE void advance(std::size_t o, V dt, V v, V f, double* HWY_RESTRICT velocity) {
    const D d;
    const V kp = hn::Mul(v, dt);
    const V kv = hn::Mul(f, dt);
    const V p0 = hn::Load(d, w_.position + o);
    const V v0 = stage == 1 ? v : hn::Load(d, velocity);
    V p_sum = kp;
    V v_sum = kv;
    if constexpr (stage == 2 || stage == 3) {
      const V two = hn::Set(d, 2.0);
      p_sum = hn::Add(hn::Load(d, w_.position_sum + o), hn::Mul(two, kp));
      v_sum = hn::Add(hn::Load(d, w_.velocity_sum + o), hn::Mul(two, kv));
    }
    if constexpr (stage < 4) {
      hn::Store(p_sum, d, w_.position_sum + o);
      hn::Store(v_sum, d, w_.velocity_sum + o);
      const V step = hn::Set(d, stage == 3 ? 1.0 : 0.5);
      hn::Store(hn::Add(p0, hn::Mul(step, kp)), d, w_.stage_position + o);
      hn::Store(hn::Add(v0, hn::Mul(step, kv)), d, w_.stage_velocity + o);
    } else {
      p_sum = hn::Add(hn::Load(d, w_.position_sum + o), kp);
      v_sum = hn::Add(hn::Load(d, w_.velocity_sum + o), kv);
      hn::Store(hn::Add(p0, SixthOf(d, p_sum)), d, w_.previous + o);
      hn::Store(hn::Add(v0, SixthOf(d, v_sum)), d, velocity);
    }
  }

  HWY_NOINLINE void add_floor(V y, V vx, V& fx, V& fy) const {
    const D d;
    HWY_ALIGN double ys[width], vs[width], fxs[width], fys[width];
    hn::Store(y, d, ys);
    hn::Store(vx, d, vs);
    hn::Store(fx, d, fxs);
    hn::Store(fy, d, fys);
    for (std::size_t i = 0; i < width; ++i)
      if (ys[i] < 0.0) AddFloor(physics_, ys[i], vs[i], fxs[i], fys[i]);
    fx = hn::Load(d, fxs);
    fy = hn::Load(d, fys);
  }

  // The factor of q that brings a spring back to its limit; 0 in lanes within.
  HWY_INLINE V correction(V square, hn::Mask<D> long_ones, hn::Mask<D> beyond,
                          const StrainLimit& limit) const {
    const D d;
    const V length = hn::Sqrt(square);
    const V target =
        hn::IfThenElse(long_ones, hn::Set(d, limit.longest), hn::Set(d, limit.shortest));
    const V c = hn::Div(hn::Sub(length, target), hn::Mul(hn::Set(d, 2.0), length));
    return hn::IfThenElseZero(beyond, c);
  }

  template <int sign>
  HWY_INLINE void add(double* HWY_RESTRICT to, const double* HWY_RESTRICT c) const {
    const D d;
    const V x = hn::Load(d, to);
    const V y = hn::Load(d, to + width);
    const V cx = hn::Load(d, c);
    const V cy = hn::Load(d, c + width);
    hn::Store(sign > 0 ? hn::Add(x, cx) : hn::Sub(x, cx), d, to);
    hn::Store(sign > 0 ? hn::Add(y, cy) : hn::Sub(y, cy), d, to + width);
  }

  void copy(const double* HWY_RESTRICT from, double* HWY_RESTRICT to, int first, int count) const {
    std::copy_n(from + offset(first), offset(count), to + offset(first));
  }

  const Plan& plan_;
  const Physics& physics_;
  Constants constants_;
  Workspace& w_;
};

// ---- one environment --------------------------------------------------------------------

#if HWY_TARGET != HWY_SCALAR
// D: vectors of springs. Points are vectors of two.
template <class D>
class Alone {
 public:
  using P = hn::FixedTag<hn::TFromD<D>, 2>;  // a point: x, y
  using V = hn::Vec<D>;
  using XY = hn::Vec<P>;
  static constexpr std::size_t width = 1;
  static constexpr std::size_t springs_at_once = hn::MaxLanes(D());

  Alone(const Plan& plan, const Physics& physics, Workspace& workspace)
      : plan_(plan), physics_(physics), constants_(physics), w_(workspace) {}

  template <bool first_stage>
  void springs(const double* HWY_RESTRICT at, int begin, int end) {
    const D d;
    const V rate = hn::Set(d, constants_.rate);
    // Starts at a multiple: a few springs before `begin` may be done again.
    auto s = static_cast<std::size_t>(begin) / springs_at_once * springs_at_once;
    for (; s < static_cast<std::size_t>(end); s += springs_at_once) {
      V qx, qy;
      load_differences(at, s, qx, qy);
      const V length = hn::Sqrt(hn::Add(hn::Mul(qx, qx), hn::Mul(qy, qy)));
      V rest;
      if constexpr (first_stage) {
        rest = hn::Add(length, hn::Mul(rate, hn::Sub(hn::LoadU(d, w_.goal + s), length)));
        hn::StoreU(rest, d, w_.length + s);
      } else {
        rest = hn::LoadU(d, w_.length + s);
      }
      const V k = hn::LoadU(d, plan_.stiffness.data() + s);
      const V f = hn::Div(hn::Mul(k, hn::Sub(length, rest)), length);
      store_pairs(hn::Mul(qx, f), hn::Mul(qy, f), w_.force + 2 * s);
    }
  }

  template <int stage>
  void points() {
    for (const PlanRun& run : plan_.runs) {
      if (stage == 4 && run.anchored)
        std::copy_n(w_.position + offset(run.first), offset(run.count),
                    w_.previous + offset(run.first));
      else
        free_points<stage>(run);
    }
  }

  void limit_strain(double* HWY_RESTRICT at) {
    const D d;
    const P p;
    std::size_t count = 0;
    const auto live = static_cast<std::size_t>(plan_.live_springs);
    HWY_ALIGN double pairs[2 * springs_at_once];
    for (std::size_t s = 0; s < live; s += springs_at_once) {
      V qx, qy;
      load_differences(at, s, qx, qy);
      const V square = hn::Add(hn::Mul(qx, qx), hn::Mul(qy, qy));
      const auto long_ones = hn::Gt(square, hn::LoadU(d, plan_.longest_square.data() + s));
      const auto beyond =
          hn::Or(long_ones, hn::Lt(square, hn::LoadU(d, plan_.shortest_square.data() + s)));
      if (HWY_LIKELY(hn::AllFalse(d, beyond))) continue;
      HWY_ALIGN double squares[springs_at_once];
      HWY_ALIGN double targets[springs_at_once];
      hn::Store(square, d, squares);
      for (std::size_t i = 0; i < springs_at_once; ++i) {
        const StrainLimit& limit = plan_.limits[s + i];
        targets[i] = squares[i] > limit.longest_square ? limit.longest : limit.shortest;
      }
      const V length = hn::Sqrt(square);
      const V c = hn::Div(hn::Sub(length, hn::Load(d, targets)), hn::Mul(hn::Set(d, 2.0), length));
      const V share = hn::Set(d, constants_.correction);
      store_pairs(hn::Mul(hn::Mul(qx, c), share), hn::Mul(hn::Mul(qy, c), share), pairs);
      for (std::size_t i = 0; i < springs_at_once && s + i < live; ++i) {
        const StrainLimit& limit = plan_.limits[s + i];
        if (!(squares[i] > limit.longest_square || squares[i] < limit.shortest_square)) continue;
        hn::Store(hn::Load(p, pairs + 2 * i), p, w_.correction + 2 * count);
        w_.corrected[count++] = static_cast<std::int32_t>(s + i);
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(w_.corrected[i]);
      double* a = at + offset(plan_.a[s]);
      if (plan_.a_free[s])
        hn::Store(hn::Sub(hn::Load(p, a), hn::Load(p, w_.correction + 2 * i)), p, a);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(w_.corrected[i]);
      double* b = at + offset(plan_.b[s]);
      if (plan_.b_free[s])
        hn::Store(hn::Add(hn::Load(p, b), hn::Load(p, w_.correction + 2 * i)), p, b);
    }
  }

  void limit_rigid_strain(double* HWY_RESTRICT at) {
    for (std::size_t i = 0; i < plan_.rigid_edges.size(); ++i) {
      const auto s = static_cast<std::size_t>(plan_.rigid_edges[i]);
      const StrainLimit& limit = plan_.rigid_limits[i];
      double* a = at + offset(plan_.a[s]);
      double* b = at + offset(plan_.b[s]);
      const double qx = a[0] - b[0];
      const double qy = a[1] - b[1];
      const double square = qx * qx + qy * qy;
      const bool too_long = square > limit.longest_square;
      if (HWY_LIKELY(!too_long && !(square < limit.shortest_square))) continue;
      const double length = std::sqrt(square);
      const double c = (length - (too_long ? limit.longest : limit.shortest)) / (2.0 * length);
      const double cx = qx * c * constants_.rigid_correction;
      const double cy = qy * c * constants_.rigid_correction;
      a[0] -= cx;
      a[1] -= cy;
      b[0] += cx;
      b[1] += cy;
    }
  }

  void square_moved(double* HWY_RESTRICT result) const {
    const P p;
    XY farthest = hn::Zero(p);
    for (const PlanBlock& block : plan_.blocks) {
      for (int slot = block.first; slot < block.first + block.integrated; ++slot) {
        const XY d = hn::Sub(hn::Load(p, w_.position + offset(slot)),
                             hn::Load(p, w_.pair_reference + offset(slot)));
        farthest = hn::Max(farthest, hn::Mul(d, d));
      }
    }
    *result = hn::GetLane(hn::SumOfLanes(p, farthest));
  }

  void square_sheared(const PlanBlock& block, double* HWY_RESTRICT result) const {
    const P p;
    const double start = block.integrated < block.count ? 0.0 : HUGE_VAL;
    XY low = hn::Set(p, start);
    XY high = hn::Set(p, -start);
    for (int slot = block.first; slot < block.first + block.integrated; ++slot) {
      const XY d = hn::Sub(hn::Load(p, w_.position + offset(slot)),
                           hn::Load(p, w_.self_reference + offset(slot)));
      low = hn::Min(low, d);
      high = hn::Max(high, d);
    }
    const XY range = hn::Sub(high, low);
    *result = hn::GetLane(hn::SumOfLanes(p, hn::Mul(range, range)));
  }

 private:
  static std::size_t offset(std::int32_t slot) { return 2 * static_cast<std::size_t>(slot); }

  // a - b of springs s, s+1, .. by coordinate.
  HWY_INLINE void load_differences(const double* HWY_RESTRICT at, std::size_t s, V& qx,
                                   V& qy) const {
    const D d;
    const P p;
    const std::int32_t* a = plan_.a.data() + s;
    const std::int32_t* b = plan_.b.data() + s;
    V even, odd;  // (x, y) of springs 0 and 2, of 1 and 3
    if constexpr (springs_at_once == 4) {
      even =
          hn::Sub(hn::Combine(d, hn::Load(p, at + offset(a[2])), hn::Load(p, at + offset(a[0]))),
                  hn::Combine(d, hn::Load(p, at + offset(b[2])), hn::Load(p, at + offset(b[0]))));
      odd = hn::Sub(hn::Combine(d, hn::Load(p, at + offset(a[3])), hn::Load(p, at + offset(a[1]))),
                    hn::Combine(d, hn::Load(p, at + offset(b[3])), hn::Load(p, at + offset(b[1]))));
    } else {
      even = hn::Sub(hn::Load(d, at + offset(a[0])), hn::Load(d, at + offset(b[0])));
      odd = hn::Sub(hn::Load(d, at + offset(a[1])), hn::Load(d, at + offset(b[1])));
    }
    qx = hn::InterleaveLower(d, even, odd);
    qy = hn::InterleaveUpper(d, even, odd);
  }

  // The inverse: x and y of each spring side by side.
  HWY_INLINE void store_pairs(V x, V y, double* HWY_RESTRICT to) const {
    const D d;
    const P p;
    const V even = hn::InterleaveLower(d, x, y);
    const V odd = hn::InterleaveUpper(d, x, y);
    if constexpr (springs_at_once == 4) {
      hn::Store(hn::LowerHalf(p, even), p, to);
      hn::Store(hn::LowerHalf(p, odd), p, to + 2);
      hn::Store(hn::UpperHalf(p, even), p, to + 4);
      hn::Store(hn::UpperHalf(p, odd), p, to + 6);
    } else {
      hn::Store(even, d, to);
      hn::Store(odd, d, to + 2);
    }
  }

  template <int stage>
  void free_points(const PlanRun& run) {
    const P p;
    const XY drag = hn::Set(p, constants_.drag);
    HWY_ALIGN const double down[2] = {0.0, constants_.gravity};
    const XY gravity = hn::Load(p, down);
    const XY dt = hn::Set(p, constants_.substep);
    const double* HWY_RESTRICT stage_at = stage == 1 ? w_.position : w_.stage_position;
    const double* HWY_RESTRICT stage_velocity = stage == 1 ? w_.velocity : w_.stage_velocity;
    const std::int32_t* end = plan_.ends.data() + run.first_end;
    for (int slot = run.first; slot < run.first + run.count; ++slot) {
      const std::size_t o = offset(slot);
      XY f = hn::Zero(p);
      for (int i = 0; i < run.a_ends; ++i, ++end)
        f = hn::Sub(f, hn::Load(p, w_.force + offset(*end)));
      for (int i = 0; i < run.b_ends; ++i, ++end)
        f = hn::Add(f, hn::Load(p, w_.force + offset(*end)));
      const XY v = hn::Load(p, stage_velocity + o);
      f = hn::Sub(hn::Sub(f, hn::Mul(drag, v)), gravity);
      f = hn::Add(f, hn::Load(p, w_.contact + o));
      if (HWY_UNLIKELY(stage_at[o + 1] < 0.0)) {
        HWY_ALIGN double force[2];
        hn::Store(f, p, force);
        AddFloor(physics_, stage_at[o + 1], stage_velocity[o], force[0], force[1]);
        f = hn::Load(p, force);
      }
      advance<stage>(o, dt, v, f);
    }
  }

  template <int stage>
  HWY_INLINE void advance(std::size_t o, XY dt, XY v, XY f) {
    const P d;
    const XY kp = hn::Mul(v, dt);
    const XY kv = hn::Mul(f, dt);
    const XY p0 = hn::Load(d, w_.position + o);
    const XY v0 = stage == 1 ? v : hn::Load(d, w_.velocity + o);
    XY p_sum = kp;
    XY v_sum = kv;
    if constexpr (stage == 2 || stage == 3) {
      const XY two = hn::Set(d, 2.0);
      p_sum = hn::Add(hn::Load(d, w_.position_sum + o), hn::Mul(two, kp));
      v_sum = hn::Add(hn::Load(d, w_.velocity_sum + o), hn::Mul(two, kv));
    }
    if constexpr (stage < 4) {
      hn::Store(p_sum, d, w_.position_sum + o);
      hn::Store(v_sum, d, w_.velocity_sum + o);
      const XY step = hn::Set(d, stage == 3 ? 1.0 : 0.5);
      hn::Store(hn::Add(p0, hn::Mul(step, kp)), d, w_.stage_position + o);
      hn::Store(hn::Add(v0, hn::Mul(step, kv)), d, w_.stage_velocity + o);
    } else {
      p_sum = hn::Add(hn::Load(d, w_.position_sum + o), kp);
      v_sum = hn::Add(hn::Load(d, w_.velocity_sum + o), kv);
      hn::Store(hn::Add(p0, SixthOf(d, p_sum)), d, w_.previous + o);
      hn::Store(hn::Add(v0, SixthOf(d, v_sum)), d, w_.velocity + o);
    }
  }

  const Plan& plan_;
  const Physics& physics_;
  Constants constants_;
  Workspace& w_;
};

using OneAlone = Alone<hn::CappedTag<double, 4>>;
#else
using OneAlone = SideBySide;  // of one lane
#endif

// ---- a control step -----------------------------------------------------------------------

template <class Kernel>
class ControlStep {
 public:
  static constexpr std::size_t width = Kernel::width;

  ControlStep(std::span<Lane> lanes, Workspace& workspace)
      : lanes_(lanes),
        plan_(lanes[0].model->compiled().plan),
        physics_(lanes[0].model->physics()),
        w_(workspace),
        kernel_(plan_, physics_, workspace) {}

  void run() {
    w_.prepare(plan_, width);
    for (std::size_t i = 0; i < width; ++i) load(i, lanes_[std::min(i, lanes_.size() - 1)]);
    std::fill_n(w_.contact, 2 * static_cast<std::size_t>(plan_.slots) * width, 0.0);
    kernel_.template springs<true>(w_.position, plan_.live_springs, plan_.springs);
    std::size_t running = lanes_.size();
    for (int i = 0; i < physics_.substeps && running > 0; ++i) {
      substep();
      running -= stop_folded();
    }
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (lanes_[i].result == StepResult::done) store(i);
  }

 private:
  void substep() {
    contacts();
    kernel_.template springs<true>(w_.position, 0, plan_.live_springs);
    kernel_.template points<1>();
    kernel_.template springs<false>(w_.stage_position, 0, plan_.live_springs);
    kernel_.template points<2>();
    kernel_.template springs<false>(w_.stage_position, 0, plan_.live_springs);
    kernel_.template points<3>();
    kernel_.template springs<false>(w_.stage_position, 0, plan_.live_springs);
    kernel_.template points<4>();
    kernel_.limit_strain(w_.previous);
    kernel_.limit_rigid_strain(w_.previous);
    std::swap(w_.position, w_.previous);
  }

  const Model::Compiled& world(std::size_t i) const { return lanes_[i].model->compiled(); }
  PointView view(std::size_t i) const {
    return {w_.position + i, w_.previous + i, w_.contact + i, width};
  }

  void contacts() {
    renew_lists();
    if (std::exchange(touching_, false))
      std::fill_n(w_.contact, 2 * static_cast<std::size_t>(plan_.slots) * width, 0.0);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (lanes_[i].result != StepResult::done) continue;
      const ContactLists& lists = lanes_[i].state->contacts;
      touching_ |= push_contacts(world(i), lists, view(i));
      folding_[i] = is_folding(world(i), lists, view(i));
    }
  }

  // Finds contact candidates again where something has moved too far.
  void renew_lists() {
    HWY_ALIGN double moved[width];
    kernel_.square_moved(moved);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      ContactLists& lists = lanes_[i].state->contacts;
      if (lanes_[i].result != StepResult::done) continue;
      if (lists.pairs_valid && moved[i] <= pair_move_limit * pair_move_limit) continue;
      find_pair_contacts(world(i), view(i), lists);
      load_reference(i, lists.pair_reference, w_.pair_reference, 0, plan_.slots);
    }
    for (std::size_t block = 0; block < plan_.blocks.size(); ++block) {
      kernel_.square_sheared(plan_.blocks[block], moved);
      for (std::size_t i = 0; i < lanes_.size(); ++i) {
        ContactLists& lists = lanes_[i].state->contacts;
        if (lanes_[i].result != StepResult::done) continue;
        if (lists.self[block].valid && moved[i] <= self_move_limit * self_move_limit) continue;
        find_self_contacts(world(i), world(i).object_of_block[block], view(i), lists);
        load_reference(i, lists.self_reference, w_.self_reference, plan_.blocks[block].first,
                       plan_.blocks[block].count);
      }
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
    for (std::size_t slot = 0; slot < static_cast<std::size_t>(plan_.slots); ++slot) {
      const auto p = static_cast<std::size_t>(plan_.state_of[slot]);
      set(w_.position, i, slot, state.x[p], state.y[p]);
      set(w_.previous, i, slot, state.previous_x[p], state.previous_y[p]);
      set(w_.velocity, i, slot, state.vx[p], state.vy[p]);
    }
    for (const PlanBlock& block : plan_.blocks) {
      for (int held = block.first + block.integrated; held < block.first + block.count; ++held) {
        const auto slot = static_cast<std::size_t>(held);
        const auto p = static_cast<std::size_t>(plan_.state_of[slot]);
        set(w_.previous, i, slot, state.x[p], state.y[p]);
        set(w_.stage_position, i, slot, state.x[p], state.y[p]);
      }
    }
    load_reference(i, state.contacts.self_reference, w_.self_reference, 0, plan_.slots);
    load_reference(i, state.contacts.pair_reference, w_.pair_reference, 0, plan_.slots);
    for (std::size_t s = 0; s < plan_.rest.size(); ++s) w_.goal[s * width + i] = plan_.rest[s];
    for (const Plan::Drive& drive : plan_.drives) {
      const double mean =
          (target(state, drive.first_actuator) + target(state, drive.second_actuator)) / 2.0;
      const auto s = static_cast<std::size_t>(drive.spring);
      w_.goal[s * width + i] = mean * plan_.rest[s];
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
      state.vx[p] = w_.velocity[o];
      state.vy[p] = w_.velocity[o + width];
    }
  }

  static void set(double* array, std::size_t i, std::size_t slot, double x, double y) {
    array[2 * slot * width + i] = x;
    array[2 * slot * width + width + i] = y;
  }

  static void load_reference(std::size_t i, const std::vector<double>& from, double* to, int first,
                             int count) {
    for (auto slot = static_cast<std::size_t>(first);
         slot < static_cast<std::size_t>(first + count); ++slot)
      set(to, i, slot, from[2 * slot], from[2 * slot + 1]);
  }

  std::span<Lane> lanes_;
  const Plan& plan_;
  const Physics& physics_;
  Workspace& w_;
  Kernel kernel_;
  std::array<bool, width> folding_{};
  bool touching_ = false;
};

std::size_t LaneWidth() { return SideBySide::width; }
void StepSideBySide(std::span<Lane> lanes, Workspace& workspace) {
  ControlStep<SideBySide>(lanes, workspace).run();
}
void StepAlone(Lane& lane, Workspace& workspace) {
  ControlStep<OneAlone>({&lane, 1}, workspace).run();
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace evo {
namespace {

HWY_EXPORT(LaneWidth);
HWY_EXPORT(StepSideBySide);
HWY_EXPORT(StepAlone);

}  // namespace

std::size_t lane_width() { return HWY_DYNAMIC_DISPATCH(LaneWidth)(); }
void step_side_by_side(std::span<Lane> lanes, Workspace& workspace) {
  HWY_DYNAMIC_DISPATCH(StepSideBySide)(lanes, workspace);
}
void step_alone(Lane& lane, Workspace& workspace) {
  HWY_DYNAMIC_DISPATCH(StepAlone)(lane, workspace);
}

}  // namespace evo
#endif  // HWY_ONCE
