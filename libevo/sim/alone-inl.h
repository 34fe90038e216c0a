// The kernel for one environment, its springs in the lanes of vectors (see
// kernels.cpp). Included once per instruction set (see Highway's "-inl.h" files).

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

// Springs in the lanes of a vector; points are vectors of two.
template <Arithmetic arithmetic_>
class Alone {
 public:
  static constexpr Arithmetic arithmetic = arithmetic_;
  using Math = SpringMath<arithmetic>;
  using Real = StageReal<arithmetic>;
  using D = hn::CappedTag<Real, 4>;  // springs in a stage
  using P = hn::FixedTag<Real, 2>;   // a point in a stage: x, y
  using V = hn::Vec<D>;
  using XY = hn::Vec<P>;
  static constexpr std::size_t width = 1;
  // Two registers of springs, then two points, where roots and quotients take long:
  // more of them are under way at a time.
  static constexpr std::size_t registers = arithmetic == Arithmetic::exact ? 2 : 1;
  static constexpr std::size_t springs_at_once = registers * hn::MaxLanes(D());
  static constexpr std::size_t points_at_once = registers;

  Alone(const Plan& plan, const Physics& physics, const Arrays<arithmetic>& arrays, bool near_floor)
      : plan_(plan),
        physics_(physics),
        constants_(physics),
        w_(arrays),
        gravity_{0.0, physics.gravity},
        near_floor_(near_floor) {}

  // The record of a spring in Arrays::force: its force alone.
  static constexpr std::size_t force_record = 2;
  static constexpr std::size_t force_offset = 0;

  void choose_origin(std::size_t block) const {
    const LP p;
    const PlanBlock& sites = plan_.blocks[block];
    LXY low = hn::Set(p, HUGE_VAL);
    LXY high = hn::Set(p, -HUGE_VAL);
    for (int site = sites.first; site < sites.first + sites.count; ++site) {
      const LXY position = hn::Load(p, w_.position + offset(site));
      low = hn::Min(low, position);
      high = hn::Max(high, position);
    }
    hn::Store(hn::Mul(hn::Set(p, 0.5), hn::Add(low, high)), p, w_.origin + 2 * block);
  }

  HWY_INLINE void store_start(std::int32_t site, std::size_t block) const {
    const LP p;
    demote(hn::Sub(hn::Load(p, w_.position + offset(site)), hn::Load(p, w_.origin + 2 * block)),
           w_.start + offset(site));
  }

  HWY_INLINE void store_motion(std::int32_t site) const {
    const LP p;
    const double* motion = w_.motion_of(offset(site));
    float* stage_motion = w_.stage_motion_of(offset(site));
    demote(hn::Load(p, motion + Motion::velocity), stage_motion + StageMotion::velocity_of(1));
    demote(hn::Sub(hn::Load(p, motion + Motion::contact), hn::LoadU(p, gravity_)),
           stage_motion + StageMotion::load);
  }

  HWY_INLINE bool is_near_floor(std::size_t o) const {
    return !(w_.position[o + 1] > constants_.floor_reach);
  }

  // Forces of springs s, s+1, ..; there may be fewer, the arrays are padded.
  template <bool first_stage>
  HWY_INLINE void springs(const Real* HWY_RESTRICT at, std::size_t s) const {
    for (std::size_t r = 0; r < registers; ++r)
      springs_in_register<first_stage>(at, s + r * hn::MaxLanes(D()));
  }

  template <bool first_stage>
  void last_springs(const Real* HWY_RESTRICT at, std::size_t s, std::size_t end) const {
    s = s / springs_at_once * springs_at_once;  // a few may be done again
    for (; s < end; s += springs_at_once) springs<first_stage>(at, s);
  }

