// What the kernels compute from the length of a spring, in either arithmetic
// (physics.h). Both kernels and all widths call these, so each arithmetic has one
// result. Included once per instruction set (see Highway's "-inl.h" files).

#if defined(LIBEVO_SIM_ARITHMETIC_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_SIM_ARITHMETIC_INL_H_
#undef LIBEVO_SIM_ARITHMETIC_INL_H_
#else
#define LIBEVO_SIM_ARITHMETIC_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "libevo/sim/physics.h"
#include "libevo/sim/plan.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <Arithmetic arithmetic>
struct SpringMath;

// The forces at the ends of springs, from `force`, values of a point; `end` lists
// first a_ends of them that are subtracted, then b_ends that are added.
template <Arithmetic arithmetic, class D, class V = hn::Vec<D>>
HWY_INLINE V SumForces(D d, const hn::TFromD<D>* force, const std::uint32_t* HWY_RESTRICT end,
                       int a_ends, int b_ends) {
  if constexpr (arithmetic == Arithmetic::fast) {
    // In pairs: the sum of a point is not to wait for one addition after the other.
    if (a_ends == Plan::regular_ends && b_ends == Plan::regular_ends) {
      const auto pair = [&](int i) {
        return hn::Add(hn::Load(d, force + end[i]), hn::Load(d, force + end[i + 1]));
      };
      return hn::Sub(hn::Add(pair(4), pair(6)), hn::Add(pair(0), pair(2)));
    }
  }
  V sum = hn::Zero(d);
  for (int i = 0; i < a_ends; ++i) sum = hn::Sub(sum, hn::Load(d, force + end[i]));
  for (int i = a_ends; i < a_ends + b_ends; ++i) sum = hn::Add(sum, hn::Load(d, force + end[i]));
  return sum;
}

// Every operation of docs/physics.md, each rounded once.
template <>
struct SpringMath<Arithmetic::exact> {
  static constexpr std::size_t kept = 1;  // values per spring from the first stage for the others

  // |q|^2
  template <class D, class V = hn::Vec<D>>
  static HWY_INLINE V square(D /*d*/, V qx, V qy) {
    return hn::Add(hn::Mul(qx, qx), hn::Mul(qy, qy));
  }

  // k (d - L), the rest length L being kept from the first stage for the others.
  template <bool first_stage, class D, class V = hn::Vec<D>>
  static HWY_INLINE V tension(D d, V length, V stiffness, double rate, const double* goal,
                              double* kept) {
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
  static HWY_INLINE V pull(D d, V square, V stiffness, double rate, const double* goal,
                           double* kept) {
    const V length = hn::Sqrt(square);
    return hn::Div(tension<first_stage>(d, length, stiffness, rate, goal, kept), length);
  }

  // (d - target) / (2 d), the factor of q that takes a spring back to `target`.
  template <class D, class V = hn::Vec<D>>
  static HWY_INLINE V correction(D d, V square, V target) {
    const V length = hn::Sqrt(square);
    return hn::Div(hn::Sub(length, target), hn::Mul(hn::Set(d, 2.0), length));
  }
};

// The same in single precision, rearranged so that three of four stages need no
// root. With d the length in the first stage and d' that in a later one,
//
//   pull  = k (d - L) / d          = k rate (1 - goal / d)
//   pull' = k - (k L / d) (d / d') = k - (k - pull) (1 - e)^(-1/2),  e = 1 - d'^2 / d^2
//
// and e is twice the strain within a stage: the series' error is 0.25 e^5, 8e-15 at a
// strain of 0.1 %, 8e-10 at 1 %; single precision rounds e to 1e-7.
template <>
struct SpringMath<Arithmetic::fast> {
  static constexpr std::size_t kept = 2;  // k - pull, 1 / d^2

  template <class D, class V = hn::Vec<D>>
  static HWY_INLINE V square(D /*d*/, V qx, V qy) {
    return hn::MulAdd(qx, qx, hn::Mul(qy, qy));
  }

  template <bool first_stage, class D, class V = hn::Vec<D>>
  static HWY_INLINE V pull(D d, V square, V stiffness, float rate, const float* goal, float* kept) {
    const V one = hn::Set(d, 1.0F);
    if constexpr (first_stage) {
      const V y = hn::Div(one, hn::Sqrt(square));
      const V beyond = hn::NegMulAdd(hn::LoadU(d, goal), y, one);
      const V pull = hn::Mul(hn::Mul(stiffness, hn::Set(d, rate)), beyond);
      hn::StoreU(hn::Sub(stiffness, pull), d, kept);
      hn::StoreU(hn::Mul(y, y), d, kept + hn::Lanes(d));
      return pull;
    } else {
      const V e = hn::NegMulAdd(square, hn::LoadU(d, kept + hn::Lanes(d)), one);
      V series = hn::MulAdd(e, hn::Set(d, 35.0F / 128), hn::Set(d, 5.0F / 16));
      series = hn::MulAdd(e, series, hn::Set(d, 3.0F / 8));
      series = hn::MulAdd(e, series, hn::Set(d, 0.5F));
      return hn::NegMulAdd(hn::LoadU(d, kept), hn::MulAdd(e, series, one), stiffness);
    }
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
