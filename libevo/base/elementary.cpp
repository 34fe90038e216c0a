// Each function reduces its argument to a short interval, evaluates a
// polynomial there by Horner's rule, and carries the rounding error of the
// reduction along (the plan of Sun's fdlibm, 1993; the coefficients here are
// Taylor's, or fitted with mpmath where Taylor's converge slowly). No fused
// operation, no table.
#include "libevo/base/elementary.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace evo::math {
namespace {

// Adding 1.5 * 2^52 rounds |x| < 2^51 to an integer and leaves that integer in
// the low bits of the sum.
constexpr double rounding_shift = 0x1.8p52;
constexpr std::uint64_t exponent_bias = 1023;
constexpr int mantissa_bits = 52;
constexpr std::uint64_t mantissa_mask = (std::uint64_t{1} << mantissa_bits) - 1;
constexpr std::uint64_t bits_of_sqrt_half = 0x3FE6A09E667F3BCD;

constexpr double sine_limit = 0x1p20;  // quarters of a turn are counted exactly up to here
constexpr double whole_turn = 0x1.921fb54442d18p+2;

double round(double x) { return (x + rounding_shift) - rounding_shift; }

// 2^n of an integer n in [-1022, 1023].
double power_of_two(double n) {
  const auto bits = std::bit_cast<std::uint64_t>(n + (rounding_shift + exponent_bias));
  return std::bit_cast<double>(bits << mantissa_bits);
}

// x = 2^exponent * mantissa, mantissa in [sqrt(1/2), sqrt(2)); x normal.
void split(double x, double& exponent, double& mantissa) {
  constexpr std::uint64_t one = exponent_bias << mantissa_bits;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x) + (one - bits_of_sqrt_half);
  exponent = static_cast<double>(bits >> mantissa_bits) - static_cast<double>(exponent_bias);
  mantissa = std::bit_cast<double>((bits & mantissa_mask) + bits_of_sqrt_half);
}

// Whether bit `bit` of the integer n is set.
bool has_bit(double n, int bit) {
  return ((std::bit_cast<std::uint64_t>(n + rounding_shift) >> bit) & 1) != 0;
}

