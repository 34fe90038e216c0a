#include "libevo/control/planner.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "libevo/base/random.h"
#include "libevo/control/evaluate.h"
#include "tests/unit/control/arena.h"

using namespace evo;

TEST_CASE("a plan aims for the targets that it was made of") {
  const Arena arena(test::walker(40), test::small_body());
  const Planner planner(arena);
  const auto actuators = static_cast<std::size_t>(arena.action_length());
  std::vector<double> targets(2 * actuators, 1.25);
  targets[0] = 0.75;
  targets[actuators] = 5.0;  // nearly the end of the range
  const Plan plan = planner.plan_of(targets);
  std::vector<double> aimed(actuators);
  planner.targets_of(plan, 0, aimed);
  CHECK(aimed == std::vector<double>(targets.begin(), targets.begin() + aimed.size()));
  planner.targets_of(plan, 1, aimed);
  CHECK(aimed[0] > 1.59);
  CHECK(aimed[0] <= 1.6);
  CHECK(planner.longest_window(8) > 64);
}

TEST_CASE("plans climb from a moment, and are counted") {
  const Arena arena(test::walker(60), test::body_a());
  VecEnv env(arena, 4);
  env.reset(0, {});
  const auto from = env.save(0);
  Planner planner(arena);
  Stream random(3, "plans");
  std::vector<Plan> plans(4);
  const int window = 24;
  for (Plan& plan : plans)
    for (int i = 0; i < window * arena.action_length(); ++i)
      plan.push_back(0.3 * random.gaussian());
  planner.begin(plans);
  std::int64_t steps = 0;
  std::int64_t seen = 0;
  std::vector<double> best;
  std::vector<double> earned(4);
  for (int round = 0; round < 8; ++round) {
    std::fill(earned.begin(), earned.end(), 0.0);
    const auto& outcomes =
        planner.simulate(env, from, steps, [&](std::size_t lane, std::span<const double> targets) {
          ++seen;
          earned[lane] += env.rewards()[lane];
          CHECK(targets.size() == static_cast<std::size_t>(arena.action_length()));
        });
    best.push_back(-std::numeric_limits<double>::infinity());
    for (const Planner::Outcome& outcome : outcomes) {
      CHECK_FALSE(outcome.is_over);
      best.back() = std::max(best.back(), outcome.value);
    }
    planner.climb();
  }
  CHECK(steps == 8 * 4 * window);
  CHECK(seen == steps);
  CHECK(*std::max_element(best.begin() + 1, best.end()) > best.front() + 0.04);
}

TEST_CASE("a plan ends with its episode, and climbs by what it earned until then") {
  const Arena arena(test::walker(10), test::small_body());
  VecEnv env(arena, 2);
  env.reset(0, {});
  Planner planner(arena);
  const Plan rest(static_cast<std::size_t>(20 * arena.action_length()), 0.1);
  planner.begin({rest, rest});
  std::int64_t steps = 0;
  const auto& outcomes =
      planner.simulate(env, env.save(0), steps, [](std::size_t, std::span<const double>) {});
  CHECK(steps == 20);
  CHECK(outcomes[0].is_over);
  CHECK(outcomes[1].value == outcomes[0].value);
  planner.climb();
  const auto changed = [&](std::size_t from, std::size_t to) {
    const auto a = static_cast<std::size_t>(arena.action_length());
    return !std::equal(planner.plan(0).begin() + static_cast<std::ptrdiff_t>(from * a),
                       planner.plan(0).begin() + static_cast<std::ptrdiff_t>(to * a), rest.begin());
  };
  CHECK(changed(0, 10));
  CHECK_FALSE(changed(10, 20));
}