  template <int stage, class Next>
  HWY_INLINE void point(std::size_t o, const std::uint32_t* HWY_RESTRICT end, int a_ends,
                        int b_ends, const Real* HWY_RESTRICT at, Next* HWY_RESTRICT next) const {
    const P p;
    XY f = SumForces<arithmetic>(p, w_.force, end, a_ends, b_ends);
    double* HWY_RESTRICT motion = w_.motion_of(o);
    const XY drag = hn::Set(p, constants_.drag);
    const double dt = constants_.substep;
    if constexpr (arithmetic == Arithmetic::exact) {
      const XY v = hn::Load(p, motion + (stage == 1 ? Motion::velocity : Motion::stage_velocity));
      f = hn::Sub(hn::Sub(f, hn::Mul(drag, v)), hn::LoadU(p, gravity_));
      f = hn::Add(f, hn::Load(p, motion + Motion::contact));
      if (HWY_UNLIKELY(at[o + 1] < 0.0)) f = with_floor(at[o + 1], v, f);
      AdvanceExactly<stage, width>(p, v, f, dt, w_.position + o, next + o, motion);
    } else {
      float* HWY_RESTRICT record = w_.stage_motion_of(o);
      const XY v = hn::Load(p, record + StageMotion::velocity_of(stage));
      f = hn::NegMulAdd(drag, v, hn::Add(f, hn::Load(p, record + StageMotion::load)));
      if (HWY_UNLIKELY(near_floor_)) {
        const double y = at[o + 1] + height_of_origin(o);
        if (y < 0.0) f = with_floor(y, v, f);
      }
      if constexpr (stage < 4) {
        AdvanceFast<stage, width>(p, v, f, dt, w_.start + o, next + o, record);
      } else {
        const LP l;
        const Rise<XY> rise = RiseOf<width>(p, v, f, dt, record);
        double* velocity = motion + Motion::velocity;
        hn::Store(hn::Add(hn::Load(l, w_.position + o), hn::PromoteTo(l, rise.position)), l,
                  next + o);
        hn::Store(hn::Add(hn::Load(l, velocity), hn::PromoteTo(l, rise.velocity)), l, velocity);
      }
    }
  }