// c[0] + x*(c[1] + x*(...))
template <std::size_t N>
double horner(double x, const double (&c)[N]) {
  double sum = c[N - 1];
  for (std::size_t i = N - 1; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// e^x = 2^n (1 + r + rest): r is the rounded remainder, |r| < 0.35.
void reduce_exp(double x, double& n, double& r, double& rest) {
  static constexpr double taylor[] = {
      1.0 / 2,     1.0 / 6,      1.0 / 24,      1.0 / 120,      1.0 / 720,       1.0 / 5040,
      1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
  constexpr double log2_e = 0x1.71547652b82fep+0;
  constexpr double ln2_high = 0x1.62e42fee00000p-1;  // n * ln2_high is exact
  constexpr double ln2_low = 0x1.a39ef35793c76p-33;
  n = round(x * log2_e);
  const double high = x - n * ln2_high;
  const double low = n * ln2_low;
  r = high - low;
  rest = r * r * horner(r, taylor) + ((high - r) - low);
}

// sin (quarter 0) or cos (quarter 1) of x.
double sine_wave(double x, double quarter) {
  static constexpr double sine[] = {
      -1.0 / 6,        1.0 / 120,        -1.0 / 5040,          1.0 / 362880,
      -1.0 / 39916800, 1.0 / 6227020800, -1.0 / 1307674368000, 1.0 / 355687428096000};
  static constexpr double cosine[] = {
      1.0 / 24,        -1.0 / 720,         1.0 / 40320,          -1.0 / 3628800,
      1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888000, -1.0 / 6402373705728000};
  // Far out, whole turns of 2 pi as rounded are taken off first: the result is
  // still the same everywhere, but no longer accurate.
  if (!(std::fabs(x) <= sine_limit)) x = std::fmod(x, whole_turn);
  const double n = round(x * 0x1.45f306dc9c883p-1);  // 2/pi
  const double a = x - n * 0x1.921fb54400000p+0;     // pi/2 in three parts; the
  const double b = n * 0x1.0b4611a600000p-34;        // first two products are exact
  const double ab = a - b;
  const double low = ((a - ab) - b) - n * 0x1.3198a2e037073p-69;
  const double r = ab + low;
  const double lost = (ab - r) + low;
  const double z = r * r;
  const double half = 0.5 * z;
  const double s = r + (r * z * horner(z, sine) + lost * (1.0 - half));
  const double w = 1.0 - half;
  const double c = w + (((1.0 - w) - half) + (z * z * horner(z, cosine) - r * lost));
  const double turn = n + quarter;
  const double value = has_bit(turn, 0) ? c : s;
  return has_bit(turn, 1) ? 0.0 - value : value;
}

// e^x - 1, for |x| < 44 (K. C. Ng's plan in fdlibm): x = k ln 2 + r, |r| <= ln 2 / 2, and a
// rational approximation of degree five in r^2. Fused operations stand where the C library
// has them on processors that know them; std::fma has the same bits on all others.
double reference_expm1(double x) {
  constexpr double ln2 = 0x1.62e42fefa39efp-1;
  constexpr double ln2_high = 0x1.62e42feep-1;
  constexpr double ln2_low = 0x1.a39ef35793c76p-33;
  constexpr double q1 = -3.33333333333331316428e-02;
  constexpr double q2 = 1.58730158725481460165e-03;
  constexpr double q3 = -7.93650757867487942473e-05;
  constexpr double q4 = 4.00821782732936239552e-06;
  constexpr double q5 = -2.01099218183624371326e-07;

  const double size = std::fabs(x);
  if (size < 0x1p-54) return x;
  int k = 0;
  double lost = 0.0;  // by rounding x - k ln 2
  if (size > 0.5 * ln2) {
    k = size < 1.5 * ln2
            ? (x > 0.0 ? 1 : -1)
            : static_cast<int>(std::fma(x, 0x1.71547652b82fep+0, x > 0.0 ? 0.5 : -0.5));
    const double high = x - k * ln2_high;  // the product is exact
    const double low = k * ln2_low;
    x = high - low;
    lost = (high - x) - low;
  }
  const double half = 0.5 * x;
  const double z = x * half;
  const double z2 = z * z;
  const double first = std::fma(z2, std::fma(z, q3, q2), std::fma(z, q1, 1.0));
  const double r = std::fma(z2 * z2, std::fma(z, q5, q4), first);
  const double t = std::fma(-r, half, 3.0);
  double e = z * ((r - t) / std::fma(-x, t, 6.0));
  if (k == 0) return x - std::fma(x, e, -z);
  e = std::fma(x, e - lost, -lost) - z;
  if (k == -1) return 0.5 * (x - e) - 0.5;
  if (k == 1) return x < -0.25 ? -2.0 * (e - (x + 0.5)) : 1.0 + 2.0 * (x - e);
  if (k <= -2 || k > 56) return std::ldexp(1.0 - (e - x), k) - 1.0;
  const double rest = std::ldexp(1.0, -k);
  return k < 20 ? std::ldexp((1.0 - rest) - (e - x), k) : std::ldexp((x - (e + rest)) + 1.0, k);
}

}  // namespace

double sqrt(double x) { return std::sqrt(x); }

double exp(double x) {
  constexpr double highest = 710.0;  // beyond these the result is inf or 0
  constexpr double lowest = -746.0;
  if (x > highest) x = highest;
  if (x < lowest) x = lowest;
  double n;
  double r;
  double rest;
  reduce_exp(x, n, r, rest);
  const double half = round(n * 0.5);  // 2^n itself may overflow
  return (1.0 + (r + rest)) * power_of_two(half) * power_of_two(n - half);
}

double log(double x) {
  // 2 atanh(s) = 2s + s * (2/3 s^2 + 2/5 s^4 + ...)
  static constexpr double series[] = {2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,  2.0 / 11, 2.0 / 13,
                                      2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21, 2.0 / 23};
  constexpr double ln2_high = 0x1.62e42fee00000p-1;
  constexpr double ln2_low = 0x1.a39ef35793c76p-33;
  if (x == 0.0) return -HUGE_VAL;
  if (x < 0.0) return std::numeric_limits<double>::quiet_NaN();
  if (!(x < HUGE_VAL)) return x;  // inf, NaN
  const bool tiny = x < 0x1p-1022;
  double n;
  double m;
  split(tiny ? x * 0x1p54 : x, n, m);
  if (tiny) n -= 54.0;
  const double f = m - 1.0;
  const double s = f / (2.0 + f);
  const double z = s * s;
  const double rest = z * horner(z, series);
  const double half_square = 0.5 * f * f;
  return n * ln2_high - ((half_square - (s * (half_square + rest) + n * ln2_low)) - f);
}

double sin(double x) { return sine_wave(x, 0.0); }
double cos(double x) { return sine_wave(x, 1.0); }

double tanh(double x) {
  constexpr double saturated = 22.0;  // tanh rounds to 1 from here
  double size = std::fabs(x);
  if (size > saturated) size = saturated;
  // t = e^(-2|x|) - 1 below 1, e^(2|x|) - 1 above
  const bool small = size < 1.0;
  const double twice = 2.0 * size;
  double n;
  double r;
  double rest;
  reduce_exp(small ? 0.0 - twice : twice, n, r, rest);
  const double scale = power_of_two(n);
  const double whole = scale - 1.0;
  const double part = scale * r;
  const double sum = whole + part;
  const double t = sum + ((part - (sum - whole)) + scale * rest);
  return std::copysign(small ? (0.0 - t) / (t + 2.0) : 1.0 - 2.0 / (t + 2.0), x);
}

double acos(double x) {
  // asin(x) = x + x z P(z), z = x^2 <= 1/4; fitted to 2^-56 relative.
  static constexpr double fit[] = {
      0x1.5555555555556p-3, 0x1.3333333332ecap-4, 0x1.6db6db6e31f13p-5, 0x1.f1c71c1db0623p-6,
      0x1.6e8bb1c8209a2p-6, 0x1.1c4d35cf95421p-6, 0x1.c9cf07674736ap-7, 0x1.782651caa6547p-7,
      0x1.52420b04b37bep-7, 0x1.65a9c4dfcf8b2p-8, 0x1.1d189408314eep-6, -0x1.e6aaa8a0a04ccp-7,
      0x1.d72b2bc8155f8p-6};
  constexpr double half_pi = 0x1.921fb54442d18p+0;
  constexpr double half_pi_low = 0x1.1a62633145c07p-54;
  const double size = std::fabs(x);
  if (!(size > 0.5)) {  // pi/2 - asin(x)
    const double z = x * x;
    return half_pi - (x - (half_pi_low - x * (z * horner(z, fit))));
  }
  // else 2 asin(sqrt(z)), the root split in two so that its error is known
  const double z = (1.0 - size) * 0.5;
  const double rest = z * horner(z, fit);
  const double root = std::sqrt(z);
  const double wide = root * (0x1p27 + 1.0);
  const double high = wide - (wide - root);
  const double low = root > 0.0 ? (z - high * high) / (root + high) : root;
  if (x < 0.0) return 2.0 * (half_pi - (root + (rest * root - half_pi_low)));
  return 2.0 * (high + (rest * root + low));
}

double reference_tanh(double x) {
  const double size = std::fabs(x);
  if (size < 0x1p-55) return x * (1.0 + x);
  double value = 1.0;  // from 22 on
  if (size < 1.0) {
    const double t = reference_expm1(-2.0 * size);
    value = -t / (t + 2.0);
  } else if (size < 22.0) {
    value = 1.0 - 2.0 / (reference_expm1(2.0 * size) + 2.0);
  }
  return std::isnan(x) ? x : std::copysign(value, x);
}

}  // namespace evo::math
