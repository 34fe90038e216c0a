// The formulas behind elementary.h, written once for scalars and for Highway's
// vectors. Included once an instruction set, in the manner of Highway's own
// "-inl.h" files: everything here lives in that instruction set's namespace.
//
// Each function reduces its argument to a short interval, evaluates a
// polynomial there by Horner's rule, and carries the rounding error of the
// reduction along (the plan of Sun's fdlibm, 1993; the coefficients here are
// Taylor's, or fitted with mpmath where Taylor's converge slowly). No fused
// operation, no table, no branch: the same IEEE operations for a scalar and for
// every lane of a vector. Errors are below 1 unit in the last place (tanh: 2.5).

#if defined(LIBEVO_BASE_ELEMENTARY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LIBEVO_BASE_ELEMENTARY_INL_H_
#undef LIBEVO_BASE_ELEMENTARY_INL_H_
#else
#define LIBEVO_BASE_ELEMENTARY_INL_H_
#endif

#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// ---- what the formulas ask of a number -----------------------------------------

// Adding 1.5 * 2^52 rounds |x| < 2^51 to an integer and leaves that integer in
// the low bits of the sum.
inline constexpr double rounding_shift = 0x1.8p52;
inline constexpr std::uint64_t exponent_bias = 1023;
inline constexpr int mantissa_bits = 52;
inline constexpr std::uint64_t mantissa_mask = (std::uint64_t{1} << mantissa_bits) - 1;
inline constexpr std::uint64_t bits_of_sqrt_half = 0x3FE6A09E667F3BCD;

struct ScalarMath {
  using Number = double;
  using Mask = bool;
  static Number set(double x) { return x; }
  static Number select(Mask mask, Number yes, Number no) { return mask ? yes : no; }
  static Mask less(Number a, Number b) { return a < b; }
  static Number abs(Number x) { return std::fabs(x); }
  static Number copy_sign(Number size, Number sign) { return std::copysign(size, sign); }
  static Number sqrt(Number x) { return std::sqrt(x); }
  // 2^n of an integer n in [-1022, 1023].
  static Number power_of_two(Number n) {
    const auto bits = std::bit_cast<std::uint64_t>(n + (rounding_shift + exponent_bias));
    return std::bit_cast<double>(bits << mantissa_bits);
  }
  // x = 2^exponent * mantissa, mantissa in [sqrt(1/2), sqrt(2)); x normal.
  static void split(Number x, Number& exponent, Number& mantissa) {
    constexpr std::uint64_t one = exponent_bias << mantissa_bits;
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(x) + (one - bits_of_sqrt_half);
    exponent = static_cast<double>(bits >> mantissa_bits) - static_cast<double>(exponent_bias);
    mantissa = std::bit_cast<double>((bits & mantissa_mask) + bits_of_sqrt_half);
  }
  // Whether bit `bit` of the integer n is set.
  static Mask bit(Number n, int bit) {
    return ((std::bit_cast<std::uint64_t>(n + rounding_shift) >> bit) & 1) != 0;
  }
};

template <class D>
struct LaneMath {
  using Number = hn::Vec<D>;
  using Mask = hn::Mask<D>;
  static HWY_INLINE Number set(double x) { return hn::Set(D(), x); }
  static HWY_INLINE Number select(Mask mask, Number yes, Number no) {
    return hn::IfThenElse(mask, yes, no);
  }
  static HWY_INLINE Mask less(Number a, Number b) { return hn::Lt(a, b); }
  static HWY_INLINE Number abs(Number x) { return hn::Abs(x); }
  static HWY_INLINE Number copy_sign(Number size, Number sign) { return hn::CopySign(size, sign); }
  static HWY_INLINE Number power_of_two(Number n) {
    const hn::RebindToUnsigned<D> bits;
    const Number shifted = hn::Add(n, set(rounding_shift + exponent_bias));
    return hn::BitCast(D(), hn::ShiftLeft<mantissa_bits>(hn::BitCast(bits, shifted)));
  }
};

// ---- the formulas ----------------------------------------------------------------

template <class M>
struct Formulas {
  using Number = typename M::Number;
  using Mask = typename M::Mask;

  static HWY_INLINE Number round(Number x) {
    return (x + M::set(rounding_shift)) - M::set(rounding_shift);
  }

