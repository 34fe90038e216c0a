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

// The largest of any position over all steps; a folded step leaves the snapshot before it.
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

// EvoGymCM's own simulator (EvoGymCM-I, commit 6456214) in the same world with the same actions.
TEST_CASE("a body of one material with factors of stiffness has EvoGymCM's bits") {
  std::vector<double> factors;
  for (int cell = 0; cell < 25; ++cell) factors.push_back(0.5 + (cell * 7 % 16) / 10.0);
  const Body robot = Body::from_rows({"HHHHH", "HHHHH", "HH.HH", "H...H", "H...H"});
  const Model model({{{"robot", with_stiffness(robot, factors), 1, 1}, fixed_ground(60)}},
                    Physics{});
  Batch batch(1);
  batch.place(0, model);
  std::uint64_t number = 5;
  for (int t = 0; t < 100; ++t) {
    for (double& target : batch.targets(0)) {
      number = number * 6364136223846793005U + 1442695040888963407U;
      target = 0.6 + static_cast<double>(number >> 11) * 0x1p-53;
    }
    batch.step();
  }
  std::vector<Vec2> positions(static_cast<std::size_t>(model.points()));
  std::vector<Vec2> velocities(positions.size());
  batch.read_moving(0, positions, velocities);
  CHECK(positions[0].x == 0.1198723709157257);
  CHECK(positions[0].y == 0.59169401347341177);
  double sum = 0.0;
  for (int p = 0; p < model.objects()[0].points; ++p)
    sum += positions[static_cast<std::size_t>(p)].x;
  CHECK(sum == 12.416385056004758);
}

}  // namespace evo
