// Reciprocal square roots without the divider and without the processor's own
// estimate, which each maker rounds differently: the same bits on every processor
// with fused multiply-adds. Included once an instruction set (see Highway's
// "-inl.h" files).

#if defined(LIBEVO_SIM_FAST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_SIM_FAST_INL_H_
#undef LIBEVO_SIM_FAST_INL_H_
#else
#define LIBEVO_SIM_FAST_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// 1/sqrt(s) to 2 units in the last place, for positive normal s; no exception for
// others (0 gives something huge, what is not a number stays so).
template <class D, class V = hn::Vec<D>>
HWY_INLINE V ReciprocalRootOf(D d, V s) {
  // Half the exponent, negated: within 7 % below, e = 1 - s y^2 in [0.0077, 0.125].
  constexpr std::uint64_t estimate = 0x5FE6000000000000;
  // 1/sqrt(1 - e) there, relative error below 5.4e-7 (Remez).
  constexpr double fit[] = {0x1.ffffbbc37ab30p-1, 0x1.0020dd821ceacp-1, 0x1.77eacfd4e2f1ap-2,
                            0x1.98719ec1d7c6ap-2};
  const hn::RebindToUnsigned<D> bits;
  const V one = hn::Set(d, 1.0);
  V y = hn::BitCast(d, hn::Sub(hn::Set(bits, estimate), hn::ShiftRight<1>(hn::BitCast(bits, s))));
  V e = hn::NegMulAdd(hn::Mul(s, y), y, one);
  V series = hn::MulAdd(e, hn::Set(d, fit[3]), hn::Set(d, fit[2]));
  series = hn::MulAdd(e, series, hn::Set(d, fit[1]));
  y = hn::Mul(y, hn::MulAdd(e, series, hn::Set(d, fit[0])));
  // Then 1 + e/2 + 3/8 e^2, |e| < 1.1e-6.
  e = hn::NegMulAdd(hn::Mul(s, y), y, one);
  series = hn::MulAdd(e, hn::Set(d, 3.0 / 8.0), hn::Set(d, 0.5));
  return hn::MulAdd(hn::Mul(y, e), series, y);
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
