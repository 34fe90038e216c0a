#include "libevo/base/elementary.h"

#include <cmath>

#include "libevo/base/elementary-inl.h"

namespace evo::math {
namespace {

using Scalar = HWY_NAMESPACE::Formulas<HWY_NAMESPACE::ScalarMath>;

constexpr double sine_limit = 0x1p20;  // quarters of a turn are counted exactly up to here
constexpr double whole_turn = 0x1.921fb54442d18p+2;

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

}  // namespace evo::math
