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

#include "libevo/sim/arithmetic-inl.h"
#include "libevo/sim/plan.h"
#include "libevo/sim/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Who computes roots and quotients: the divider alone, or the multipliers two of three.
enum class Divider { alone, helped };

template <Divider divider>
class SideBySide {
 public:
  using D = hn::ScalableTag<double>;
  using V = hn::Vec<D>;
  static constexpr std::size_t width = hn::MaxLanes(D());

  SideBySide(const Plan& plan, const Physics& physics, const Arrays& arrays)
      : plan_(plan), physics_(physics), constants_(physics), w_(arrays) {}

  // The record of a spring in Arrays::force: its rest length in this substep, its force.
  static constexpr std::size_t force_offset = width;
  static constexpr std::size_t force_record = force_offset + 2 * width;

  // How many springs `springs` computes, and how many points then follow.
  static constexpr std::size_t springs_at_once = 3;
  static constexpr std::size_t points_at_once = 1;
  static constexpr bool points_follow = true;
  static constexpr std::size_t record_points = 1;
  static constexpr std::size_t dealt_springs = 1;

  // Forces of springs s, s+1, .. at the given positions. In the first stage the
  // rest length of the substep is found as well.
  template <bool first_stage>
  HWY_INLINE void springs(const double* HWY_RESTRICT at, std::size_t s) const {
#if HWY_NATIVE_FMA
    if constexpr (divider == Divider::helped) {
      spring<first_stage>(at, s);
      two_springs<first_stage>(at, s + 1);
      return;
    }
#endif
    for (std::size_t i = 0; i < springs_at_once; ++i) spring<first_stage>(at, s + i);
  }

  // Those after the last full `springs`.
  template <bool first_stage>
  void last_springs(const double* HWY_RESTRICT at, std::size_t s, std::size_t end) const {
    for (; s < end; ++s) spring<first_stage>(at, s);
  }

  // Gathers the forces of the i-th point, positions being `at`, and does its part of a
  // Runge-Kutta stage; `next` is where the next stage, or substep, evaluates; `end` is
  // the list of its forces.
  template <int stage>
  HWY_INLINE void point(std::size_t i, const std::uint32_t* HWY_RESTRICT end, int a_ends,
                        int b_ends, const double* HWY_RESTRICT at,
                        double* HWY_RESTRICT next) const {
    const D d;
    V fx = SumForces(d, w_.force, end, a_ends, b_ends);
    V fy = SumForces(d, w_.force + width, end, a_ends, b_ends);
    const std::size_t o = w_.point_offsets[i];
    double* HWY_RESTRICT motion = w_.motion + record_offset<width, record_points>(i);
    const double dt = constants_.substep;
    const V drag = hn::Set(d, constants_.drag);
    const double* velocity =
        motion + (stage == 1 ? Motion::velocity : Motion::stage_velocity) * width;
    const V vx = hn::Load(d, velocity);
    const V vy = hn::Load(d, velocity + width);
    const double* contact = w_.contact + o;
    fx = hn::Add(hn::Sub(fx, hn::Mul(drag, vx)), hn::Load(d, contact));
    fy = hn::Sub(hn::Sub(fy, hn::Mul(drag, vy)), hn::Set(d, constants_.gravity));
    fy = hn::Add(fy, hn::Load(d, contact + width));
    const V y = hn::Load(d, at + o + width);
    if (HWY_UNLIKELY(!hn::AllFalse(d, hn::Lt(y, hn::Zero(d))))) add_floor(y, vx, fx, fy);
    Advance<stage, width>(d, vx, fx, dt, w_.position + o, next + o, motion);
    Advance<stage, width>(d, vy, fy, dt, w_.position + o + width, next + o + width, motion + width);
  }

  // The same for points_at_once regular points.
  template <int stage>
  HWY_INLINE void points(std::size_t i, const std::uint32_t* HWY_RESTRICT end,
                         const double* HWY_RESTRICT at, double* HWY_RESTRICT next) const {
    point<stage>(i, end, Plan::regular_ends, Plan::regular_ends, at, next);
  }

  void limit_strain(double* HWY_RESTRICT at) const {
    const D d;
    std::size_t count = 0;
    const Plan::Strain& strain = plan_.strain;
    const std::size_t live = strain.springs;
    for (std::size_t s = 0; s < live; ++s) {
      const SpringEnds& ends = w_.strain_ends[s];
      const V qx = hn::Sub(hn::Load(d, at + ends.a), hn::Load(d, at + ends.b));
      const V qy = hn::Sub(hn::Load(d, at + ends.a + width), hn::Load(d, at + ends.b + width));
      const V square = SquareOf(d, qx, qy);
      const auto long_ones = hn::Gt(square, hn::Set(d, strain.longest_square[s]));
      const auto beyond = hn::Or(long_ones, hn::Lt(square, hn::Set(d, strain.shortest_square[s])));
      if (HWY_LIKELY(hn::AllFalse(d, beyond))) continue;
      const V c = correction(square, long_ones, beyond, strain.limits[s]);
      const V share = hn::Set(d, constants_.correction);
      hn::Store(hn::Mul(hn::Mul(qx, c), share), d, w_.correction + 2 * count * width);
      hn::Store(hn::Mul(hn::Mul(qy, c), share), d, w_.correction + 2 * count * width + width);
      w_.corrected[count++] = static_cast<std::int32_t>(s);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(w_.corrected[i]);
      if (strain.a_free[s]) add<-1>(at + w_.strain_ends[s].a, w_.correction + 2 * i * width);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto s = static_cast<std::size_t>(w_.corrected[i]);
      if (strain.b_free[s]) add<+1>(at + w_.strain_ends[s].b, w_.correction + 2 * i * width);
    }
  }

