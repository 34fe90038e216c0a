// Accuracy against the C library's long double functions.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "libevo/base/elementary.h"
#include "libevo/base/random.h"

namespace evo {
namespace {

// Error in units of the last place of the true value.
double error_in_ulps(double value, long double truth) {
  const auto rounded = static_cast<double>(truth);
  if (value == rounded) return 0.0;
  const double size = std::fabs(rounded);
  const double ulp = std::nextafter(size, HUGE_VAL) - size;
  return static_cast<double>(std::fabs(static_cast<long double>(value) - truth) /
                             static_cast<long double>(ulp));
}

double worst_error(double low, double high, const std::function<double(double)>& f,
                   const std::function<long double(long double)>& truth) {
  Stream random(1, "elementary");
  double worst = 0.0;
  for (int i = 0; i < 100'000; ++i) {
    const double x = low + (high - low) * random.uniform();
    worst = std::max(worst, error_in_ulps(f(x), truth(static_cast<long double>(x))));
  }
  return worst;
}

}  // namespace

TEST_CASE("elementary functions are accurate to the last place") {
  using LD = long double;
  CHECK(worst_error(-745.0, 709.0, math::exp, [](LD x) { return std::exp(x); }) < 1.0);
  CHECK(worst_error(-1.0, 1.0, math::exp, [](LD x) { return std::exp(x); }) < 1.0);
  CHECK(worst_error(0.0, 3.0, math::log, [](LD x) { return std::log(x); }) < 1.0);
  CHECK(worst_error(0.0, 1e300, math::log, [](LD x) { return std::log(x); }) < 1.0);
  CHECK(worst_error(-7.0, 7.0, math::sin, [](LD x) { return std::sin(x); }) < 1.0);
  CHECK(worst_error(-7.0, 7.0, math::cos, [](LD x) { return std::cos(x); }) < 1.0);
  CHECK(worst_error(-1e6, 1e6, math::sin, [](LD x) { return std::sin(x); }) < 1.0);
  CHECK(worst_error(-1e6, 1e6, math::cos, [](LD x) { return std::cos(x); }) < 1.0);
  CHECK(worst_error(-1.0, 1.0, math::acos, [](LD x) { return std::acos(x); }) < 1.0);
  CHECK(worst_error(0.999, 1.0, math::acos, [](LD x) { return std::acos(x); }) < 1.0);
  CHECK(worst_error(-1.0, 1.0, math::tanh, [](LD x) { return std::tanh(x); }) < 2.5);
  CHECK(worst_error(-25.0, 25.0, math::tanh, [](LD x) { return std::tanh(x); }) < 2.5);
  CHECK(worst_error(-1e-5, 1e-5, math::tanh, [](LD x) { return std::tanh(x); }) < 2.5);
}

TEST_CASE("elementary functions at the ends of their ranges") {
  const double infinity = HUGE_VAL;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(math::exp(0.0) == 1.0);
  CHECK(math::exp(710.0) == infinity);
  CHECK(math::exp(-infinity) == 0.0);
  CHECK(math::exp(infinity) == infinity);
  CHECK(math::exp(-744.0) == std::exp(-744.0));  // a subnormal
  CHECK(math::log(1.0) == 0.0);
  CHECK(math::log(0.0) == -infinity);
  CHECK(math::log(infinity) == infinity);
  CHECK(math::log(5e-324) == Approx(-744.4400719213812).epsilon(1e-15));
  CHECK(std::isnan(math::log(-1.0)));
  CHECK(math::tanh(infinity) == 1.0);
  CHECK(math::tanh(-30.0) == -1.0);
  CHECK(math::tanh(1e-310) == 1e-310);
  CHECK(std::signbit(math::tanh(-0.0)));
  CHECK(math::acos(1.0) == 0.0);
  CHECK(math::acos(-1.0) == std::acos(-1.0));
  CHECK(math::acos(0.0) == std::acos(0.0));
  CHECK(std::isnan(math::acos(1.5)));
  CHECK(std::isnan(math::sin(infinity)));
  CHECK(std::fabs(math::sin(1e300)) <= 1.0);
  for (const auto& f : {math::exp, math::log, math::sin, math::cos, math::tanh, math::acos})
    CHECK(std::isnan(f(nan)));
}

TEST_CASE("reference_tanh has the bits of the benchmark's C library") {
  // As glibc 2.36 computes it on processors with fused operations.
  struct Value {
    double x, tanh;
  };
  static constexpr Value values[] = {{0x1.79ca10c924223p-67, 0x1.79ca10c924223p-67},
                                     {0x1.12e0be826d695p-30, 0x1.12e0be826d695p-30},
                                     {0x1.3p-12, 0x1.2fffff711aaafp-12},
                                     {0x1.945b6c3760bf6p-7, 0x1.94562b33222f1p-7},
                                     {0x1.999999999999ap-4, 0x1.983d7795f413ap-4},
                                     {0x1.5c28f5c28f5c3p-3, 0x1.58d8296a405bcp-3},
                                     {0x1p-2, 0x1.f597ea69a1c86p-3},
                                     {0x1.3333333333333p-2, 0x1.2a4dda7d914fap-2},
                                     {0x1.ccccccccccccdp-2, 0x1.b0064af70e0bap-2},
                                     {0x1.0a3d70a3d70a4p-1, 0x1.e92a312640003p-2},
                                     {0x1.6666666666666p-1, 0x1.356fb17af2e92p-1},
                                     {0x1.fae147ae147aep-1, 0x1.83c4fe9b770ep-1},
                                     {0x1p+0, 0x1.85efab514f394p-1},
                                     {0x1.4cccccccccccdp+0, 0x1.b933c726e9b3ap-1},
                                     {0x1.199999999999ap+1, 0x1.f3949a819042dp-1},
                                     {0x1.d99999999999ap+1, 0x1.ff5fdc948488cp-1},
                                     {0x1.6p+2, 0x1.fffb9f2fc1e91p-1},
                                     {0x1.0333333333333p+3, 0x1.fffff9d11d966p-1},
                                     {0x1.899999999999ap+3, 0x1.ffffffffa4e13p-1},
                                     {0x1.1e66666666666p+4, 0x1.ffffffffffffbp-1},
                                     {0x1.5e66666666666p+4, 0x1p+0}};
  for (const auto& [x, tanh] : values) {
    INFO(x);
    CHECK(math::reference_tanh(x) == tanh);
    CHECK(math::reference_tanh(-x) == -tanh);
  }
  CHECK(math::reference_tanh(HUGE_VAL) == 1.0);
  CHECK(math::reference_tanh(22.0) == 1.0);
  CHECK(std::signbit(math::reference_tanh(-0.0)));
  CHECK(math::reference_tanh(1e-310) == 1e-310);
  CHECK(std::isnan(math::reference_tanh(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace evo
