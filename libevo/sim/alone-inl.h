// The kernel for one environment, its springs and points in the lanes of vectors (see
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
#include "libevo/sim/plan.h"
#include "libevo/sim/workspace.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR

// Springs in the lanes of a vector; of points, x and y of neighbours side by side.
template <std::size_t most_lanes>
class Alone {
 public:
  using D = hn::CappedTag<double, most_lanes>;  // springs, or pairs of points
  using P = hn::FixedTag<double, 2>;            // one point: x, y
  using V = hn::Vec<D>;
  using XY = hn::Vec<P>;
  static constexpr std::size_t width = 1;
  static constexpr std::size_t dealt_springs = hn::MaxLanes(D());
  static constexpr std::size_t record_points = hn::MaxLanes(D()) / 2;
  // Two registers where roots and quotients take long, so that more of them are under
  // way at a time; but no more springs than Plan pads to.
  static constexpr std::size_t springs_at_once =
      std::min<std::size_t>(2 * hn::MaxLanes(D()), Plan::spring_padding);
  static constexpr std::size_t points_at_once = record_points;
  static constexpr bool points_follow = false;  // neighbours fill registers as it is

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
    for (std::size_t i = 0; i < springs_at_once; i += in_register)
      springs_in_register<first_stage>(at, s + i);
  }

  template <bool first_stage>
  void last_springs(const double* HWY_RESTRICT at, std::size_t s, std::size_t end) const {
    for (; s < end; s += in_register) springs_in_register<first_stage>(at, s);
  }

  template <int stage>
  HWY_INLINE void point(std::size_t i, const std::uint32_t* HWY_RESTRICT end, int a_ends,
                        int b_ends, const double* HWY_RESTRICT at,
                        double* HWY_RESTRICT next) const {
    const P p;
    advance<stage>(p, i, SumForces(p, w_.force, end, a_ends, b_ends), at, next);
  }

  // Points of a record are neighbours, but where points between them are not integrated.
  template <int stage>
  HWY_INLINE void points(std::size_t i, const std::uint32_t* HWY_RESTRICT end,
                         const double* HWY_RESTRICT at, double* HWY_RESTRICT next) const {
    constexpr int few = Plan::regular_ends;
    constexpr std::size_t last = record_points - 1;
    if (HWY_UNLIKELY(w_.point_offsets[i + last] - w_.point_offsets[i] != 2 * last)) {
      for (std::size_t k = 0; k <= last; ++k)
        point<stage>(i + k, end + ends_a_point * k, few, few, at, next);
      return;
    }
    XY forces[record_points];
    for (std::size_t k = 0; k <= last; ++k)
      forces[k] = SumForces(P(), w_.force, end + ends_a_point * k, few, few);
    advance<stage>(D(), i, joined(D(), forces), at, next);
  }

  void limit_strain(double* HWY_RESTRICT at) const {
    const D d;
    const P p;
    std::size_t count = 0;
    const Plan::Strain& strain = plan_.strain;
    const std::size_t live = strain.springs;
    HWY_ALIGN double pairs[2 * in_register];
    for (std::size_t s = 0; s < live; s += in_register) {
      V qx, qy;
      load_differences(at, w_.strain_ends + s, qx, qy);
      const V square = SquareOf(d, qx, qy);
      const auto long_ones = hn::Gt(square, hn::LoadU(d, strain.longest_square.data() + s));
      const auto beyond =
          hn::Or(long_ones, hn::Lt(square, hn::LoadU(d, strain.shortest_square.data() + s)));
      if (HWY_LIKELY(hn::AllFalse(d, beyond))) continue;
      HWY_ALIGN double squares[in_register];
      HWY_ALIGN double targets[in_register];
      hn::Store(square, d, squares);
      for (std::size_t i = 0; i < in_register; ++i) {
        const StrainLimit& limit = strain.limits[s + i];
        targets[i] = squares[i] > limit.longest_square ? limit.longest : limit.shortest;
      }
      const V c = CorrectionOf(d, square, V(hn::Load(d, targets)));
      const V share = hn::Set(d, constants_.correction);
      store_pairs(hn::Mul(hn::Mul(qx, c), share), hn::Mul(hn::Mul(qy, c), share), pairs);
      for (std::size_t i = 0; i < in_register && s + i < live; ++i) {
        const StrainLimit& limit = strain.limits[s + i];
        if (!(squares[i] > limit.longest_square || squares[i] < limit.shortest_square)) continue;
        hn::Store(hn::Load(p, pairs + 2 * place_of_force(i, in_register)), p,
                  w_.correction + 2 * count);
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
      const auto lane = SquareOf(one, hn::Set(one, qx), hn::Set(one, qy));
      const double square = hn::GetLane(lane);
      const bool too_long = square > limit.longest_square;
      if (HWY_LIKELY(!too_long && !(square < limit.shortest_square))) continue;
      const auto target = hn::Set(one, too_long ? limit.longest : limit.shortest);
      const double c = hn::GetLane(CorrectionOf(one, lane, target));
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
      const PlanBlock& sites = plan_.blocks[block];
      XY farthest = hn::Zero(p);
      for (int site = sites.first; site < sites.first + sites.integrated; ++site) {
        const XY d = hn::Sub(hn::Load(p, w_.position + offset(site)),
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
    const P p;
    XY farthest = hn::Zero(p);
    for (const PlanBlock& block : plan_.blocks) {
      for (int site = block.first; site < block.first + block.integrated; ++site) {
        const XY d = hn::Sub(hn::Load(p, w_.position + offset(site)),
                             hn::Load(p, w_.pair_listing + offset(site)));
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
    for (int site = block.first; site < block.first + block.integrated; ++site) {
      const XY d = hn::Sub(hn::Load(p, w_.position + offset(site)),
                           hn::Load(p, w_.self_listing + offset(site)));
      low = hn::Min(low, d);
      high = hn::Max(high, d);
    }
    const XY range = hn::Sub(high, low);
    *result = hn::GetLane(hn::SumOfLanes(p, hn::Mul(range, range)));
  }

 private:
  static constexpr std::size_t in_register = hn::MaxLanes(D());
  static constexpr std::size_t ends_a_point = 2UL * Plan::regular_ends;

  static std::size_t offset(std::int32_t site) { return pair_offset(site, width); }

  template <bool first_stage>
  HWY_INLINE void springs_in_register(const double* HWY_RESTRICT at, std::size_t s) const {
    const D d;
    V qx, qy;
    load_differences(at, w_.spring_ends + s, qx, qy);
    const V f = PullOf<first_stage>(d, SquareOf(d, qx, qy), V(hn::LoadU(d, w_.stiffness + s)),
                                    constants_.rate, w_.goal + s, w_.kept + s);
    store_pairs(hn::Mul(qx, f), hn::Mul(qy, f), w_.force + 2 * s);
  }

  // A register of pairs.
  template <class D_>
  static HWY_INLINE hn::Vec<D_> joined(D_ d, const XY* pairs) {
    if constexpr (hn::MaxLanes(D_()) == 2) {
      return pairs[0];
    } else {
      const hn::Half<D_> half;
      return hn::Combine(d, joined(half, pairs + hn::MaxLanes(half) / 2), joined(half, pairs));
    }
  }

  // The even lanes of two registers in turn, and the odd ones: pairs of even and of odd
  // springs to x and y of all, and back.
  static HWY_INLINE void exchange(V& even, V& odd) {
    const D d;
    const V first = hn::InterleaveLower(d, even, odd);
    odd = hn::InterleaveUpper(d, even, odd);
    even = first;
  }

  // Positions of the ends a of a register of springs minus those of b, by coordinate.
  static HWY_INLINE void load_differences(const double* HWY_RESTRICT at, const SpringEnds* ends,
                                          V& qx, V& qy) {
    const P p;
    const D d;
    constexpr std::size_t half = in_register / 2;
    XY even_a[half], even_b[half], odd_a[half], odd_b[half];
    for (std::size_t i = 0; i < half; ++i) {
      even_a[i] = hn::Load(p, at + ends[2 * i].a);
      even_b[i] = hn::Load(p, at + ends[2 * i].b);
      odd_a[i] = hn::Load(p, at + ends[2 * i + 1].a);
      odd_b[i] = hn::Load(p, at + ends[2 * i + 1].b);
    }
    qx = hn::Sub(joined(d, even_a), joined(d, even_b));
    qy = hn::Sub(joined(d, odd_a), joined(d, odd_b));
    exchange(qx, qy);
  }

  // The inverse, in the order of place_of_force.
  static HWY_INLINE void store_pairs(V x, V y, double* HWY_RESTRICT to) {
    const D d;
    exchange(x, y);
    hn::Store(x, d, to);
    hn::Store(y, d, to + in_register);
  }

  // Takes the i-th point, or as many from there on as D_ has pairs of lanes, through a
  // stage. The force on them is that of their springs.
  template <int stage, class D_>
  HWY_INLINE void advance(D_ d, std::size_t i, hn::Vec<D_> f, const double* HWY_RESTRICT at,
                          double* HWY_RESTRICT next) const {
    const std::size_t o = w_.point_offsets[i];
    double* HWY_RESTRICT motion = w_.motion + record_offset<width, record_points>(i);
    const auto v = hn::Load(
        d, motion + (stage == 1 ? Motion::velocity : Motion::stage_velocity) * record_points);
    f = hn::Sub(hn::Sub(f, hn::Mul(hn::Set(d, constants_.drag), v)), hn::LoadDup128(d, gravity_));
    f = hn::Add(f, hn::LoadU(d, w_.contact + o));
    const auto y = hn::OddEven(hn::LoadU(d, at + o), hn::Zero(d));
    if (HWY_UNLIKELY(!hn::AllFalse(d, hn::Lt(y, hn::Zero(d)))))
      f = with_floor(d, physics_, at + o, v, f);
    Advance<stage, record_points>(d, v, f, constants_.substep, w_.position + o, next + o, motion);
  }

  // Adds the force of the floor to points that are below it. Static, so that a kernel's
  // address is never taken and its members can be registers.
  template <class D_>
  static HWY_NOINLINE hn::Vec<D_> with_floor(D_ d, const Physics& physics, const double* at,
                                             hn::Vec<D_> v, hn::Vec<D_> f) {
    HWY_ALIGN double vs[hn::MaxLanes(D_())];
    HWY_ALIGN double fs[hn::MaxLanes(D_())];
    hn::Store(v, d, vs);
    hn::Store(f, d, fs);
    for (std::size_t k = 0; k < hn::MaxLanes(D_()); k += 2)
      if (at[k + 1] < 0.0) AddFloor(physics, at[k + 1], vs[k], fs[k], fs[k + 1]);
    return hn::Load(d, fs);
  }

  const Plan& plan_;
  const Physics& physics_;
  Constants constants_;
  Arrays w_;
  HWY_ALIGN double gravity_[2];
};

#endif  // vectors

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
