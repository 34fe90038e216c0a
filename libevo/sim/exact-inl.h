// IEEE square roots and quotients without the divider: the same bits as sqrt and
// division, from fused multiply-adds. The divider of today's processors takes 15
// to 40 cycles for the root and the quotient of a vector and can do nothing else
// meanwhile; these take a dozen cycles of the multipliers, next to it.
// Included once per instruction set (see Highway's "-inl.h" files).
//
// Why the bits are the same (Markstein, "Computation of elementary functions on
// the IBM RISC System/6000 processor", 1990; Cornea, Harrison and Tang,
// "Scientific Computing on Itanium", 2002), u = 2^-53:
//
//   root      y = 1/sqrt(s) (1 + 3u), g = s*y, and g + (s - g^2) * y/2 before its
//             last rounding is within 2^-102 of sqrt(s). Roots of doubles keep
//             farther from the middle between two doubles than that, but for a
//             few hundred s; the unit test goes through all of those, for any
//             estimate to 1.6 * 2^-12.
//   quotient  The first Newton step leaves y = (1 + t)/d with |t| <= u (1 + 30u) m/2,
//             m the mantissa of d in [1, 2). In the second the residual is exact, so
//             what is rounded is (1 - t^2)/d: rounded as 1/d would be, unless a
//             middle z between two doubles is in between, 0 < 1 - m z <= t^2. In
//             units of u^2, 1 - m z is a whole number and t^2 at most (m/2)^2 (1 + 60u):
//             z would need m z = 1 - u^2 and m > 2 - 60u, and of those mantissas
//             only all ones divides. Else y is the rounded 1/d, and the last
//             correction of a quotient that is off by less than a unit in the last
//             place rounds a/d correctly (Markstein's theorem).
//
// AreOrdinary() says whether the operands are such: the range of s is that of the
// first estimate in single precision, that of a keeps residuals exact.

#if defined(LIBEVO_SIM_EXACT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_SIM_EXACT_INL_H_
#undef LIBEVO_SIM_EXACT_INL_H_
#else
#define LIBEVO_SIM_EXACT_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_NATIVE_FMA

inline constexpr double smallest_root_argument = 0x1p-120;
inline constexpr double largest_root_argument = 0x1p+120;
inline constexpr double smallest_dividend = 0x1p-500;
inline constexpr double largest_dividend = 0x1p+500;

// Several at once, step by step: each is one long chain of dependent operations.
#define EVO_EACH for (std::size_t i = 0; i < n; ++i)

// root = sqrt(s), and y, which is an estimate of its reciprocal to 2^-11 before, to a
// few units in the last place afterwards.
template <std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void RefineRoots(D d, const V (&s)[n], V (&root)[n], V (&y)[n]) {
  const V one = hn::Set(d, 1.0);
  const V half = hn::Set(d, 0.5);
  V e[n], series[n], g[n];
  // 1/sqrt(1 - e) = 1 + e/2 + 3/8 e^2 + 5/16 e^3 + 35/128 e^4 + ..., e < 2^-10
  EVO_EACH e[i] = hn::Mul(s[i], y[i]);
  EVO_EACH e[i] = hn::NegMulAdd(e[i], y[i], one);
  EVO_EACH series[i] = hn::MulAdd(e[i], hn::Set(d, 35.0 / 128), hn::Set(d, 5.0 / 16));
  EVO_EACH series[i] = hn::MulAdd(e[i], series[i], hn::Set(d, 3.0 / 8));
  EVO_EACH series[i] = hn::MulAdd(e[i], series[i], half);
  EVO_EACH e[i] = hn::Mul(y[i], e[i]);
  EVO_EACH y[i] = hn::MulAdd(e[i], series[i], y[i]);
  EVO_EACH g[i] = hn::Mul(s[i], y[i]);
  EVO_EACH root[i] = hn::MulAdd(hn::NegMulAdd(g[i], g[i], s[i]), hn::Mul(half, y[i]), g[i]);
}

// root = sqrt(s), y about its reciprocal.
template <std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void RootsOf(D d, const V (&s)[n], V (&root)[n], V (&y)[n]) {
  const hn::Rebind<float, D> single;
  EVO_EACH y[i] = hn::PromoteTo(d, hn::ApproximateReciprocalSqrt(hn::DemoteTo(single, s[i])));
  RefineRoots(d, s, root, y);
}

// q = a / d, given y, 1/d to a few units in the last place.
template <std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE void QuotientsOf(D tag, const V (&a)[n], const V (&d)[n], V (&y)[n], V (&q)[n]) {
  const V one = hn::Set(tag, 1.0);
  EVO_EACH y[i] = hn::MulAdd(hn::NegMulAdd(d[i], y[i], one), y[i], y[i]);
  EVO_EACH y[i] = hn::MulAdd(hn::NegMulAdd(d[i], y[i], one), y[i], y[i]);
  EVO_EACH q[i] = hn::Mul(a[i], y[i]);
  EVO_EACH q[i] = hn::MulAdd(hn::NegMulAdd(q[i], d[i], a[i]), y[i], q[i]);
  EVO_EACH q[i] = hn::MulAdd(hn::NegMulAdd(q[i], d[i], a[i]), y[i], q[i]);
}
#undef EVO_EACH

// Whether the roots of s and the quotients of a by them, d, are IEEE's in all lanes.
template <std::size_t n, class D, class V = hn::Vec<D>>
HWY_INLINE bool AreOrdinary(D tag, const V (&s)[n], const V (&a)[n], const V (&d)[n]) {
  const hn::RebindToUnsigned<D> bits;
  const auto mantissa = hn::Set(bits, (std::uint64_t{1} << 52) - 1);
  auto ordinary = hn::Eq(s[0], s[0]);
  for (std::size_t i = 0; i < n; ++i) {
    const V size = hn::Abs(a[i]);
    const auto zeros = hn::AndNot(hn::BitCast(bits, d[i]), mantissa);
    ordinary = hn::And(ordinary, hn::Ge(s[i], hn::Set(tag, smallest_root_argument)));
    ordinary = hn::And(ordinary, hn::Le(s[i], hn::Set(tag, largest_root_argument)));
    ordinary = hn::And(ordinary, hn::Ge(size, hn::Set(tag, smallest_dividend)));
    ordinary = hn::And(ordinary, hn::Le(size, hn::Set(tag, largest_dividend)));
    ordinary = hn::And(ordinary, hn::RebindMask(tag, hn::Ne(zeros, hn::Zero(bits))));
  }
  return hn::AllTrue(tag, ordinary);
}

#endif  // HWY_NATIVE_FMA

// x / 6. The remainder of x * (1/6) is exact because 6 has two bits, and x / 6
// is never nearer than 1/6 unit to the middle between two doubles.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V SixthOf(D d, V x) {
  const V six = hn::Set(d, 6.0);
#if HWY_NATIVE_FMA
  const V sixth = hn::Set(d, 1.0 / 6.0);
  const V quotient = hn::Mul(x, sixth);
  return hn::MulAdd(hn::NegMulAdd(quotient, six, x), sixth, quotient);
#else
  return hn::Div(x, six);
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
