// Roots and quotients from multiplications against IEEE's, on every instruction
// set of this machine that has a fused multiply-add.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/unit/sim/exact_test.cpp"
#include "libevo/sim/targets.h"
//
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <cmath>
#include <cstddef>

#include "libevo/sim/exact-inl.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

// How many of sqrt(s[i]), a[i] / sqrt(s[i]) and a[i] / 6 differ from IEEE's.
std::size_t count_wrong(const double* s, const double* a, std::size_t n) {
  const hn::ScalableTag<double> d;
  using V = hn::Vec<hn::ScalableTag<double>>;
  constexpr std::size_t width = hn::MaxLanes(d);
  HWY_ALIGN double root[2 * width], quotient[2 * width], sixth[width];
  std::size_t wrong = 0;
  for (std::size_t i = 0; i + 2 * width <= n; i += 2 * width) {
#if HWY_NATIVE_FMA
    const V square[2] = {hn::LoadU(d, s + i), hn::LoadU(d, s + i + width)};
    const V numerator[2] = {hn::LoadU(d, a + i), hn::LoadU(d, a + i + width)};
    V length[2], reciprocal[2], q[2];
    RootsOf(d, square, length, reciprocal);
    QuotientsOf(d, numerator, length, reciprocal, q);
    for (std::size_t k = 0; k < 2; ++k) {
      hn::Store(length[k], d, root + k * width);
      hn::Store(q[k], d, quotient + k * width);
    }
    for (std::size_t k = 0; k < 2 * width; ++k) {
      wrong += root[k] != std::sqrt(s[i + k]);
      wrong += quotient[k] != a[i + k] / std::sqrt(s[i + k]);
    }
#else
    static_cast<void>(s);
    static_cast<void>(root);
    static_cast<void>(quotient);
#endif
    hn::Store(SixthOf(d, V(hn::LoadU(d, a + i))), d, sixth);
    for (std::size_t k = 0; k < width; ++k) wrong += sixth[k] != a[i + k] / 6.0;
  }
  return wrong;
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "libevo/base/random.h"
#include "tests/unit/sim/fixtures.h"

namespace evo {
namespace {

HWY_EXPORT(count_wrong);

// Numbers whose roots come nearest to the middle between two doubles. With
// root = m + 1/2, m an integer of 53 bits, and s = n * 2^k an integer of 105 or
// 106 bits: (2m + 1)^2 - 4s = r is small, so 2m + 1 is a root of r modulo
// 2^(k+2). Such roots exist for r = 1 mod 8; each bit of one is found from the
// bits below it.
std::vector<double> hardest_squares() {
  using Wide = unsigned __int128;
  std::vector<double> found;
  for (const int k : {52, 53}) {
    for (int r = -4095; r < 4096; r += 8) {
      std::uint64_t odd = 1;  // odd^2 = r modulo 2^(bit + 1), for growing bit
      for (int bit = 3; bit < k + 2; ++bit) {
        const std::uint64_t wanted = static_cast<std::uint64_t>(static_cast<std::int64_t>(r));
        const std::uint64_t error = odd * odd - wanted;
        if ((error >> bit) & 1) odd += std::uint64_t{1} << (bit - 1);
      }
      const std::uint64_t modulus = std::uint64_t{1} << (k + 2);
      for (std::uint64_t root :
           {odd, modulus - odd % modulus, odd + modulus / 2, modulus / 2 - odd % (modulus / 2)}) {
        for (root %= modulus; root < (std::uint64_t{1} << 54); root += modulus) {
          if (root < (std::uint64_t{1} << 53)) continue;
          const Wide square =
              static_cast<Wide>(root) * root - static_cast<Wide>(static_cast<__int128>(r));
          const Wide s = square >> 2;
          if ((s & ((Wide{1} << k) - 1)) != 0) continue;  // does not end in k zeros
          const auto mantissa = static_cast<std::uint64_t>(s >> k);
          if (mantissa >> 53 == 0)
            found.push_back(std::ldexp(static_cast<double>(mantissa), k - 105));
        }
      }
    }
  }
  return found;
}

std::size_t wrong_on_all_isas(std::vector<double> s, std::vector<double> a) {
  const IsaGuard guard;
  while (s.size() % 16 != 0) {
    s.push_back(1.0);
    a.push_back(1.0);
  }
  std::size_t wrong = 0;
  for (const std::string& isa : available_isas()) {
    select_isa(isa);
    wrong += HWY_DYNAMIC_DISPATCH(count_wrong)(s.data(), a.data(), s.size());
  }
  return wrong;
}

}  // namespace

TEST_CASE("roots and quotients without the divider are IEEE's: random numbers") {
  Stream random(3, "exact");
  std::vector<double> s, a;
  for (int i = 0; i < 1 << 18; ++i) {
    s.push_back((1.0 + 3.0 * random.uniform()) * std::ldexp(1.0, random.integer(-40, 40)));
    a.push_back((random.uniform() - 0.5) * std::ldexp(1.0, random.integer(-60, 60)));
  }
  CHECK(wrong_on_all_isas(s, a) == 0);
}

TEST_CASE("roots and quotients without the divider are IEEE's: hardest numbers") {
  std::vector<double> s = hardest_squares();
  CHECK(s.size() > 500);
  std::vector<double> a;
  for (std::size_t i = 0; i < s.size(); ++i) a.push_back(1.0 + static_cast<double>(i) * 0x1p-52);
  CHECK(wrong_on_all_isas(s, a) == 0);
}

TEST_CASE("roots and quotients without the divider are IEEE's: mantissas of ones and zeros") {
  std::vector<double> s, a;
  for (int i = 0; i < 54; ++i) {
    for (int j = 1; j < 53; ++j) {  // at 0 and 53 a is a power of two: the known exception
      const double root = 2.0 - std::ldexp(1.0, -i);
      s.push_back(root * root);
      a.push_back(1.0 + std::ldexp(1.0, -j));
      s.push_back(1.0 + std::ldexp(1.0, -i));
      a.push_back(2.0 - std::ldexp(1.0, -j));
    }
  }
  CHECK(wrong_on_all_isas(s, a) == 0);
}

}  // namespace evo
#endif
