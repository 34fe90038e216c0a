#include "libevo/control/replanner.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/base/random.h"
#include "libevo/control/evaluate.h"
#include "tests/unit/control/arena.h"

using namespace evo;

TEST_CASE("a plan ends with its episode") {
  const Arena arena(test::walker(10), test::small_body());
  const PlannerController planner{.window = 20, .committed = 20, .rounds = 3, .lanes = 2};
  const Evaluation planned = evaluate(arena, planner, EvaluationSettings{});
  CHECK(planned.lengths == std::vector<int>{10});
}

TEST_CASE("a free planner earns more than rest, whatever episodes run beside it") {
  const Arena arena(test::walker(80), test::body_a());
  EvaluationSettings evaluation{.episodes = 2, .jitter = 1e-3};
  const auto planner = [](int rounds) {
    return PlannerController{.window = 32, .committed = 16, .rounds = rounds, .lanes = 3};
  };
  const Evaluation planned = evaluate(arena, planner(5), evaluation);
  const SineController rest = travelling_wave(arena.action_length(), 0.0, 1.0, 0.0);
  CHECK(planned.mean() > evaluate(arena, rest, evaluation).mean() + 0.1);
  CHECK(planned.mean() > evaluate(arena, planner(1), evaluation).mean() + 0.1);
  CHECK(planned.returns[0] != planned.returns[1]);
  evaluation.threads = 3;
  CHECK(evaluate(arena, planner(5), evaluation).returns == planned.returns);
  evaluation.lanes = 1;
  CHECK(evaluate(arena, planner(5), evaluation).returns == planned.returns);
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
    evaluate(arena, controller, {.jitter = jitter}, [&](const EpisodeMoment& moment) {
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
      .window = 24, .committed = 4, .rounds = 6, .lanes = 8, .sequence = sequence};
  const double alone = off(ends(sequence, 0.05));
  const double held = off(ends(holding, 0.05));
  CAPTURE(alone, held);
  CHECK(held < 0.3 * alone);

  ReplayController other = sequence;
  other.actuators += 1;
  PlannerController wrong = holding;
  wrong.sequence = other;
  CHECK_THROWS(evaluate(arena, wrong, EvaluationSettings{}));
  wrong = holding;
  wrong.rounds = 0;
  CHECK_THROWS(evaluate(arena, wrong, EvaluationSettings{}));
}
