// The kernel for environments in the lanes of vectors (see kernels.cpp). Included
// once per instruction set (see Highway's "-inl.h" files).

#if defined(LIBEVO_SIM_SIDE_BY_SIDE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_SIM_SIDE_BY_SIDE_INL_H_
#undef LIBEVO_SIM_SIDE_BY_SIDE_INL_H_
#else
#define LIBEVO_SIM_SIDE_BY_SIDE_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "libevo/sim/arithmetic-inl.h"
#include "libevo/sim/exact-inl.h"
#include "libevo/sim/integrate-inl.h"
#include "libevo/sim/plan.h"
#include "libevo/sim/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Who computes roots and quotients in exact arithmetic: the divider alone, or the
// multipliers two of three.
enum class Divider { alone, helped };

template <Arithmetic arithmetic_, std::size_t most_lanes, Divider divider = Divider::alone>
class SideBySide {
 public:
  static constexpr Arithmetic arithmetic = arithmetic_;
  using Math = SpringMath<arithmetic>;
  using Real = StageReal<arithmetic>;
  using D = hn::CappedTag<Real, most_lanes>;  // vectors of the stages
  using V = hn::Vec<D>;
  static constexpr std::size_t width = hn::MaxLanes(D());

  SideBySide(const Plan& plan, const Physics& physics, const Arrays<arithmetic>& arrays,
             bool near_floor)
      : plan_(plan), physics_(physics), constants_(physics), w_(arrays), near_floor_(near_floor) {}

  // The record of a spring in Arrays::force: what SpringMath keeps, its force.
  static constexpr std::size_t force_offset = Math::kept * width;
  static constexpr std::size_t force_record = force_offset + 2 * width;

  // How many springs `springs` computes, and how many points then follow.
  static constexpr std::size_t springs_at_once = 3;
  static constexpr std::size_t points_at_once = 1;
  static constexpr bool points_follow = true;
  static constexpr std::size_t record_points = 1;
  static constexpr std::size_t dealt_springs = 1;

  // Fast arithmetic: before the substeps of a control step, the origin of a block.
  void choose_origin(std::size_t block) const {
    for (std::size_t k = 0; k < 2 * width; ++k) {
      const auto range = range_of(w_.position + k, plan_.blocks[block]);
      w_.origin[2 * width * block + k] = 0.5 * (range.first + range.second);
    }
  }

  // Fast arithmetic: where a point starts, relative to its origin.
  HWY_INLINE void store_start(std::int32_t site, std::size_t block) const {
    const L l;
    const std::size_t o = offset(site);
    for (std::size_t k = 0; k < 2 * width; k += part)
      demote(
          hn::Sub(hn::Load(l, w_.position + o + k), hn::Load(l, w_.origin + 2 * width * block + k)),
          w_.start + o + k);
  }

  // Fast arithmetic: velocity and load that a point starts a substep with.
  HWY_INLINE void store_motion(std::size_t i) const {
    const L l;
    const std::size_t o = w_.point_offsets[i];
    const double* motion = w_.motion + record(i, Motion::pairs(arithmetic));
    float* stage_motion = w_.stage_motion + record(i, StageMotion::pairs);
    for (std::size_t k = 0; k < 2 * width; k += part) {
      const LV gravity = hn::Set(l, k < width ? 0.0 : constants_.gravity);
      const LV contact = hn::Load(l, w_.contact + o + k);
      demote(hn::Load(l, motion + Motion::velocity * width + k),
             stage_motion + StageMotion::velocity_of(1) * width + k);
      demote(hn::Sub(contact, gravity), stage_motion + StageMotion::load * width + k);
    }
  }

  // Whether a point may get below the floor within the substep, in any lane.
  HWY_INLINE bool is_near_floor(std::size_t o) const {
    const L l;
    LV y = hn::Load(l, w_.position + o + width);
    for (std::size_t h = part; h < width; h += part)
      y = hn::Min(y, hn::Load(l, w_.position + o + width + h));
    return !hn::AllTrue(l, hn::Gt(y, hn::Set(l, constants_.floor_reach)));
  }

