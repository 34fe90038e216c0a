#include "libevo/base/elementary.h"

#include <cmath>

#include "libevo/base/elementary-inl.h"

namespace evo::math {
namespace {

using Scalar = HWY_NAMESPACE::Formulas<HWY_NAMESPACE::ScalarMath>;

constexpr double sine_limit = 0x1p20;  // quarters of a turn are counted exactly up to here
constexpr double whole_turn = 0x1.921fb54442d18p+2;

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

// Far out, whole turns of 2 pi as rounded are taken off first: the result is
// still the same everywhere, but no longer accurate.
double near(double x) { return std::fabs(x) <= sine_limit ? x : std::fmod(x, whole_turn); }

}  // namespace

double sqrt(double x) { return std::sqrt(x); }
double exp(double x) { return Scalar::exp(x); }
double log(double x) { return Scalar::log(x); }
double sin(double x) { return Scalar::sine_wave(near(x), 0.0); }
double cos(double x) { return Scalar::sine_wave(near(x), 1.0); }
double tanh(double x) { return Scalar::tanh(x); }
double acos(double x) { return Scalar::acos(x); }

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