  void limit_rigid_strain(double* HWY_RESTRICT at) const {
    const D d;
    const V share = hn::Set(d, constants_.rigid_correction);
    for (const auto& [edge_a, edge_b, limit] : plan_.rigid_edges) {
      double* a = at + offset(edge_a);
      double* b = at + offset(edge_b);
      const V ax = hn::Load(d, a);
      const V ay = hn::Load(d, a + width);
      const V bx = hn::Load(d, b);
      const V by = hn::Load(d, b + width);
      const V qx = hn::Sub(ax, bx);
      const V qy = hn::Sub(ay, by);
      const V square = SquareOf(d, qx, qy);
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

  // Adds the last substep to the travel of all blocks.
  void add_travel() const {
    const D d;
    V fastest = hn::Zero(d);
    for (std::size_t block = 0; block < plan_.blocks.size(); ++block) {
      const PlanBlock& sites = plan_.blocks[block];
      V farthest = hn::Zero(d);
      for (int site = sites.first; site < sites.first + sites.integrated; ++site)
        farthest = hn::Max(farthest, square_way(site, w_.previous));
      fastest = hn::Max(fastest, farthest);
      add_root(farthest, w_.travel + block * width);
    }
    add_root(fastest, w_.travel + (plan_.blocks.size() + 1) * width);
  }

  // Square of the longest way that a point of any block has moved from the
  // listing, one value per lane.
  void square_moved(double* HWY_RESTRICT result) const {
    const D d;
    V farthest = hn::Zero(d);
    for (const PlanBlock& block : plan_.blocks)
      for (int site = block.first; site < block.first + block.integrated; ++site)
        farthest = hn::Max(farthest, square_way(site, w_.pair_listing));
    hn::Store(farthest, d, result);
  }

  // A bound of the square of how far two points of a block have moved relative
  // to each other, one value per lane.
  void square_sheared(const PlanBlock& block, double* HWY_RESTRICT result) const {
    const D d;
    // Held points have not moved at all.
    const double start = block.integrated < block.count ? 0.0 : HUGE_VAL;
    V low_x = hn::Set(d, start);
    V low_y = low_x;
    V high_x = hn::Set(d, -start);
    V high_y = high_x;
    for (int site = block.first; site < block.first + block.integrated; ++site) {
      const V dx = way(offset(site), w_.self_listing);
      const V dy = way(offset(site) + width, w_.self_listing);
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
  static std::size_t offset(std::int32_t site) { return pair_offset(site, width); }

  // How far a coordinate has come since it was at `from`.
  HWY_INLINE V way(std::size_t o, const double* from) const {
    const D d;
    return hn::Sub(hn::Load(d, w_.position + o), hn::Load(d, from + o));
  }
  HWY_INLINE V square_way(std::int32_t site, const double* from) const {
    const V dx = way(offset(site), from);
    const V dy = way(offset(site) + width, from);
    return hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
  }

  static HWY_INLINE void add_root(V square, double* to) {
    const D d;
    hn::Store(hn::Add(hn::Load(d, to), hn::Sqrt(square)), d, to);
  }

  HWY_INLINE void load_difference(const double* HWY_RESTRICT at, const SpringEnds& ends, V& qx,
                                  V& qy) const {
    const D d;
    qx = hn::Sub(hn::Load(d, at + ends.a), hn::Load(d, at + ends.b));
    qy = hn::Sub(hn::Load(d, at + ends.a + width), hn::Load(d, at + ends.b + width));
  }

  HWY_INLINE void store_force(std::size_t s, V x, V y) const {
    const D d;
    double* const force = w_.force + s * force_record + force_offset;
    hn::Store(x, d, force);
    hn::Store(y, d, force + width);
  }

  template <bool first_stage>
  HWY_INLINE void spring(const double* HWY_RESTRICT at, std::size_t s) const {
    V qx, qy;
    load_difference(at, w_.spring_ends[s], qx, qy);
    const D d;
    const V f =
        PullOf<first_stage>(d, SquareOf(d, qx, qy), hn::Set(d, w_.stiffness[s]), constants_.rate,
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
      square[i] = SquareOf(d, qx[i], qy[i]);
    }
    RootsOf(d, square, length, reciprocal);
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t n = s + i;
      pull[i] = TensionOf<first_stage>(d, length[i], hn::Set(d, w_.stiffness[n]), constants_.rate,
                                       w_.goal + n * width, w_.force + n * force_record);
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
  static HWY_INLINE V correction(V square, hn::Mask<D> long_ones, hn::Mask<D> beyond,
                                 const StrainLimit& limit) {
    const D d;
    const V target =
        hn::IfThenElse(long_ones, hn::Set(d, limit.longest), hn::Set(d, limit.shortest));
    return hn::IfThenElseZero(beyond, CorrectionOf(d, square, target));
  }

  template <int sign>
  static HWY_INLINE void add(double* HWY_RESTRICT to, const double* HWY_RESTRICT c) {
    const D d;
    const V x = hn::Load(d, to);
    const V y = hn::Load(d, to + width);
    const V cx = hn::Load(d, c);
    const V cy = hn::Load(d, c + width);
    hn::Store(sign > 0 ? hn::Add(x, cx) : hn::Sub(x, cx), d, to);
    hn::Store(sign > 0 ? hn::Add(y, cy) : hn::Sub(y, cy), d, to + width);
  }

  const Plan& plan_;
  const Physics& physics_;
  Constants constants_;
  Arrays w_;
};

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