  // Forces of springs s, s+1, .. at the given positions. In the first stage the
  // rest length of the substep is found as well.
  template <bool first_stage>
  HWY_INLINE void springs(const Real* HWY_RESTRICT at, std::size_t s) const {
#if HWY_NATIVE_FMA
    if constexpr (arithmetic == Arithmetic::exact && divider == Divider::helped) {
      spring<first_stage>(at, s);
      two_springs<first_stage>(at, s + 1);
      return;
    }
#endif
    for (std::size_t i = 0; i < springs_at_once; ++i) spring<first_stage>(at, s + i);
  }

  // Those after the last full `springs`.
  template <bool first_stage>
  void last_springs(const Real* HWY_RESTRICT at, std::size_t s, std::size_t end) const {
    for (; s < end; ++s) spring<first_stage>(at, s);
  }

  // Gathers the forces of the i-th point, positions being `at`, and does its part of a
  // Runge-Kutta stage; `next` is where the next stage, or substep, evaluates; `end` is
  // the list of its forces.
  template <int stage, class Next>
  HWY_INLINE void point(std::size_t i, const std::uint32_t* HWY_RESTRICT end, int a_ends,
                        int b_ends, const Real* HWY_RESTRICT at, Next* HWY_RESTRICT next) const {
    const D d;
    V fx = SumForces<arithmetic>(d, w_.force, end, a_ends, b_ends);
    V fy = SumForces<arithmetic>(d, w_.force + width, end, a_ends, b_ends);
    const std::size_t o = w_.point_offsets[i];
    double* HWY_RESTRICT motion = w_.motion + record(i, Motion::pairs(arithmetic));
    const double dt = constants_.substep;
    const V drag = hn::Set(d, constants_.drag);
    if constexpr (arithmetic == Arithmetic::exact) {
      const double* velocity =
          motion + (stage == 1 ? Motion::velocity : Motion::stage_velocity) * width;
      const V vx = hn::Load(d, velocity);
      const V vy = hn::Load(d, velocity + width);
      const double* contact = w_.contact + o;
      fx = hn::Add(hn::Sub(fx, hn::Mul(drag, vx)), hn::Load(d, contact));
      fy = hn::Sub(hn::Sub(fy, hn::Mul(drag, vy)), hn::Set(d, constants_.gravity));
      fy = hn::Add(fy, hn::Load(d, contact + width));
      const V y = hn::Load(d, at + o + width);
      if (HWY_UNLIKELY(!hn::AllFalse(d, hn::Lt(y, hn::Zero(d))))) add_floor(o, at, vx, fx, fy);
      AdvanceExactly<stage, width>(d, vx, fx, dt, w_.position + o, next + o, motion);
      AdvanceExactly<stage, width>(d, vy, fy, dt, w_.position + o + width, next + o + width,
                                   motion + width);
    } else {
      float* HWY_RESTRICT stages = w_.stage_motion + record(i, StageMotion::pairs);
      const float* velocity = stages + StageMotion::velocity_of(stage) * width;
      const V vx = hn::Load(d, velocity);
      const V vy = hn::Load(d, velocity + width);
      const float* load = stages + StageMotion::load * width;
      fx = hn::NegMulAdd(drag, vx, hn::Add(fx, hn::Load(d, load)));
      fy = hn::NegMulAdd(drag, vy, hn::Add(fy, hn::Load(d, load + width)));
      if (HWY_UNLIKELY(near_floor_) && is_near_floor(o)) add_floor(o, at, vx, fx, fy);
      if constexpr (stage < 4) {
        AdvanceFast<stage, width>(d, vx, fx, dt, w_.start + o, next + o, stages);
        AdvanceFast<stage, width>(d, vy, fy, dt, w_.start + o + width, next + o + width,
                                  stages + width);
      } else {
        const Rise<V> x = RiseOf<width>(d, vx, fx, dt, stages);
        const Rise<V> y = RiseOf<width>(d, vy, fy, dt, stages + width);
        double* velocity = motion + Motion::velocity * width;
        AddRise(d, x, w_.position + o, velocity, next + o);
        AddRise(d, y, w_.position + o + width, velocity + width, next + o + width);
      }
    }
  }

