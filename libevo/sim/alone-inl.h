// The kernel for one environment, its springs in the lanes of vectors (see
// kernels.cpp). Included once an instruction set (see Highway's "-inl.h" files).

#if defined(LIBEVO_SIM_ALONE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_SIM_ALONE_INL_H_
#undef LIBEVO_SIM_ALONE_INL_H_
#else
#define LIBEVO_SIM_ALONE_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "libevo/sim/arithmetic-inl.h"
#include "libevo/sim/integrate-inl.h"
#include "libevo/sim/plan.h"
#include "libevo/sim/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR

// D: vectors of springs. Points are vectors of two.
template <Arithmetic arithmetic_, class D>
class Alone {
 public:
  static constexpr Arithmetic arithmetic = arithmetic_;
  using Math = SpringMath<arithmetic>;
  using P = hn::FixedTag<hn::TFromD<D>, 2>;  // a point: x, y
  using V = hn::Vec<D>;
  using XY = hn::Vec<P>;
  static constexpr std::size_t width = 1;
  static constexpr std::size_t springs_at_once = hn::MaxLanes(D());

  Alone(const Plan& plan, const Physics& physics, const Arrays& arrays)
      : plan_(plan),
        physics_(physics),
        constants_(physics),
        w_(arrays),
        gravity_{0.0, physics.gravity} {}

  // The record of a spring in Arrays::force: its force alone.
  static constexpr std::size_t force_record = 2;
  static constexpr std::size_t force_offset = 0;

  // Forces of springs s, s+1, ..; there may be fewer, the arrays are padded.
  template <bool first_stage>
  HWY_INLINE void springs(const double* HWY_RESTRICT at, std::size_t s) const {
    const D d;
    V qx, qy;
    load_differences(at, w_.spring_ends + s, qx, qy);
    const V f = Math::template pull<first_stage>(
        d, Math::square(d, qx, qy), hn::LoadU(d, plan_.stiffness.data() + s), constants_.rate,
        w_.goal + s, w_.kept + Math::kept * s);
    store_pairs(hn::Mul(qx, f), hn::Mul(qy, f), w_.force + 2 * s);
  }

  template <bool first_stage>
  void last_springs(const double* HWY_RESTRICT at, std::size_t s, std::size_t end) const {
    s = s / springs_at_once * springs_at_once;  // a few may be done again
    for (; s < end; s += springs_at_once) springs<first_stage>(at, s);
  }

  template <int stage>
  HWY_INLINE void point(std::size_t o, const std::uint32_t* HWY_RESTRICT end, int a_ends,
                        int b_ends, const double* HWY_RESTRICT at,
                        double* HWY_RESTRICT next) const {
    const P p;
    double* HWY_RESTRICT motion = w_.motion + Motion::records * o;
    XY f = SumForces<arithmetic>(p, w_.force, end, a_ends, b_ends);
    const XY v = hn::Load(p, motion + Motion::velocity_of(stage, arithmetic == Arithmetic::fast));
    f = AddLoads<arithmetic>(p, f, v, hn::LoadU(p, gravity_), constants_.drag,
                             motion + Motion::contact);
    if (HWY_UNLIKELY(at[o + 1] < 0.0)) f = with_floor(physics_, at[o + 1], v, f);
    Advance<arithmetic, stage, width>(p, v, f, constants_.substep, w_.position + o, next + o,
                                      motion);
  }

