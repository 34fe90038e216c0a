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
#include <memory>

#include "libevo/sim/alone-inl.h"
#include "libevo/sim/control_step-inl.h"
#include "libevo/sim/exact-inl.h"
#include "libevo/sim/side_by_side-inl.h"

#ifndef EVO_CHOICE
#define EVO_CHOICE
namespace evo {
// Kernels; each processor is given one or two of them (kernels.cpp).
enum class Choice { helped, narrow, wide };
}  // namespace evo
#endif

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

#if HWY_NATIVE_FMA
inline constexpr bool has_fma = true;
#else
inline constexpr bool has_fma = false;
#endif

bool HasFma() { return has_fma; }

// A register of numbers.
constexpr hn::ScalableTag<double> d;
using V = hn::Vec<hn::ScalableTag<double>>;
constexpr std::size_t width = hn::MaxLanes(d);

// How many of sqrt(s[i]), a[i] / sqrt(s[i]) and a[i] / 6 differ from IEEE's; quotients
// that AreOrdinary() warns of do not count.
std::size_t count_wrong([[maybe_unused]] const double* s, const double* a, std::size_t n) {
  [[maybe_unused]] HWY_ALIGN double root[2 * width], quotient[2 * width];
  HWY_ALIGN double sixth[width];
  std::size_t wrong = 0;
  for (std::size_t i = 0; i + 2 * width <= n; i += 2 * width) {
#if HWY_NATIVE_FMA
    const V square[2] = {hn::LoadU(d, s + i), hn::LoadU(d, s + i + width)};
    const V numerator[2] = {hn::LoadU(d, a + i), hn::LoadU(d, a + i + width)};
    V length[2], reciprocal[2], q[2];
    RootsOf(d, square, length, reciprocal);
    QuotientsOf(d, numerator, length, reciprocal, q);
    const bool ordinary = AreOrdinary(d, square, numerator, length);
    for (std::size_t k = 0; k < 2; ++k) {
      hn::Store(length[k], d, root + k * width);
      hn::Store(q[k], d, quotient + k * width);
    }
    for (std::size_t k = 0; k < 2 * width; ++k) {
      wrong += root[k] != std::sqrt(s[i + k]);
      wrong += ordinary && quotient[k] != a[i + k] / std::sqrt(s[i + k]);
    }
#endif
    hn::Store(SixthOf(d, V(hn::LoadU(d, a + i))), d, sixth);
    for (std::size_t k = 0; k < width; ++k) wrong += sixth[k] != a[i + k] / 6.0;
  }
  return wrong;
}

// How many roots of s[i] differ from IEEE's when the estimates of their reciprocals
// are off by the factor 1 + `error`, as another maker's processor may have it.
std::size_t count_wrong_roots([[maybe_unused]] const double* s, [[maybe_unused]] std::size_t n,
                              [[maybe_unused]] double error) {
  std::size_t wrong = 0;
#if HWY_NATIVE_FMA
  HWY_ALIGN double root[width];
  for (std::size_t i = 0; i + width <= n; i += width) {
    const V square[1] = {hn::LoadU(d, s + i)};
    V length[1];
    V y[1] = {hn::Div(hn::Set(d, 1.0 + error), hn::Sqrt(square[0]))};
    RefineRoots(d, square, length, y);
    hn::Store(length[0], d, root);
    for (std::size_t k = 0; k < width; ++k) wrong += root[k] != std::sqrt(s[i + k]);
  }
#endif
  return wrong;
}

// How many of a[i] / d[i] differ from IEEE's, the reciprocals beginning `off` units in
// the last place off; `ordinary` counts those that AreOrdinary() lets pass.
std::size_t count_wrong_quotients([[maybe_unused]] const double* a,
                                  [[maybe_unused]] const double* divisors,
                                  [[maybe_unused]] std::size_t n, [[maybe_unused]] int off,
                                  [[maybe_unused]] std::size_t& ordinary) {
  std::size_t wrong = 0;
#if HWY_NATIVE_FMA
  HWY_ALIGN double quotient[width];
  for (std::size_t i = 0; i + width <= n; i += width) {
    const V numerator[1] = {hn::LoadU(d, a + i)};
    const V divisor[1] = {hn::LoadU(d, divisors + i)};
    const V square[1] = {hn::Mul(divisor[0], divisor[0])};
    V reciprocal[1] = {hn::Div(hn::Set(d, 1.0), divisor[0])};
    const hn::RebindToSigned<decltype(d)> bits;
    reciprocal[0] = hn::BitCast(d, hn::Add(hn::BitCast(bits, reciprocal[0]), hn::Set(bits, off)));
    if (!AreOrdinary(d, square, numerator, divisor)) continue;
    ordinary += width;
    V q[1];
    QuotientsOf(d, numerator, divisor, reciprocal, q);
    hn::Store(q[0], d, quotient);
    for (std::size_t k = 0; k < width; ++k) wrong += quotient[k] != a[i + k] / divisors[i + k];
  }
#endif
  return wrong;
}