  // The same for points_at_once regular points.
  template <int stage, class Next>
  HWY_INLINE void points(std::size_t i, const std::uint32_t* HWY_RESTRICT end,
                         const Real* HWY_RESTRICT at, Next* HWY_RESTRICT next) const {
    point<stage>(i, end, Plan::regular_ends, Plan::regular_ends, at, next);
  }

  void limit_strain(double* HWY_RESTRICT at) const {
    for (std::size_t h = 0; h < width; h += part) limit_strain_of(at + h);
  }

  void limit_rigid_strain(double* HWY_RESTRICT at) const {
    for (std::size_t h = 0; h < width; h += part) limit_rigid_strain_of(at + h);
  }

  // Adds the last substep to the travel of all blocks.
  void add_travel() const {
    const L l;
    for (std::size_t h = 0; h < width; h += part) {
      LV fastest = hn::Zero(l);
      for (std::size_t block = 0; block < plan_.blocks.size(); ++block) {
        const PlanBlock& sites = plan_.blocks[block];
        LV farthest = hn::Zero(l);
        for (int site = sites.first; site < sites.first + sites.integrated; ++site)
          farthest = hn::Max(farthest, square_way(site, w_.previous, h));
        fastest = hn::Max(fastest, farthest);
        add_root(farthest, w_.travel + block * width + h);
      }
      add_root(fastest, w_.travel + (plan_.blocks.size() + 1) * width + h);
    }
  }

  // Square of the longest way that a point of any block has moved from the
  // listing, one value per lane.
  void square_moved(double* HWY_RESTRICT result) const {
    const L l;
    for (std::size_t h = 0; h < width; h += part) {
      LV farthest = hn::Zero(l);
      for (const PlanBlock& block : plan_.blocks)
        for (int site = block.first; site < block.first + block.integrated; ++site)
          farthest = hn::Max(farthest, square_way(site, w_.pair_listing, h));
      hn::Store(farthest, l, result + h);
    }
  }

  // A bound of the square of how far two points of a block have moved relative
  // to each other, one value per lane.
  void square_sheared(const PlanBlock& block, double* HWY_RESTRICT result) const {
    const L l;
    // Held points have not moved at all.
    const double start = block.integrated < block.count ? 0.0 : HUGE_VAL;
    for (std::size_t h = 0; h < width; h += part) {
      LV low_x = hn::Set(l, start);
      LV low_y = low_x;
      LV high_x = hn::Set(l, -start);
      LV high_y = high_x;
      for (int site = block.first; site < block.first + block.integrated; ++site) {
        const LV dx = way(offset(site) + h, w_.self_listing);
        const LV dy = way(offset(site) + width + h, w_.self_listing);
        low_x = hn::Min(low_x, dx);
        low_y = hn::Min(low_y, dy);
        high_x = hn::Max(high_x, dx);
        high_y = hn::Max(high_y, dy);
      }
      const LV x = hn::Sub(high_x, low_x);
      const LV y = hn::Sub(high_y, low_y);
      hn::Store(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), l, result + h);
    }
  }

 private:
  // Between the stages everything is double: vectors of as many of the lanes.
  using L = hn::CappedTag<double, width>;
  using LV = hn::Vec<L>;
  using Limits = SpringMath<Arithmetic::exact>;
  static constexpr std::size_t part = hn::MaxLanes(L());

  static std::size_t offset(std::int32_t site) { return pair_offset(site, width); }
  static std::size_t record(std::size_t point, std::size_t pairs) {
    return record_offset<width, record_points>(point, pairs);
  }

  // How far a coordinate has come since it was at `from`.
  HWY_INLINE LV way(std::size_t o, const double* from) const {
    const L l;
    return hn::Sub(hn::Load(l, w_.position + o), hn::Load(l, from + o));
  }
  HWY_INLINE LV square_way(std::int32_t site, const double* from, std::size_t h) const {
    const LV dx = way(offset(site) + h, from);
    const LV dy = way(offset(site) + width + h, from);
    return hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
  }

  static HWY_INLINE void add_root(LV square, double* to) {
    const L l;
    hn::Store(hn::Add(hn::Load(l, to), hn::Sqrt(square)), l, to);
  }

  // Least and greatest of one coordinate of a block in one lane.
  static std::pair<double, double> range_of(const double* coordinate, const PlanBlock& block) {
    std::pair<double, double> range{HUGE_VAL, -HUGE_VAL};
    for (int site = block.first; site < block.first + block.count; ++site) {
      range.first = std::min(range.first, coordinate[offset(site)]);
      range.second = std::max(range.second, coordinate[offset(site)]);
    }
    return range;
  }

  static HWY_INLINE void demote(LV v, float* to) {
    const hn::Rebind<float, L> single;
    hn::Store(hn::DemoteTo(single, v), single, to);
  }

  HWY_INLINE void load_difference(const Real* HWY_RESTRICT at, const SpringEnds& ends, V& qx,
                                  V& qy) const {
    const D d;
    qx = hn::Sub(hn::Load(d, at + ends.a), hn::Load(d, at + ends.b));
    qy = hn::Sub(hn::Load(d, at + ends.a + width), hn::Load(d, at + ends.b + width));
  }

  HWY_INLINE void store_force(std::size_t s, V x, V y) const {
    const D d;
    Real* const force = w_.force + s * force_record + force_offset;
    hn::Store(x, d, force);
    hn::Store(y, d, force + width);
  }

  template <bool first_stage>
  HWY_INLINE void spring(const Real* HWY_RESTRICT at, std::size_t s) const {
    V qx, qy;
    load_difference(at, w_.spring_ends[s], qx, qy);
    const D d;
    const V f = Math::template pull<first_stage>(d, Math::square(d, qx, qy),
                                                 hn::Set(d, w_.stiffness[s]), constants_.rate,
                                                 w_.goal + s * width, w_.force + s * force_record);
    store_force(s, hn::Mul(qx, f), hn::Mul(qy, f));
  }

