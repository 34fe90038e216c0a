#include "libevo/evolve/cppn_neat.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "libevo/evolve/cppn.h"
#include "tests/unit/expect.h"

using namespace evo;

namespace {

// Actuators in the lower rows, rigid voxels above: something a pattern can express.
double layered(const Body& body) {
  double sum = 0.0;
  for (int row = 0; row < body.rows; ++row)
    for (int col = 0; col < body.cols; ++col) {
      const Voxel v = body.at(row, col);
      sum += row >= body.rows / 2 ? is_actuator(v) : v == Voxel::rigid;
    }
  return sum;
}

struct Run {
  std::vector<double> best;  // of each generation
  std::vector<std::string> ids;
  bool operator==(const Run&) const = default;
};

Run evolve(std::uint64_t seed, int generations) {
  NeatSettings settings;
  settings.pop_size = 20;
  NeatState state;
  std::set<std::string> seen;
  Run run;
  auto robots = first_robots(settings, 5, 5, seen, state, seed);
  for (int g = 0;; ++g) {
    std::vector<Scored> scored;
    for (const CppnRobot& robot : robots) {
      REQUIRE(is_valid_robot(robot.body));
      REQUIRE(robot.body == decode(robot.genome, 5, 5));
      run.ids.push_back(identity(robot.body));
      scored.push_back({robot.genome, layered(robot.body)});
    }
    const auto best =
        std::max_element(scored.begin(), scored.end(),
                         [](const Scored& a, const Scored& b) { return a.fitness < b.fitness; });
    run.best.push_back(best->fitness);
    if (g == generations) return run;
    robots = next_robots(settings, 5, 5, scored, seen, state, seed);
    REQUIRE(robots.size() >= 20);
  }
}

}  // namespace

TEST_CASE("a run over bodies meets every body once, gets better and can be repeated") {
  double first = 0.0;
  double last = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Run run = evolve(seed, 15);
    const std::set<std::string> ids(run.ids.begin(), run.ids.end());
    REQUIRE(ids.size() == run.ids.size());
    first += run.best.front();
    last += *std::max_element(run.best.begin(), run.best.end());
    if (seed == 1) CHECK(evolve(seed, 15) == run);
  }
  CHECK(last / 5 > first / 5 + 3);
  CHECK(evolve(2, 3) != evolve(3, 3));
}

TEST_CASE("bodies to avoid are avoided") {
  NeatSettings settings;
  settings.pop_size = 30;
  NeatState state;
  std::set<std::string> seen;
  const auto robots = first_robots(settings, 4, 4, seen, state, 2);
  CHECK(seen.size() == 30);
  for (const CppnRobot& robot : first_robots(settings, 4, 4, seen, state, 2))
    for (const CppnRobot& other : robots) REQUIRE_FALSE(robot.body == other.body);
}

TEST_CASE("a shape without enough robots is an error, not an endless search") {
  NeatSettings settings;
  settings.pop_size = 3;
  NeatState state;
  std::set<std::string> seen;
  test::expect_error(Failure::work, Catch::Contains("2 of 3 found"),
                     [&] { first_robots(settings, 1, 1, seen, state, 2); });
}

TEST_CASE("networks of other shapes are refused") {
  NeatSettings settings;
  settings.num_outputs = 4;
  NeatState state;
  std::set<std::string> seen;
  CHECK_THROWS_AS(first_robots(settings, 5, 5, seen, state, 2), Error);
}
