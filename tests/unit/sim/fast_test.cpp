// The fast arithmetic: the same bits everywhere, close to the exact ones.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/body/operators.h"
#include "tests/unit/sim/fixtures.h"
#include "tests/unit/sim/reference_case.h"

namespace evo {
namespace {

Physics fast_physics() {
  Physics physics;
  physics.arithmetic = Arithmetic::fast;
  return physics;
}

World walker() {
  return {{fixed_ground(40),
           {"robot", Body::from_rows({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"}), 2, 1}}};
}

// The bits of the last of `width` lanes, all of which do something else.
std::uint64_t hash_after(const Model& model, int steps, std::size_t width) {
  Batch batch(width);
  std::vector<Stream> randoms;
  for (std::size_t i = 0; i < width; ++i) {
    batch.place(i, model);
    randoms.emplace_back(1, "targets", width - 1 - i);
  }
  for (int t = 0; t < steps; ++t) {
    for (std::size_t i = 0; i < width; ++i) draw_targets(batch.targets(i), randoms[i]);
    batch.step();
  }
  return hash_of(batch.state(width - 1));
}

// The greatest distance of a coordinate from the exact one within `steps` steps.
double error_after(const World& world, int steps, std::uint64_t seed) {
  const Model exact(world, Physics{});
  const Model fast(world, fast_physics());
  State a = initial_state(exact);
  State b = initial_state(fast);
  Stream random(seed, "targets");
  double error = 0.0;
  for (int t = 0; t < steps; ++t) {
    draw_targets(a.targets, random);
    b.targets = a.targets;
    step_alone(exact, a);
    step_alone(fast, b);
    for (std::size_t i = 0; i < a.x.size(); ++i)
      error = std::max({error, std::fabs(a.x[i] - b.x[i]), std::fabs(a.y[i] - b.y[i])});
  }
  return error;
}

}  // namespace

TEST_CASE("fast: bits do not depend on width or neighbours, nor on the instruction set with FMA") {
  const IsaGuard guard;
  const Model model(walker(), fast_physics());
  // Pinned: a change here is a change of results, to be explained.
  constexpr std::uint64_t with_fma = 0x7c540664b3665e58;
  constexpr std::uint64_t without_fma = 0x715e9894c343b077;
  for (const std::string& isa : available_isas()) {
    select_isa(isa);
    const bool has_fma = isa == "x86-64-v3" || isa == "x86-64-v4";
    for (const std::size_t width : {1U, 2U, 3U, 4U, 5U, 8U, 11U}) {
      INFO(isa << ", " << width << " lanes");
      CHECK(hash_after(model, 50, width) == (has_fma ? with_fma : without_fma));
    }
  }
}

// A robot that drops past the ground it was to walk on, down to the world floor.
World faller() {
  return {{fixed_ground(4),
           {"robot", Body::from_rows({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"}), 6, 0}}};
}

TEST_CASE("fast: the world floor carries, alone and side by side") {
  const Model model(faller(), fast_physics());
  CHECK(hash_after(model, 60, 1) == hash_after(model, 60, 8));
  State state = initial_state(model);
  for (int t = 0; t < 100; ++t) {
    step_alone(model, state);
  }
  const auto [lowest, highest] = std::minmax_element(state.y.begin(), state.y.end());
  CHECK(*lowest > -0.01);
  CHECK(*lowest < 0.01);
  CHECK(*highest < 0.6);
  CHECK(error_after(faller(), 3, 1) < 1e-3);  // its friction chatters
}

TEST_CASE("fast: worlds of every kind have the same bits alone and side by side") {
  for (const char* name : {"Traverser-v0_A", "BridgeWalker-v0_A", "Climber-v1_B", "Catcher-v0_B"}) {
    const Model model(read_reference(name).world, fast_physics());
    INFO(name);
    CHECK(hash_after(model, 4, 1) == hash_after(model, 4, 4));
  }
}

TEST_CASE("fast stays near exact for a hundred steps") {
  CHECK(error_after(walker(), 100, 1) < 3e-5);
  for (const char* name : {"Carrier-v0_A", "BridgeWalker-v0_A", "Climber-v1_B", "Jumper-v0_A"}) {
    INFO(name);
    CHECK(error_after(read_reference(name).world, 20, 2) < 3e-5);
  }
}

TEST_CASE("fast is not exact, and changes nothing but rounding") {
  const Model exact(walker(), Physics{});
  const Model fast(walker(), fast_physics());
  CHECK(hash_after(exact, 5, 1) != hash_after(fast, 5, 1));
  CHECK(error_after(walker(), 1, 1) < 3e-7);
}

// As docs/fast.md says: far off are only worlds with something balanced on an edge.
TEST_CASE("fast: after one step most reference cases are about 1e-7 from exact") {
  std::vector<double> errors;
  for (const std::string& name : reference_names())
    errors.push_back(error_after(read_reference(name).world, 1, 1));
  std::sort(errors.begin(), errors.end());
  const std::size_t n = errors.size();
  REQUIRE(n > 60);
  CHECK(errors.front() > 0.0);
  CHECK(errors[n / 2] < 2e-7);
  CHECK(errors[n * 85 / 100] < 2e-6);
  CHECK(errors.back() < 1e-2);
}

}  // namespace evo