  void limit_strain(double* HWY_RESTRICT at) const {
    const L d;
    const LP p;
    std::size_t count = 0;
    const Plan::Strain& strain = plan_.strain;
    const std::size_t live = strain.springs;
    HWY_ALIGN double pairs[2 * limits_at_once];
    for (std::size_t s = 0; s < live; s += limits_at_once) {
      LV qx, qy;
      load_differences(d, at, w_.strain_ends + s, qx, qy);
      const LV square = Limits::square(d, qx, qy);
      const auto long_ones = hn::Gt(square, hn::LoadU(d, strain.longest_square.data() + s));
      const auto beyond =
          hn::Or(long_ones, hn::Lt(square, hn::LoadU(d, strain.shortest_square.data() + s)));
      if (HWY_LIKELY(hn::AllFalse(d, beyond))) continue;
      HWY_ALIGN double squares[limits_at_once];
      HWY_ALIGN double targets[limits_at_once];
      hn::Store(square, d, squares);
      for (std::size_t i = 0; i < limits_at_once; ++i) {
        const StrainLimit& limit = strain.limits[s + i];
        targets[i] = squares[i] > limit.longest_square ? limit.longest : limit.shortest;
      }
      const LV c = Limits::correction(d, square, LV(hn::Load(d, targets)));
      const LV share = hn::Set(d, constants_.correction);
      store_pairs(d, hn::Mul(hn::Mul(qx, c), share), hn::Mul(hn::Mul(qy, c), share), pairs);
      for (std::size_t i = 0; i < limits_at_once && s + i < live; ++i) {
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

  void limit_rigid_strain(double* HWY_RESTRICT at) const {
    const hn::CappedTag<double, 1> one;
    for (const auto& [edge_a, edge_b, limit] : plan_.rigid_edges) {
      double* a = at + offset(edge_a);
      double* b = at + offset(edge_b);
      const double qx = a[0] - b[0];
      const double qy = a[1] - b[1];
      const auto lane = Limits::square(one, hn::Set(one, qx), hn::Set(one, qy));
      const double square = hn::GetLane(lane);
      const bool too_long = square > limit.longest_square;
      if (HWY_LIKELY(!too_long && !(square < limit.shortest_square))) continue;
      const auto target = hn::Set(one, too_long ? limit.longest : limit.shortest);
      const double c = hn::GetLane(Limits::correction(one, lane, target));
      const double cx = qx * c * constants_.rigid_correction;
      const double cy = qy * c * constants_.rigid_correction;
      a[0] -= cx;
      a[1] -= cy;
      b[0] += cx;
      b[1] += cy;
    }
  }

  void add_travel() const {
    const LP p;
    double fastest = 0.0;
    for (std::size_t block = 0; block < plan_.blocks.size(); ++block) {
      const PlanBlock& sites = plan_.blocks[block];
      LXY farthest = hn::Zero(p);
      for (int site = sites.first; site < sites.first + sites.integrated; ++site) {
        const LXY d = hn::Sub(hn::Load(p, w_.position + offset(site)),
                              hn::Load(p, w_.previous + offset(site)));
        farthest = hn::Max(farthest, hn::Mul(d, d));
      }
      const double way = std::sqrt(hn::GetLane(hn::SumOfLanes(p, farthest)));
      w_.travel[block] += way;
      fastest = std::max(fastest, way);
    }
    w_.travel[plan_.blocks.size() + 1] += fastest;
  }

  void square_moved(double* HWY_RESTRICT result) const {
    const LP p;
    LXY farthest = hn::Zero(p);
    for (const PlanBlock& block : plan_.blocks) {
      for (int site = block.first; site < block.first + block.integrated; ++site) {
        const LXY d = hn::Sub(hn::Load(p, w_.position + offset(site)),
                              hn::Load(p, w_.pair_listing + offset(site)));
        farthest = hn::Max(farthest, hn::Mul(d, d));
      }
    }
    *result = hn::GetLane(hn::SumOfLanes(p, farthest));
  }

  void square_sheared(const PlanBlock& block, double* HWY_RESTRICT result) const {
    const LP p;
    const double start = block.integrated < block.count ? 0.0 : HUGE_VAL;
    LXY low = hn::Set(p, start);
    LXY high = hn::Set(p, -start);
    for (int site = block.first; site < block.first + block.integrated; ++site) {
      const LXY d = hn::Sub(hn::Load(p, w_.position + offset(site)),
                            hn::Load(p, w_.self_listing + offset(site)));
      low = hn::Min(low, d);
      high = hn::Max(high, d);
    }
    const LXY range = hn::Sub(high, low);
    *result = hn::GetLane(hn::SumOfLanes(p, hn::Mul(range, range)));
  }

 private:
  // Between the stages everything is double.
  using L = hn::CappedTag<double, 4>;
  using LP = hn::FixedTag<double, 2>;
  using LV = hn::Vec<L>;
  using LXY = hn::Vec<LP>;
  using Limits = SpringMath<Arithmetic::exact>;
  static constexpr std::size_t limits_at_once = hn::MaxLanes(L());

  static std::size_t offset(std::int32_t site) { return pair_offset(site, width); }

  static HWY_INLINE void demote(LXY v, float* to) {
    const hn::FixedTag<float, 2> single;
    hn::Store(hn::DemoteTo(single, v), single, to);
  }

  template <bool first_stage>
  HWY_INLINE void springs_in_register(const Real* HWY_RESTRICT at, std::size_t s) const {
    const D d;
    V qx, qy;
    load_differences(d, at, w_.spring_ends + s, qx, qy);
    const V f =
        Math::template pull<first_stage>(d, Math::square(d, qx, qy), hn::LoadU(d, w_.stiffness + s),
                                         constants_.rate, w_.goal + s, w_.kept + Math::kept * s);
    store_pairs(d, hn::Mul(qx, f), hn::Mul(qy, f), w_.force + 2 * s);
  }

  double height_of_origin(std::size_t o) const {
    std::size_t block = 0;
    while (o >= offset(plan_.blocks[block].first + plan_.blocks[block].count)) ++block;
    return w_.origin[2 * block + 1];
  }

  // Positions of the ends a of as many springs as d has lanes minus those of b, by
  // coordinate.
  template <class T>
  static HWY_INLINE void load_differences(hn::Simd<T, 4, 0> d, const T* HWY_RESTRICT at,
                                          const SpringEnds* ends, hn::Vec<hn::Simd<T, 4, 0>>& qx,
                                          hn::Vec<hn::Simd<T, 4, 0>>& qy) {
    const hn::FixedTag<T, 2> p;
    const auto two = [&](std::size_t i, std::size_t j) {
      return hn::Sub(hn::Combine(d, hn::Load(p, at + ends[j].a), hn::Load(p, at + ends[i].a)),
                     hn::Combine(d, hn::Load(p, at + ends[j].b), hn::Load(p, at + ends[i].b)));
    };
    if constexpr (sizeof(T) == sizeof(double)) {  // whose vectors have halves of their own
      const auto even = two(0, 2);
      const auto odd = two(1, 3);
      qx = hn::InterleaveLower(d, even, odd);
      qy = hn::InterleaveUpper(d, even, odd);
    } else {
      const auto low = two(0, 1);
      const auto high = two(2, 3);
      qx = hn::ConcatEven(d, high, low);
      qy = hn::ConcatOdd(d, high, low);
    }
  }
  static HWY_INLINE void load_differences(hn::FixedTag<double, 2> d, const double* HWY_RESTRICT at,
                                          const SpringEnds* ends, LXY& qx, LXY& qy) {
    const LXY even = hn::Sub(hn::Load(d, at + ends[0].a), hn::Load(d, at + ends[0].b));
    const LXY odd = hn::Sub(hn::Load(d, at + ends[1].a), hn::Load(d, at + ends[1].b));
    qx = hn::InterleaveLower(d, even, odd);
    qy = hn::InterleaveUpper(d, even, odd);
  }

  // The inverse: x and y of each spring side by side.
  template <class D_, class T = hn::TFromD<D_>>
  static HWY_INLINE void store_pairs(D_ d, hn::Vec<D_> x, hn::Vec<D_> y, T* HWY_RESTRICT to) {
    const auto even = hn::InterleaveLower(d, x, y);
    const auto odd = hn::InterleaveUpper(d, x, y);
    if constexpr (hn::MaxLanes(D_()) * sizeof(T) > 16) {
      const hn::Half<D_> p;
      hn::Store(hn::LowerHalf(p, even), p, to);
      hn::Store(hn::LowerHalf(p, odd), p, to + 2);
      hn::Store(hn::UpperHalf(p, even), p, to + 4);
      hn::Store(hn::UpperHalf(p, odd), p, to + 6);
    } else {
      hn::Store(even, d, to);
      hn::Store(odd, d, to + hn::MaxLanes(D_()));
    }
  }

  HWY_NOINLINE XY with_floor(double y, XY v, XY f) const {
    const P p;
    HWY_ALIGN Real stored[2];
    hn::Store(f, p, stored);
    double force[2] = {stored[0], stored[1]};
    AddFloor(physics_, y, hn::GetLane(v), force[0], force[1]);
    stored[0] = static_cast<Real>(force[0]);
    stored[1] = static_cast<Real>(force[1]);
    return hn::Load(p, stored);
  }

  const Plan& plan_;
  const Physics& physics_;
  Constants<Real> constants_;
  Arrays<arithmetic> w_;
  double gravity_[2];
  bool near_floor_;
};

#endif  // vectors

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
