// Against the benchmark's own simulator (docs/physics.md, "Accuracy").
#include "tests/unit/sim/reference_case.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/unit/sim/fixtures.h"

namespace evo {
namespace {

double largest_difference(std::span<const Vec2> a, std::span<const Vec2> b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max({largest, std::fabs(a[i].x - b[i].x), std::fabs(a[i].y - b[i].y)});
  return largest;
}

// Of any position over all steps; a folded step leaves the snapshot before it.
double error_of(const ReferenceCase& reference) {
  const Model model(reference.world, Physics{});
  REQUIRE(model.points() == reference.points);
  State state = initial_state(model);
  std::vector<Vec2> positions(static_cast<std::size_t>(model.points()));
  read_positions(model, state, positions);
  CHECK(largest_difference(positions, reference.positions_after(0)) == 0.0);
  double error = 0.0;
  for (int t = 0; t < reference.steps; ++t) {
    const auto action = reference.action(t);
    std::copy(action.begin(), action.end(), state.targets.begin());
    if (step_alone(model, state) == LaneStatus::done)
      read_positions(model, state, positions);
    else
      CHECK(t == reference.steps - 1);
    error = std::max(error, largest_difference(positions, reference.positions_after(t + 1)));
  }
  return error;
}

}  // namespace

TEST_CASE("every reference trajectory is reproduced to the last bit") {
  const std::vector<std::string> names = reference_names();
  REQUIRE(names.size() >= 64);
  for (const std::string& name : names) {
    INFO(name);
    CHECK(error_of(read_reference(name)) == 0.0);
  }
}

}  // namespace evo
