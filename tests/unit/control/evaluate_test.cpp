#include "libevo/control/evaluate.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/unit/control/arena.h"

using namespace evo;

namespace {

Policy policy_for(const Arena& arena) {
  Stream stream(2, "policy");
  Policy policy;
  const int d = arena.observation_length();
  policy.actor = orthogonal_network(d, {8}, arena.action_length(), 1.4, 2.0, stream);
  policy.critic = orthogonal_network(d, {8}, 1, 1.4, 1.0, stream);
  policy.log_std = Vector::Zero(arena.action_length());
  policy.normalizer.mean = Eigen::VectorXd::Zero(d);
  policy.normalizer.variance = Eigen::VectorXd::Constant(d, 0.01);
  policy.normalizer.count = 1;
  return policy;
}

}  // namespace

TEST_CASE("episodes do not depend on those beside them, for any controller") {
  const Arena arena(test::walker(12), test::small_body());
  const Controller controller =
      GENERATE_REF(Controller(policy_for(arena)), Controller(travelling_wave(5, 0.4, 9.0, 1.0)),
                   Controller(RandomController{}));
  EvaluationSettings settings{.episodes = 5, .seed = 3, .jitter = 1e-3, .lanes = 1};
  const Evaluation alone = evaluate(arena, controller, settings);
  REQUIRE(alone.returns.size() == 5);
  CHECK(alone.lengths == std::vector<int>(5, 12));
  CHECK(alone.returns[0] != alone.returns[1]);  // jittered
  for (const int lanes : {2, 3, 16}) {
    settings.lanes = lanes;
    const Evaluation together = evaluate(arena, controller, settings);
    CHECK(together.returns == alone.returns);
    CHECK(together.lengths == alone.lengths);
  }
  // The first episodes of fewer are the same episodes.
  settings.episodes = 2;
  CHECK(evaluate(arena, controller, settings).returns[1] == alone.returns[1]);
  settings.seed = 4;
  CHECK(evaluate(arena, controller, settings).returns[1] != alone.returns[1]);
}

TEST_CASE("recorded actions give the episode again, and end it") {
  const Arena arena(test::walker(20), test::small_body());
  ReplayController replay{{}, arena.action_length()};
  double sum = 0.0;
  int moments = 0;
  int last = 0;
  EvaluationSettings settings{.max_steps = 15};
  const Evaluation original =
      evaluate(arena, RandomController{}, settings, [&](const EpisodeMoment& moment) {
        ++moments;
        last += moment.last ? 1 : 0;
        CHECK(moment.episode == 0);
        CHECK(moment.targets.empty() == (moments == 1));
        if (moment.targets.empty()) return;
        replay.actions.insert(replay.actions.end(), moment.targets.begin(), moment.targets.end());
        sum += moment.env.rewards()[static_cast<std::size_t>(moment.lane)];
      });
  CHECK(moments == 16);
  CHECK(last == 1);
  CHECK(original.returns[0] == sum);
  CHECK(original.lengths[0] == 15);
  settings.max_steps = 0;
  const Evaluation again = evaluate(arena, replay, settings);
  CHECK(again.returns == original.returns);
  CHECK(again.lengths == original.lengths);
}

TEST_CASE("sine waves follow their formula") {
  const SineController wave = travelling_wave(3, 0.3, 20.0, 0.7);
  std::vector<double> targets(3);
  act(wave, 13, targets);
  for (int i = 0; i < 3; ++i)
    CHECK(targets[static_cast<std::size_t>(i)] ==
          Approx(1.1 + 0.3 * std::sin(2.0 * M_PI * 13.0 / 20.0 + 0.7 * i)));
}

TEMPLATE_TEST_CASE("many open-loop controllers at once are each as if alone", "", SineController,
                   ReplayController) {
  const Arena arena(test::walker(10), test::small_body());
  std::vector<TestType> controllers;
  for (int i = 0; i < 5; ++i) {
    const SineController wave = travelling_wave(5, 0.1 * i, 8.0 + i, 0.9);
    if constexpr (std::is_same_v<TestType, SineController>)
      controllers.push_back(wave);
    else
      controllers.push_back(recorded(arena, wave, {}));
  }
  const EvaluationSettings settings{.episodes = 2, .jitter = 1e-3};
  const OpenLoopEvaluation all = evaluate_each(arena, controllers, settings);
  CHECK(all.steps == 5 * 2 * 10);
  for (std::size_t i = 0; i < controllers.size(); ++i)
    CHECK(all.means[i] == evaluate(arena, controllers[i], settings).mean());
}

TEST_CASE("an episode's peak is its highest return") {
  const Arena arena(test::walker(30), test::small_body());
  std::vector<double> sums;
  const Evaluation result =
      evaluate(arena, travelling_wave(5, 0.5, 12.0, 1.3), {}, [&](const EpisodeMoment& m) {
        if (m.targets.empty()) return;
        sums.push_back((sums.empty() ? 0.0 : sums.back()) + m.env.rewards()[0]);
      });
  CHECK(result.peaks[0] == *std::max_element(sums.begin(), sums.end()));
  CHECK(result.peaks[0] > result.returns[0]);  // it sways
}

TEST_CASE("a sequence holds its last targets when it is over") {
  const ReplayController replay{{1.0, 0.7, 1.5, 0.6}, 2};
  std::vector<double> targets(2);
  act(replay, 0, targets);
  CHECK(targets == std::vector<double>{1.0, 0.7});
  act(replay, 9, targets);
  CHECK(targets == std::vector<double>{1.5, 0.6});
}

TEST_CASE("means and standard errors") {
  const Evaluation e{{1.0, 2.0, 3.0, 6.0}, {5, 5, 5, 6}};
  CHECK(e.mean() == 3.0);
  CHECK(e.standard_error() == Approx(std::sqrt(14.0 / 3.0 / 4.0)));
  CHECK(e.steps() == 21);
  CHECK(Evaluation{{4.0}, {5}}.standard_error() == 0.0);
}

TEST_CASE("controllers that do not fit robot and task are refused") {
  const Arena arena(test::walker(10), test::small_body());
  const Arena other(test::walker(10), test::body_a());
  const EvaluationSettings once;
  CHECK_THROWS_WITH(evaluate(arena, policy_for(other), once), Catch::Contains("inputs"));
  CHECK_THROWS_WITH(evaluate(arena, travelling_wave(4, 0.1, 9.0, 1.0), once),
                    Catch::Contains("4 amplitudes"));
  CHECK_THROWS_WITH(evaluate(arena, ReplayController{{1.0, 1.0, 1.0}, 3}, once),
                    Catch::Contains("fit 5 actuators"));
  CHECK_THROWS_WITH(evaluate(arena, ReplayController{{1.0, 1.0, 1.0}, 5}, once),
                    Catch::Contains("3 recorded actions"));
  SineController broken = travelling_wave(5, 0.1, 9.0, 1.0);
  broken.phase[2] = std::nan("");
  CHECK_THROWS_WITH(evaluate(arena, broken, once), Catch::Contains("not a finite number"));
}