// Control steps of one lane, with two of three roots and quotients from the
// multipliers, whatever the width.
using Helped = SideBySide<HWY_NATIVE_FMA ? Divider::helped : Divider::alone>;
#if HWY_TARGET != HWY_SCALAR
using Narrow = Alone<4>;
using Wide = Alone<8>;
#else
using Narrow = SideBySide<Divider::alone>;
using Wide = Narrow;
#endif

Layout ChosenLayout(Choice choice) {
  if (choice == Choice::helped) return LayoutOf<Helped>();
  return choice == Choice::narrow ? LayoutOf<Narrow>() : LayoutOf<Wide>();
}
void StepChosen(Choice choice, Group& group, Workspace& workspace) {
  if (choice == Choice::helped)
    ControlStep<Helped>(group, workspace).run();
  else if (choice == Choice::narrow)
    ControlStep<Narrow>(group, workspace).run();
  else
    ControlStep<Wide>(group, workspace).run();
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
HWY_EXPORT(count_wrong_quotients);
HWY_EXPORT(count_wrong_roots);
HWY_EXPORT(HasFma);
HWY_EXPORT(ChosenLayout);
HWY_EXPORT(StepChosen);

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
  while (s.size() % 16 != 0) {
    s.push_back(1.0);
    a.push_back(1.0);
  }
  std::size_t wrong = 0;
  for_each_isa([&] { wrong += HWY_DYNAMIC_DISPATCH(count_wrong)(s.data(), a.data(), s.size()); });
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
    for (int j = 0; j < 54; ++j) {
      const double root = 2.0 - std::ldexp(1.0, -i);
      s.push_back(root * root);
      a.push_back(1.0 + std::ldexp(1.0, -j));
      s.push_back(1.0 + std::ldexp(1.0, -i));
      a.push_back(2.0 - std::ldexp(1.0, -j));
    }
  }
  CHECK(wrong_on_all_isas(s, a) == 0);
}

namespace {

// Where a quotient is most likely to go wrong: mantissas next to all ones and to one,
// in numerator and divisor.
double hard_operand(Stream& random) {
  constexpr std::uint64_t ones = (std::uint64_t{1} << 52) - 1;
  const std::uint32_t choice = random.bits();
  const std::uint64_t few = (choice >> 2) & 63;
  const std::uint64_t any = std::uint64_t{random.bits()} << 20 | choice >> 12;
  const std::uint64_t mantissas[] = {ones - few, few, any, ones & ~(std::uint64_t{1} << few % 52)};
  const int exponent = static_cast<int>((choice >> 8) % 41) - 20;
  return std::ldexp(1.0 + std::ldexp(static_cast<double>(mantissas[choice & 3]), -52), exponent);
}

// Blocks of hard operands against the divider, for reciprocals that begin up to three
// units in the last place off.
void check_hard_quotients(int blocks) {
  const IsaGuard guard;
  constexpr std::size_t size = 4096;
  std::vector<double> a(size), d(size);
  std::size_t ordinary = 0;
  for (int block = 0; block < blocks; ++block) {
    Stream random(5, "quotients", static_cast<std::uint64_t>(block));
    for (std::size_t i = 0; i < size; ++i) {
      a[i] = hard_operand(random);
      d[i] = hard_operand(random);
    }
    for (int off = -3; off <= 3; ++off)
      REQUIRE(HWY_DYNAMIC_DISPATCH(count_wrong_quotients)(a.data(), d.data(), size, off,
                                                          ordinary) == 0);
  }
  if (HWY_DYNAMIC_DISPATCH(HasFma)()) CHECK(ordinary > static_cast<std::size_t>(blocks) * size * 5);
}

}  // namespace