  // c[0] + x*(c[1] + x*(...))
  template <std::size_t N>
  static HWY_INLINE Number horner(Number x, const double (&c)[N]) {
    Number sum = M::set(c[N - 1]);
    for (std::size_t i = N - 1; i-- > 0;) sum = sum * x + M::set(c[i]);
    return sum;
  }

  // e^x = 2^n (1 + r + rest): r is the rounded remainder, |r| < 0.35.
  static HWY_INLINE void reduce_exp(Number x, Number& n, Number& r, Number& rest) {
    static constexpr double taylor[] = {1.0 / 2,        1.0 / 6,         1.0 / 24,
                                        1.0 / 120,      1.0 / 720,       1.0 / 5040,
                                        1.0 / 40320,    1.0 / 362880,    1.0 / 3628800,
                                        1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
    const Number log2_e = M::set(0x1.71547652b82fep+0);
    const Number ln2_high = M::set(0x1.62e42fee00000p-1);  // n * ln2_high is exact
    const Number ln2_low = M::set(0x1.a39ef35793c76p-33);
    n = round(x * log2_e);
    const Number high = x - n * ln2_high;
    const Number low = n * ln2_low;
    r = high - low;
    rest = r * r * horner(r, taylor) + ((high - r) - low);
  }

  static HWY_INLINE Number exp(Number x) {
    const Number highest = M::set(710.0);  // beyond these the result is inf or 0
    const Number lowest = M::set(-746.0);
    x = M::select(M::less(highest, x), highest, x);
    x = M::select(M::less(x, lowest), lowest, x);
    Number n;
    Number r;
    Number rest;
    reduce_exp(x, n, r, rest);
    const Number half = round(n * M::set(0.5));  // 2^n itself may overflow
    return (M::set(1.0) + (r + rest)) * M::power_of_two(half) * M::power_of_two(n - half);
  }

  static HWY_INLINE Number tanh(Number x) {
    const Number saturated = M::set(22.0);  // tanh rounds to 1 from here
    const Number one = M::set(1.0);
    const Number two = M::set(2.0);
    Number size = M::abs(x);
    size = M::select(M::less(saturated, size), saturated, size);
    // t = e^(-2|x|) - 1 below 1, e^(2|x|) - 1 above
    const Mask small = M::less(size, one);
    const Number twice = two * size;
    Number n;
    Number r;
    Number rest;
    reduce_exp(M::select(small, M::set(0.0) - twice, twice), n, r, rest);
    const Number scale = M::power_of_two(n);
    const Number whole = scale - one;
    const Number part = scale * r;
    const Number sum = whole + part;
    const Number t = sum + ((part - (sum - whole)) + scale * rest);
    const Number quotient = M::select(small, M::set(0.0) - t, two) / (t + two);
    return M::copy_sign(M::select(small, quotient, one - quotient), x);
  }

  static HWY_INLINE Number log(Number x) {
    // 2 atanh(s) = 2s + s * (2/3 s^2 + 2/5 s^4 + ...)
    static constexpr double series[] = {2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,  2.0 / 11, 2.0 / 13,
                                        2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21, 2.0 / 23};
    const Number ln2_high = M::set(0x1.62e42fee00000p-1);
    const Number ln2_low = M::set(0x1.a39ef35793c76p-33);
    const Number infinity = M::set(HUGE_VAL);
    const Mask tiny = M::less(x, M::set(0x1p-1022));
    Number n;
    Number m;
    M::split(M::select(tiny, x * M::set(0x1p54), x), n, m);
    n = n - M::select(tiny, M::set(54.0), M::set(0.0));
    const Number f = m - M::set(1.0);
    const Number s = f / (M::set(2.0) + f);
    const Number z = s * s;
    const Number rest = z * horner(z, series);
    const Number half_square = M::set(0.5) * f * f;
    const Number result =
        n * ln2_high - ((half_square - (s * (half_square + rest) + n * ln2_low)) - f);
    const Number zero = M::set(0.0);
    const Number invalid = zero * infinity;
    Number special = M::select(M::less(zero, x), x, invalid);  // inf, NaN
    special = M::select(M::less(x, zero), invalid, special);
    special = M::select(M::less(M::abs(x), M::set(0x1p-1074)), zero - infinity, special);
    const Number if_finite = M::select(M::less(x, infinity), result, special);
    return M::select(M::less(zero, x), if_finite, special);
  }

  // sin (quarter 0) or cos (quarter 1) of x, |x| < 2^20 pi/2.
  static HWY_INLINE Number sine_wave(Number x, double quarter) {
    static constexpr double sine[] = {
        -1.0 / 6,        1.0 / 120,        -1.0 / 5040,          1.0 / 362880,
        -1.0 / 39916800, 1.0 / 6227020800, -1.0 / 1307674368000, 1.0 / 355687428096000};
    static constexpr double cosine[] = {
        1.0 / 24,        -1.0 / 720,         1.0 / 40320,          -1.0 / 3628800,
        1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888000, -1.0 / 6402373705728000};
    const Number n = round(x * M::set(0x1.45f306dc9c883p-1));  // 2/pi
    const Number a = x - n * M::set(0x1.921fb54400000p+0);     // pi/2 in three parts; the
    const Number b = n * M::set(0x1.0b4611a600000p-34);        // first two products are exact
    const Number ab = a - b;
    const Number low = ((a - ab) - b) - n * M::set(0x1.3198a2e037073p-69);
    const Number r = ab + low;
    const Number lost = (ab - r) + low;
    const Number z = r * r;
    const Number half = M::set(0.5) * z;
    const Number one = M::set(1.0);
    const Number s = r + (r * z * horner(z, sine) + lost * (one - half));
    const Number w = one - half;
    const Number c = w + (((one - w) - half) + (z * z * horner(z, cosine) - r * lost));
    const Number turn = n + M::set(quarter);
    const Number value = M::select(M::bit(turn, 0), c, s);
    return M::select(M::bit(turn, 1), M::set(0.0) - value, value);
  }

  static HWY_INLINE Number acos(Number x) {
    // asin(x) = x + x z P(z), z = x^2 <= 1/4; fitted to 2^-56 relative.
    static constexpr double fit[] = {
        0x1.5555555555556p-3, 0x1.3333333332ecap-4, 0x1.6db6db6e31f13p-5, 0x1.f1c71c1db0623p-6,
        0x1.6e8bb1c8209a2p-6, 0x1.1c4d35cf95421p-6, 0x1.c9cf07674736ap-7, 0x1.782651caa6547p-7,
        0x1.52420b04b37bep-7, 0x1.65a9c4dfcf8b2p-8, 0x1.1d189408314eep-6, -0x1.e6aaa8a0a04ccp-7,
        0x1.d72b2bc8155f8p-6};
    const Number half_pi = M::set(0x1.921fb54442d18p+0);
    const Number half_pi_low = M::set(0x1.1a62633145c07p-54);
    const Number half = M::set(0.5);
    const Number two = M::set(2.0);
    const Number size = M::abs(x);
    const Mask near_one = M::less(half, size);
    const Number z = M::select(near_one, (M::set(1.0) - size) * half, x * x);
    const Number rest = z * horner(z, fit);
    // |x| <= 1/2: pi/2 - asin(x)
    const Number middle = half_pi - (x - (half_pi_low - x * rest));
    // else 2 asin(sqrt(z)), the root split in two so that its error is known
    const Number root = M::sqrt(z);
    const Number wide = root * M::set(0x1p27 + 1.0);
    const Number high = wide - (wide - root);
    const Mask positive = M::less(M::set(0.0), root);
    const Number low = M::select(positive, (z - high * high) / (root + high), root);
    const Number right = two * (high + (rest * root + low));
    const Number left = two * (half_pi - (root + (rest * root - half_pi_low)));
    const Number ends = M::select(M::less(x, M::set(0.0)), left, right);
    return M::select(near_one, ends, middle);
  }
};

// ---- lanes -----------------------------------------------------------------------

// The same bits as evo::math::exp and tanh in every lane.
template <class D>
HWY_INLINE hn::Vec<D> Exp(D, hn::Vec<D> x) {
  return Formulas<LaneMath<D>>::exp(x);
}
template <class D>
HWY_INLINE hn::Vec<D> Tanh(D, hn::Vec<D> x) {
  return Formulas<LaneMath<D>>::tanh(x);
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