  void limit_strain(double* HWY_RESTRICT at) {
    const D d;
    const P p;
    std::size_t count = 0;
    const Plan::Strain& strain = plan_.strain;
    const std::size_t live = strain.springs;
    HWY_ALIGN double pairs[2 * springs_at_once];
    for (std::size_t s = 0; s < live; s += springs_at_once) {
      V qx, qy;
      load_differences(at, w_.strain_ends + s, qx, qy);
      const V square = Math::square(d, qx, qy);
      const auto long_ones = hn::Gt(square, hn::LoadU(d, strain.longest_square.data() + s));
      const auto beyond =
          hn::Or(long_ones, hn::Lt(square, hn::LoadU(d, strain.shortest_square.data() + s)));
      if (HWY_LIKELY(hn::AllFalse(d, beyond))) continue;
      HWY_ALIGN double squares[springs_at_once];
      HWY_ALIGN double targets[springs_at_once];
      hn::Store(square, d, squares);
      for (std::size_t i = 0; i < springs_at_once; ++i) {
        const StrainLimit& limit = strain.limits[s + i];
        targets[i] = squares[i] > limit.longest_square ? limit.longest : limit.shortest;
      }
      const V c = Math::correction(d, square, V(hn::Load(d, targets)));
      const V share = hn::Set(d, constants_.correction);
      store_pairs(hn::Mul(hn::Mul(qx, c), share), hn::Mul(hn::Mul(qy, c), share), pairs);
      for (std::size_t i = 0; i < springs_at_once && s + i < live; ++i) {
        const StrainLimit& limit = strain.limits[s + i];
        if (!(squares[i] > limit.longest_square || squares[i] < limit.shortest_square)) continue;
        hn::Store(hn::Load(p, pairs + 2 * i), p, w_.correction + 2 * count);
        w_.corrected[count++] = static_cast<std::int32_t>(s + i);
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(w_.corrected[i]);
      double* a = at + w_.strain_ends[s].a;
      if (strain.a_free[s])
        hn::Store(hn::Sub(hn::Load(p, a), hn::Load(p, w_.correction + 2 * i)), p, a);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(w_.corrected[i]);
      double* b = at + w_.strain_ends[s].b;
      if (strain.b_free[s])
        hn::Store(hn::Add(hn::Load(p, b), hn::Load(p, w_.correction + 2 * i)), p, b);
    }
  }

  void limit_rigid_strain(double* HWY_RESTRICT at) {
    const hn::CappedTag<double, 1> one;
    for (const auto& [edge_a, edge_b, limit] : plan_.rigid_edges) {
      double* a = at + offset(edge_a);
      double* b = at + offset(edge_b);
      const double qx = a[0] - b[0];
      const double qy = a[1] - b[1];
      const auto lane = Math::square(one, hn::Set(one, qx), hn::Set(one, qy));
      const double square = hn::GetLane(lane);
      const bool too_long = square > limit.longest_square;
      if (HWY_LIKELY(!too_long && !(square < limit.shortest_square))) continue;
      const auto target = hn::Set(one, too_long ? limit.longest : limit.shortest);
      const double c = hn::GetLane(Math::correction(one, lane, target));
      const double cx = qx * c * constants_.rigid_correction;
      const double cy = qy * c * constants_.rigid_correction;
      a[0] -= cx;
      a[1] -= cy;
      b[0] += cx;
      b[1] += cy;
    }
  }

  void add_travel() const {
    const P p;
    double fastest = 0.0;
    for (std::size_t block = 0; block < plan_.blocks.size(); ++block) {
      const PlanBlock& slots = plan_.blocks[block];
      XY farthest = hn::Zero(p);
      for (int slot = slots.first; slot < slots.first + slots.integrated; ++slot) {
        const XY d = hn::Sub(hn::Load(p, w_.position + offset(slot)),
                             hn::Load(p, w_.previous + offset(slot)));
        farthest = hn::Max(farthest, hn::Mul(d, d));
      }
      const double way = std::sqrt(hn::GetLane(hn::SumOfLanes(p, farthest)));
      w_.travel[block] += way;
      fastest = std::max(fastest, way);
    }
    w_.travel[plan_.blocks.size() + 1] += fastest;
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

  // Positions of the ends a of four (two) springs minus those of b, by coordinate.
  static HWY_INLINE void load_differences(const double* HWY_RESTRICT at, const SpringEnds* ends,
                                          V& qx, V& qy) {
    const D d;
    const P p;
    V even, odd;  // (x, y) of springs 0 and 2, of 1 and 3
    if constexpr (springs_at_once == 4) {
      even = hn::Sub(hn::Combine(d, hn::Load(p, at + ends[2].a), hn::Load(p, at + ends[0].a)),
                     hn::Combine(d, hn::Load(p, at + ends[2].b), hn::Load(p, at + ends[0].b)));
      odd = hn::Sub(hn::Combine(d, hn::Load(p, at + ends[3].a), hn::Load(p, at + ends[1].a)),
                    hn::Combine(d, hn::Load(p, at + ends[3].b), hn::Load(p, at + ends[1].b)));
    } else {
      even = hn::Sub(hn::Load(d, at + ends[0].a), hn::Load(d, at + ends[0].b));
      odd = hn::Sub(hn::Load(d, at + ends[1].a), hn::Load(d, at + ends[1].b));
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

  static HWY_NOINLINE XY with_floor(const Physics& physics, double y, XY v, XY f) {
    const P p;
    HWY_ALIGN double force[2];
    hn::Store(f, p, force);
    AddFloor(physics, y, hn::GetLane(v), force[0], force[1]);
    return hn::Load(p, force);
  }

  const Plan& plan_;
  const Physics& physics_;
  Constants constants_;
  Arrays w_;
  double gravity_[2];
};

#endif  // vectors

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