#if HWY_NATIVE_FMA
  template <bool first_stage>
  HWY_INLINE void two_springs(const double* HWY_RESTRICT at, std::size_t s) const {
    const D d;
    V qx[2], qy[2], square[2], length[2], reciprocal[2], pull[2], f[2];
    for (std::size_t i = 0; i < 2; ++i) {
      load_difference(at, w_.spring_ends[s + i], qx[i], qy[i]);
      square[i] = Math::square(d, qx[i], qy[i]);
    }
    RootsOf(d, square, length, reciprocal);
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t n = s + i;
      pull[i] = Math::template tension<first_stage>(d, length[i], hn::Set(d, w_.stiffness[n]),
                                                    constants_.rate, w_.goal + n * width,
                                                    w_.force + n * force_record);
    }
    if (HWY_UNLIKELY(!AreOrdinary(d, square, pull, length))) {
      spring<first_stage>(at, s);
      spring<first_stage>(at, s + 1);
      return;
    }
    QuotientsOf(d, pull, length, reciprocal, f);
    for (std::size_t i = 0; i < 2; ++i)
      store_force(s + i, hn::Mul(qx[i], f[i]), hn::Mul(qy[i], f[i]));
  }
#endif

  // Adds the force of the floor to a point where its lanes are below it.
  HWY_NOINLINE void add_floor(std::size_t o, const Real* at, V vx, V& fx, V& fy) const {
    const D d;
    HWY_ALIGN Real vs[width], fxs[width], fys[width];
    hn::Store(vx, d, vs);
    hn::Store(fx, d, fxs);
    hn::Store(fy, d, fys);
    for (std::size_t i = 0; i < width; ++i) {
      double y = at[o + width + i];
      if constexpr (arithmetic == Arithmetic::fast) y += height_of_origin(o, i);
      if (!(y < 0.0)) continue;
      double x_force = fxs[i];
      double y_force = fys[i];
      AddFloor(physics_, y, vs[i], x_force, y_force);
      fxs[i] = static_cast<Real>(x_force);
      fys[i] = static_cast<Real>(y_force);
    }
    fx = hn::Load(d, fxs);
    fy = hn::Load(d, fys);
  }

  double height_of_origin(std::size_t o, std::size_t lane) const {
    std::size_t block = 0;
    while (o >= offset(plan_.blocks[block].first + plan_.blocks[block].count)) ++block;
    return w_.origin[2 * width * block + width + lane];
  }

  // The lanes from `at` on, as many as L has.
  HWY_INLINE void limit_strain_of(double* HWY_RESTRICT at) const {
    const L l;
    std::size_t count = 0;
    const Plan::Strain& strain = plan_.strain;
    const std::size_t live = strain.springs;
    for (std::size_t s = 0; s < live; ++s) {
      const SpringEnds& ends = w_.strain_ends[s];
      const LV qx = hn::Sub(hn::Load(l, at + ends.a), hn::Load(l, at + ends.b));
      const LV qy = hn::Sub(hn::Load(l, at + ends.a + width), hn::Load(l, at + ends.b + width));
      const LV square = Limits::square(l, qx, qy);
      const auto long_ones = hn::Gt(square, hn::Set(l, strain.longest_square[s]));
      const auto beyond = hn::Or(long_ones, hn::Lt(square, hn::Set(l, strain.shortest_square[s])));
      if (HWY_LIKELY(hn::AllFalse(l, beyond))) continue;
      const LV c = correction(square, long_ones, beyond, strain.limits[s]);
      const LV share = hn::Set(l, constants_.correction);
      hn::Store(hn::Mul(hn::Mul(qx, c), share), l, w_.correction + 2 * count * part);
      hn::Store(hn::Mul(hn::Mul(qy, c), share), l, w_.correction + 2 * count * part + part);
      w_.corrected[count++] = static_cast<std::int32_t>(s);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(w_.corrected[i]);
      if (strain.a_free[s]) add<-1>(at + w_.strain_ends[s].a, w_.correction + 2 * i * part);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(w_.corrected[i]);
      if (strain.b_free[s]) add<+1>(at + w_.strain_ends[s].b, w_.correction + 2 * i * part);
    }
  }

  HWY_INLINE void limit_rigid_strain_of(double* HWY_RESTRICT at) const {
    const L l;
    const LV share = hn::Set(l, constants_.rigid_correction);
    for (const auto& [edge_a, edge_b, limit] : plan_.rigid_edges) {
      double* a = at + offset(edge_a);
      double* b = at + offset(edge_b);
      const LV ax = hn::Load(l, a);
      const LV ay = hn::Load(l, a + width);
      const LV bx = hn::Load(l, b);
      const LV by = hn::Load(l, b + width);
      const LV qx = hn::Sub(ax, bx);
      const LV qy = hn::Sub(ay, by);
      const LV square = Limits::square(l, qx, qy);
      const auto long_ones = hn::Gt(square, hn::Set(l, limit.longest_square));
      const auto beyond = hn::Or(long_ones, hn::Lt(square, hn::Set(l, limit.shortest_square)));
      if (HWY_LIKELY(hn::AllFalse(l, beyond))) continue;
      const LV c = correction(square, long_ones, beyond, limit);
      const LV cx = hn::Mul(hn::Mul(qx, c), share);
      const LV cy = hn::Mul(hn::Mul(qy, c), share);
      hn::Store(hn::Sub(ax, cx), l, a);
      hn::Store(hn::Sub(ay, cy), l, a + width);
      hn::Store(hn::Add(bx, cx), l, b);
      hn::Store(hn::Add(by, cy), l, b + width);
    }
  }

  // The factor of q that brings a spring back to its limit; 0 in lanes within.
  static HWY_INLINE LV correction(LV square, hn::Mask<L> long_ones, hn::Mask<L> beyond,
                                  const StrainLimit& limit) {
    const L l;
    const LV target =
        hn::IfThenElse(long_ones, hn::Set(l, limit.longest), hn::Set(l, limit.shortest));
    return hn::IfThenElseZero(beyond, Limits::correction(l, square, target));
  }

  template <int sign>
  static HWY_INLINE void add(double* HWY_RESTRICT to, const double* HWY_RESTRICT c) {
    const L l;
    const LV x = hn::Load(l, to);
    const LV y = hn::Load(l, to + width);
    const LV cx = hn::Load(l, c);
    const LV cy = hn::Load(l, c + part);
    hn::Store(sign > 0 ? hn::Add(x, cx) : hn::Sub(x, cx), l, to);
    hn::Store(sign > 0 ? hn::Add(y, cy) : hn::Sub(y, cy), l, to + width);
  }

  const Plan& plan_;
  const Physics& physics_;
  Constants<Real> constants_;
  Arrays<arithmetic> w_;
  bool near_floor_;
};

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