TEST_CASE("roots without the divider are IEEE's whatever the estimate") {
  std::vector<double> s = hardest_squares();
  while (s.size() % 8 != 0) s.push_back(1.0);
  // Estimates in single precision are off by at most 1.5 * 2^-12.
  for (int k = -1000; k <= 1000; ++k)
    REQUIRE(HWY_DYNAMIC_DISPATCH(count_wrong_roots)(s.data(), s.size(), k * 1.6e-3 * 0x1p-12) == 0);
}

TEST_CASE("the exceptional divisors are noticed") {
  if (!HWY_DYNAMIC_DISPATCH(HasFma)()) return;
  const double odd = 2.0 - 0x1p-52;  // all bits of the mantissa are ones
  const std::vector<double> one(16, 1.0);
  for (std::size_t lane = 0; lane < 8; ++lane) {
    std::vector<double> d(16, 1.5);
    std::size_t ordinary = 0;
    HWY_DYNAMIC_DISPATCH(count_wrong_quotients)(one.data(), d.data(), 16, 0, ordinary);
    CHECK(ordinary == 16);
    for (const double strange : {odd, odd / 64, 0.0, HUGE_VAL, std::nan(""), 0x1p-61, 0x1p61}) {
      ordinary = 0;
      d[lane] = strange;
      HWY_DYNAMIC_DISPATCH(count_wrong_quotients)(one.data(), d.data(), 16, 0, ordinary);
      CHECK(ordinary < 16);
    }
    std::vector<double> a = one;
    for (const double strange : {0.0, -0.0, 0x1p-501, -HUGE_VAL, std::nan("")}) {
      ordinary = 0;
      a[lane] = strange;
      HWY_DYNAMIC_DISPATCH(count_wrong_quotients)(a.data(), one.data(), 16, 0, ordinary);
      CHECK(ordinary < 16);
    }
  }
}

TEST_CASE("quotients without the divider are IEEE's: operands near powers of two") {
  check_hard_quotients(100);
}

TEST_CASE("quotients without the divider are IEEE's: a billion of them", "[.slow]") {
  check_hard_quotients(40'000);
}

namespace {

void check_same_bits(Choice choice) {
  const Model model({{fixed_ground(40), {"robot", body_a(), 2, 1}}}, Physics{});
  Batch plain(1);
  plain.place(0, model);
  // The same start in a group of one lane, as wide as a register.
  Lane lane;
  lane.model = std::shared_ptr<const Model>(std::shared_ptr<const Model>(), &model);
  lane.kind = std::make_shared<Kind>(lane.model);
  prepare_lists(model.compiled(), lane.contacts);
  Group group(lane.kind, HWY_DYNAMIC_DISPATCH(ChosenLayout)(choice));
  group.lanes = {&lane};
  const Plan& plan = lane.kind->plan();
  const State start = plain.state(0);
  for (std::size_t p = 0; p < start.positions.size(); ++p) {
    const std::size_t o = pair_offset(plan.site_of[p], group.width());
    const auto [x, y] = start.positions[p];
    group.rows.position[o] = group.rows.previous[o] = x;
    group.rows.position[o + group.width()] = group.rows.previous[o + group.width()] = y;
  }
  Workspace workspace;
  Stream random(1, "targets");
  for (int t = 0; t < 50; ++t) {
    draw_targets(plain.targets(0), random);
    lane.targets.assign(plain.targets(0).begin(), plain.targets(0).end());
    plain.step();
    HWY_DYNAMIC_DISPATCH(StepChosen)(choice, group, workspace);
  }
  const State end = plain.state(0);
  for (std::size_t p = 0; p < end.positions.size(); ++p) {
    const std::size_t o = pair_offset(plan.site_of[p], group.width());
    CHECK(Vec2{group.rows.position[o], group.rows.position[o + group.width()]} == end.positions[p]);
    CHECK(Vec2{group.rows.velocity[o], group.rows.velocity[o + group.width()]} ==
          end.velocities[p]);
  }
}

}  // namespace

TEST_CASE("every kernel has the same bits") {
  for_each_isa([] {
    for (const Choice choice : {Choice::helped, Choice::narrow, Choice::wide}) {
      INFO("kernel " << static_cast<int>(choice));
      check_same_bits(choice);
    }
  });
}

}  // namespace evo
#endif
