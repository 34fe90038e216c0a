#include "libevo/control/planner.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
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

TEST_CASE("plans climb from a moment") {
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
  int steps = 0;
  std::vector<double> best;
  std::vector<double> earned(4);
  for (int round = 0; round < 8; ++round) {
    std::fill(earned.begin(), earned.end(), 0.0);
    const auto& outcomes = planner.simulate(env, from, [&](std::size_t lane) {
      ++steps;
      earned[lane] += env.rewards()[lane];
    });
    best.push_back(-std::numeric_limits<double>::infinity());
    for (const Planner::Outcome& outcome : outcomes) {
      CHECK_FALSE(outcome.is_over);
      best.back() = std::max(best.back(), outcome.value);
    }
    planner.climb();
  }
  CHECK(steps == 8 * 4 * window);
  CHECK(*std::max_element(best.begin() + 1, best.end()) > best.front() + 0.04);
}

TEST_CASE("a plan ends with its episode, and climbs by what it earned until then") {
  const Arena arena(test::walker(10), test::small_body());
  VecEnv env(arena, 2);
  env.reset(0, {});
  Planner planner(arena);
  const Plan rest(static_cast<std::size_t>(20 * arena.action_length()), 0.1);
  planner.begin({rest, rest});
  int steps = 0;
  const auto& outcomes = planner.simulate(env, env.save(0), [&](std::size_t) { ++steps; });
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

TEST_CASE("a free planner earns more than rest, whatever episodes run beside it") {
  const Arena arena(test::walker(80), test::body_a());
  EvaluationSettings evaluation;
  evaluation.episodes = 2;
  evaluation.jitter = 1e-3;
  const PlannerController planner{.window = 32, .committed = 16, .rounds = 5, .lanes = 3};
  const Evaluation planned = evaluate(arena, planner, evaluation);
  const SineController rest = travelling_wave(arena.action_length(), 0.0, 1.0, 0.0);
  CHECK(planned.mean() > evaluate(arena, rest, evaluation).mean() + 0.1);
  CHECK(planned.returns[0] != planned.returns[1]);
  evaluation.lanes = 1;
  CHECK(evaluate(arena, planner, evaluation).returns == planned.returns);
}

TEST_CASE("a planner comes back to the way of a sequence") {
  const Arena arena(test::walker(40), test::body_a());
  ReplayController sequence{{}, arena.action_length()};
  Stream random(5, "sequence");
  for (int t = 0; t < 40; ++t)
    for (int i = 0; i < arena.action_length(); ++i)
      sequence.actions.push_back(random.integer(0, 1) == 0 ? 0.7 : 1.4);
  const auto ends = [&](const Controller& controller, double jitter) {
    std::vector<Vec2> points;
    EvaluationSettings evaluation;
    evaluation.jitter = jitter;
    evaluate(arena, controller, evaluation, [&](const EpisodeMoment& moment) {
      const auto now = moment.env.positions(moment.lane);
      points.assign(now.begin(), now.end());
    });
    return points;
  };
  const auto aim = ends(sequence, 0.0);
  const auto off = [&](const std::vector<Vec2>& points) {
    double sum = 0.0;
    for (std::size_t p = 0; p < points.size(); ++p)
      sum += std::hypot(points[p].x - aim[p].x, points[p].y - aim[p].y);
    return sum;
  };
  const PlannerController holding{
      .window = 12, .committed = 4, .rounds = 6, .lanes = 4, .sequence = sequence};
  const double alone = off(ends(sequence, 0.05));
  CHECK(off(ends(holding, 0.05)) < 0.7 * alone);

  ReplayController other = sequence;
  other.actuators += 1;
  PlannerController wrong = holding;
  wrong.sequence = other;
  CHECK_THROWS(evaluate(arena, wrong, EvaluationSettings{}));
  wrong = holding;
  wrong.rounds = 0;
  CHECK_THROWS(evaluate(arena, wrong, EvaluationSettings{}));
}
