#include "libevo/control/trainer.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/base/error.h"
#include "libevo/base/parallel.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/open_loop.h"
#include "libevo/control/policy_passes.h"
#include "tests/unit/control/arena.h"
#include "tests/unit/expect.h"

using namespace evo;
using test::heritage, test::trained;

namespace {

// A training of a second or less, of episodes of 10 steps. A new algorithm is taken for a search.
TrainingSettings brief(const std::string& algorithm = "ppo") {
  TrainingSettings s;
  s.algorithm = from_word<Algorithm>(algorithm).value();
  if (algorithm == "ppo" || algorithm == "modular") {  // 6 updates of 4 x 16 steps
    s.steps = 6 * 64 + 13;
    s.rollout = 16;
    s.hidden = {16, 16};
    s.evaluation_interval = 4;
    s.learning_rate = 1e-3;
    s.learning_rate_horizon = 0;
  } else {
    s.population = 6;
    s.steps = 6 * 10 * 5 + 59;
  }
  if (algorithm == "sequence") {  // three stretches of exploration
    s.environments = 2;
    s.rollout = 16;
    s.evaluation_interval = 3;
    s.steps = 2 * 10 + 3 * (96 + 20);
  }
  return s;
}

void check_equal(const TrainResult& a, const TrainResult& b) {
  CHECK(a.fitness == b.fitness);
  CHECK(a.controller == b.controller);
  CHECK(a.best_step == b.best_step);
  CHECK(a.steps == b.steps);
  CHECK(a.curve == b.curve);
  CHECK(a.final_score == b.final_score);
  CHECK(a.failure == b.failure);
}

// A training that is stopped and continues from its checkpoint ends with the same bytes.
template <typename Make>
void check_resumes(int advances, const Make& make) {
  Trainer whole = make();
  for (int i = 0; i < advances && !whole.done(); ++i) whole.advance();
  const Checkpoint checkpoint = whole.checkpoint();
  Trainer resumed = make();
  resumed.restore(checkpoint);
  CHECK(resumed.checkpoint() == checkpoint);
  check_equal(train(resumed), train(whole));
  CHECK(resumed.checkpoint() == whole.checkpoint());
}

}  // namespace

TEST_CASE("a training takes its updates, evaluates when due, and keeps the best") {
  const Arena arena(test::walker(10), test::small_body());
  TrainingSettings settings = brief();
  settings.final_episodes = 3;
  Trainer trainer(arena, settings, 1, "robot");
  std::vector<std::string> names;
  int advances = 0;
  const TrainResult result = train(trainer, [&](const Trainer&, const TrainingReport& report) {
    if (report.metrics.empty()) return true;  // the final episodes
    ++advances;
    CHECK(report.step == 64 * advances);
    for (const Metric& metric : report.metrics) {
      CHECK(std::isfinite(metric.value));
      names.push_back(metric.name);
    }
    return true;
  });
  CHECK(advances == 6);
  CHECK(trainer.done());
  CHECK(result.steps == 6 * 64);
  REQUIRE(result.curve.size() == 2);  // after 4 and after the last
  CHECK(result.curve[0].step == 4 * 64);
  CHECK(result.curve[1].step == 6 * 64);
  CHECK(*result.fitness == std::max(result.curve[0].evaluation, result.curve[1].evaluation));
  CHECK(result.curve[1].best == *result.fitness);
  for (const char* name :
       {"losses/policy_loss", "losses/value_loss", "losses/entropy", "losses/approx_kl",
        "losses/clipfrac", "losses/explained_variance", "charts/learning_rate",
        "charts/episodic_return", "eval/return", "eval/best"})
    CHECK(std::count(names.begin(), names.end(), name) > 0);

  // The controller kept is the one that was evaluated.
  CHECK(evaluate(arena, *result.controller, {.seed = 1}).mean() == *result.fitness);
  REQUIRE(result.final_score);
  CHECK(result.final_score->episodes == 3);
  CHECK(result.final_score->standard_error > 0.0);
}

TEST_CASE("a resumed training ends with the same bytes") {
  const Arena arena(test::walker(10), test::small_body());
  const TrainingSettings settings = brief(GENERATE(from_range(words_of<Algorithm>())));
  check_resumes(GENERATE(0, 2, 4, 5, 9), [&] { return Trainer(arena, settings, 5, "robot"); });
}

TEST_CASE("a bad end is felt as the settings say, and counted as the task says") {
  TaskSpec task = test::walker(10);
  const auto first_update = [&](double weight) {
    TrainingSettings settings = brief();
    settings.failure_weight = weight;
    const Arena arena(task, test::small_body());
    Trainer trainer(arena, settings, 1, "robot");
    return trainer.advance().metrics;
  };
  const auto value = [](const std::vector<Metric>& metrics, const std::string& name) {
    for (const Metric& metric : metrics)
      if (metric.name == name) return metric.value;
    FAIL("no " + name);
    return 0.0;
  };
  SECTION("where no rule ends an episode, nothing changes") {
    for (const char* name : {"losses/value_loss", "charts/episodic_return"})
      CHECK(value(first_update(0.2), name) == value(first_update(1.0), name));
  }
  // Some episodes have one: where every step ended one, normalising would hide the weight.
  SECTION("where one does, the learner's loss changes, the return does not") {
    const double penalty = GENERATE(-3.0, 3.0);  // a good end counts in full
    task.rules.push_back(
        {{condition::Position{robot_name, Axis::x, 2.55, {}, {}, {}}}, penalty, true});
    const auto full = first_update(1.0);
    const auto mild = first_update(0.2);
    CHECK(value(mild, "charts/episodic_return") == value(full, "charts/episodic_return"));
    CHECK((value(mild, "losses/value_loss") == value(full, "losses/value_loss")) == (penalty > 0));
  }
}

TEST_CASE("results depend on seed and robot id, and on nothing else") {
  const Arena arena(test::walker(10), test::small_body());
  const TrainingSettings settings = brief(GENERATE(from_range(words_of<Algorithm>())));
  const TrainResult reference = trained(arena, settings, 1, "a");
  check_equal(trained(arena, settings, 1, "a"), reference);
  CHECK_FALSE(trained(arena, settings, 2, "a").controller == reference.controller);
  CHECK_FALSE(trained(arena, settings, 1, "b").controller == reference.controller);
}

TEST_CASE("trainings side by side are each as alone", "[threads]") {
  const Arena arena(test::walker(10), test::small_body());
  const Arena other(test::walker(10), test::body_a());
  const std::vector<TrainingSettings> settings{brief(), brief("gait"), brief("sequence")};
  const auto run = [&](std::size_t i) {
    Trainer trainer(i % 2 == 0 ? arena : other, settings[i % settings.size()], 1,
                    std::to_string(i));
    while (!trainer.done()) {
      trainer.advance();
      (void)trainer.checkpoint();
    }
    return trainer.result();
  };
  std::vector<TrainResult> results(8);
  ThreadPool pool(4);
  pool.run(results.size(), [&](std::size_t i, int /*worker*/) { results[i] = run(i); });
  for (std::size_t i = 0; i < results.size(); ++i) check_equal(run(i), results[i]);
}

TEST_CASE("results are the same on every instruction set") {
  const Arena arena(test::walker(10), test::small_body());
  const auto run = [&] {
    Trainer trainer(arena, brief(), 1, "robot");
    train(trainer);
    return trainer.checkpoint();
  };
  const Checkpoint reference = run();
  for_each_isa([&] {
    CHECK(run().arrays.at("learner/policy/parameters") ==
          reference.arrays.at("learner/policy/parameters"));
  });
}

TEST_CASE("a training can be stopped, and then has no final score") {
  const Arena arena(test::walker(10), test::small_body());
  TrainingSettings settings = brief();
  settings.final_episodes = 2;
  Trainer trainer(arena, settings, 1, "robot");
  const TrainResult result =
      train(trainer, [](const Trainer&, const TrainingReport& r) { return r.step < 3 * 64; });
  CHECK(result.steps == 3 * 64);
  CHECK_FALSE(result.final_score);
  CHECK_FALSE(trainer.done());
}

TEST_CASE("a training that diverges is a failure record, not an exception") {
  const Arena arena(test::walker(10), test::small_body());
  TrainingSettings settings = brief();
  settings.learning_rate = 1e30;
  settings.max_gradient_norm = 0;
  Trainer trainer(arena, settings, 9, "robot");
  const TrainResult result = train(trainer);
  REQUIRE(result.failure);
  CHECK_THAT(result.failure->why, Catch::Contains("not a finite number"));
  CHECK(result.failure->seed == 9);
  CHECK(result.failure->step > 0);
  CHECK_FALSE(result.fitness);
  CHECK_FALSE(result.controller);
  CHECK(trainer.done());
}

TEST_CASE("open-loop searches stay within their budget, and are what they claim") {
  const Arena arena(test::walker(10), test::small_body());
  const std::string algorithm = GENERATE("gait", "sequence");
  const TrainingSettings settings = brief(algorithm);
  Trainer trainer(arena, settings, 1, "robot");
  const TrainResult result = train(trainer);
  CHECK(trainer.done());
  REQUIRE(result.controller);
  if (algorithm == "gait") {
    CHECK(result.steps == 5 * 60);
    CHECK(result.curve.size() == 5);
    CHECK(std::holds_alternative<SineController>(*result.controller));
  } else {
    CHECK(result.steps <= settings.steps);
    CHECK(result.steps > settings.steps - 2 * 20);
    CHECK(result.curve.size() >= 3);
    CHECK(std::holds_alternative<ReplayController>(*result.controller));
  }
  CHECK(evaluate(arena, *result.controller, {.seed = 1}).mean() == *result.fitness);
}

TEST_CASE("training makes body A walk") {
  const Arena arena(test::walker(100), test::body_a());
  TrainingSettings settings;  // much as the profile `default`
  settings.steps = 20 * 1024;
  settings.environments = 16;
  settings.rollout = 64;
  settings.epochs = 10;
  settings.minibatches = 8;
  settings.clip = 0.2;
  settings.clip_value_loss = false;
  settings.entropy_coefficient = 0.0;
  settings.time_limit = TimeLimit::bootstrap;
  settings.learning_rate = 1e-3;
  settings.learning_rate_horizon = 0;
  settings.head_gain = 0.01;
  settings.initial_log_std = -1.0;
  settings.evaluation_interval = 5;
  const Policy untrained =
      initial_policy(settings, arena.observation_length(), arena.action_length(), 0.6, 1.6, {},
                     Stream(1, "train/initial", "robot"));
  const double before = evaluate(arena, untrained, {}).mean();
  const TrainResult result = trained(arena, settings, 1, "robot");
  INFO("untrained " << before << ", trained " << *result.fitness);
  CHECK(before < 0.1);
  CHECK(*result.fitness > before + 0.25);
}

TEST_CASE("settings that make no sense are refused by name") {
  const Arena arena(test::walker(10), test::small_body());
  const auto message = [&](auto change) {
    TrainingSettings settings = brief();
    change(settings);
    return test::error_of(Failure::usage, [&] { Trainer(arena, settings, 1, "robot"); });
  };
  CHECK_THAT(message([](auto& s) { s.minibatches = 65; }), Catch::Contains("minibatches is 65"));
  CHECK_THAT(message([](auto& s) { s.steps = 63; }), Catch::Contains("63 steps"));
  // With nothing to inherit.
  CHECK_THAT(message([](auto& s) { s.moment_share = 0.5; }),
             Catch::Contains("moment_share is 0.5"));
  CHECK_THAT(message([](auto& s) { s.keep_sequence = true; }), Catch::Contains("keep_sequence"));
  CHECK_THAT(message([](auto& s) {
               s.algorithm = Algorithm::gait;
               s.steps = 100;
             }),
             Catch::Contains("one generation"));
  CHECK_THAT(message([](auto& s) {
               s = brief("sequence");
               s.steps = 2 * 10 + 2 * 10 - 1;
             }),
             Catch::Contains("give at least 40"));
}

TEST_CASE("a checkpoint of another training is refused") {
  const Arena arena(test::walker(10), test::small_body());
  Trainer one(arena, brief(), 1, "robot");
  TrainingSettings wider = brief();
  wider.hidden = {32, 32};
  Trainer two(arena, wider, 1, "robot");
  CHECK_THROWS_WITH(two.restore(one.checkpoint()), Catch::Contains("learner/policy/parameters"));
  Trainer search(arena, brief("gait"), 1, "robot");
  CHECK_THROWS_WITH(search.restore(one.checkpoint()), Catch::Contains("no array '"));
}

TEST_CASE("a training starts from what another robot has learned, and that counts as it is") {
  const auto [method, old_method] =
      GENERATE(table<std::string, std::string>({{"ppo", "ppo"},
                                                {"ppo", "gait"},
                                                {"gait", "gait"},
                                                {"sequence", "sequence"},
                                                {"sequence", "gait"},
                                                {"sequence", "ppo"}}));
  INFO(method << " from " << old_method);
  const Arena old_arena(test::walker(10), test::small_body());
  const TrainResult old_result = trained(old_arena, brief(old_method), 1, "old");
  const Inheritance inheritance = heritage(old_arena, old_result);
  TrainingSettings settings = brief(method);
  settings.hidden = {16, 16};  // as those of the network inherited

  SECTION("on the same body it earns what it earned") {
    if (method == "ppo" && old_method == "gait") return;  // which is what its network acts on
    const TrainResult result = trained(old_arena, settings, 2, "new", inheritance);
    const CurvePoint& first = result.curve.front();
    if (method == "ppo") {
      CHECK(first.step == 0);
      CHECK(first.evaluation == Approx(*old_result.fitness));
    } else {
      CHECK(first.evaluation >= *old_result.fitness);
    }
    CHECK(*result.fitness >= first.evaluation);
  }
  SECTION("on another body it resumes to the same bytes") {
    const Arena arena(test::walker(12), Body::from_rows({"HHV", "VSV"}));
    settings.steps += 200;
    check_resumes(2, [&] { return Trainer(arena, settings, 1, "new", inheritance); });
  }
}

TEST_CASE("a search for a gait starts afresh from a network that has none") {
  const Arena arena(test::walker(10), test::small_body());
  const Inheritance network = heritage(arena, trained(arena, brief(), 1, "robot"));
  check_equal(trained(arena, brief("gait"), 1, "robot", network),
              trained(arena, brief("gait"), 1, "robot"));
}

TEST_CASE("a search for a sequence begins with one for a gait") {
  const Arena arena(test::walker(10), test::small_body());
  TrainingSettings without = brief("sequence");
  without.gait_share = 0.08;  // less than a generation
  without.steps += 320;
  TrainingSettings settings = without;
  settings.gait_share = 0.5;
  Trainer trainer(arena, settings, 1, "robot");
  trainer.advance();
  // A generation of the search, not a stretch of exploration.
  CHECK(trainer.checkpoint().arrays.count("search/soonest") == 0);
  double of_gaits = -1e9;
  Checkpoint found;
  while (found.arrays.count("search/soonest") == 0) {
    of_gaits = trainer.result().fitness.value();
    trainer.advance();
    found = trainer.checkpoint();
  }
  CHECK(trainer.result().steps <= settings.steps);
  const TrainResult result = train(trainer);
  CHECK(*result.fitness >= of_gaits);
  Trainer resumed(arena, settings, 1, "robot");
  resumed.restore(found);
  check_equal(train(resumed), result);
  // More steps bring no search for a gait to a training that had none.
  Trainer plain(arena, without, 1, "robot");
  train(plain);
  settings = without;
  settings.steps += 640;
  Trainer longer(arena, settings, 1, "robot");
  longer.restore(plain.checkpoint());
  CHECK(train(longer).steps > without.steps);
}

// What a search for a sequence did, turn by turn: g is a generation of gaits, s a stretch
// of exploration. Checkpoints are those before each turn.
std::string turns_of(Trainer& trainer, std::vector<Checkpoint>* checkpoints = nullptr) {
  std::string turns;
  while (!trainer.done()) {
    const Checkpoint before = trainer.checkpoint();
    const std::size_t turn = turns.size();
    for (const Metric& metric : trainer.advance().metrics) {
      if (metric.name == "charts/sigma") turns += 'g';
      if (metric.name == "charts/levels") turns += 's';
    }
    // The final episodes are a step of the training, and no turn.
    if (checkpoints != nullptr && turns.size() > turn) checkpoints->push_back(before);
  }
  return turns;
}

TEST_CASE("searches for a gait and for a sequence take turns, and each step of them is resumed") {
  const Arena arena(test::walker(20), test::small_body());
  TrainingSettings settings = brief("sequence");
  settings.steps = 6000;
  settings.gait_share = 0.1;
  Trainer trainer(arena, settings, 1, "robot");
  std::vector<Checkpoint> checkpoints;
  const std::string turns = turns_of(trainer, &checkpoints);
  INFO(turns);
  REQUIRE(turns.size() == checkpoints.size());
  CHECK(turns.find("gs") != std::string::npos);
  CHECK(turns.find("sg") != std::string::npos);
  const std::string both = turns.substr(turns.find('s'));  // not by turns whatever they bring
  CHECK((both.find("ssss") != std::string::npos || both.find("gggg") != std::string::npos));
  const TrainResult result = trainer.result();
  CHECK(result.steps <= settings.steps);
  for (std::size_t i = 0; i < checkpoints.size(); i += 3) {
    Trainer resumed(arena, settings, 1, "robot");
    resumed.restore(checkpoints[i]);
    check_equal(train(resumed), result);
  }
}

TEST_CASE("a search for a sequence continues with the gait where waves gain more") {
  const Arena arena(test::walker(60), test::body_a());  // flat ground
  TrainingSettings settings = brief("sequence");
  settings.population = 8;
  settings.rollout = 64;
  settings.steps = 24000;
  settings.gait_share = 0.1;
  std::string turns;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Trainer trainer(arena, settings, seed, "robot");
    turns += turns_of(trainer) + ' ';
  }
  INFO(turns);  // 36 g, 12 s with the third seed
  CHECK(std::count(turns.begin(), turns.end(), 'g') > std::count(turns.begin(), turns.end(), 's'));
}

TEST_CASE("episodes begin at moments of what is inherited") {
  const Arena arena(test::walker(10), test::small_body());
  const TrainingSettings old_settings = brief(GENERATE("sequence", "gait", "ppo"));
  const Inheritance inheritance = heritage(arena, trained(arena, old_settings, 1, "old"));
  TrainingSettings settings = brief();
  settings.moment_share = 0.7;
  settings.start_jitter = 1e-3;
  settings.evaluation_jitter = 1e-3;
  settings.evaluation_episodes = 3;

  SECTION("a resumed training ends with the same bytes") {
    check_resumes(3, [&] { return Trainer(arena, settings, 1, "new", inheritance); });
  }
  SECTION("share, jitter and start each decide the result") {
    const auto bytes = [&](auto change) {
      TrainingSettings changed = settings;
      change(changed);
      Trainer trainer(arena, changed, 1, "new", inheritance);
      trainer.advance();
      return trainer.checkpoint();
    };
    const Checkpoint as_set = bytes([](auto&) {});
    CHECK(bytes([](auto& s) { s.moment_share = 0.0; }) != as_set);
    CHECK(bytes([](auto& s) { s.moment_jitter = 0.0; }) != as_set);
    CHECK(bytes([](auto& s) { s.start_jitter = 0.0; }) != as_set);
  }
  SECTION("the step counter continues: episodes are over sooner") {
    settings.environments = 8;
    settings.rollout = 40;
    const auto ended = [&](double share) {
      settings.moment_share = share;
      settings.start_jitter = 0.0;
      Trainer trainer(arena, settings, 1, "new", inheritance);
      trainer.advance();
      std::uint64_t episodes = 0;
      const Checkpoint now = trainer.checkpoint();
      for (const auto k : now.get<std::uint64_t>("environments/next_episode")) episodes += k;
      return episodes;
    };
    CHECK(ended(0.0) == 40);  // in each environment four that ended, and the next
    CHECK(ended(1.0) > 50);   // of 5.5 steps on average
  }
}

TEST_CASE("a sequence is searched from the start that it is judged from") {
  const Arena arena(test::walker(10), test::small_body());
  TrainingSettings settings = brief("sequence");
  settings.evaluation_jitter = 1e-2;
  Trainer trainer(arena, settings, 3, "robot");
  const TrainResult result = train(trainer);
  const Checkpoint end = trainer.checkpoint();
  // The first moment of the archive, before any step.
  VecEnv env(arena, 1);
  env.reset(0, start_of(arena, {.seed = 3, .jitter = 1e-2}, 0));
  const auto first = env.save(0);
  const auto& states = end.get<std::uint8_t>("search/soonest");
  CHECK(std::search(states.begin(), states.end(), first.begin(), first.end()) != states.end());
}

TEST_CASE("a network is trained on an inherited sequence") {
  const Arena arena(test::walker(10), test::small_body());
  const TrainResult found = trained(arena, brief("sequence"), 1, "old");
  const auto& sequence = std::get<ReplayController>(*found.controller);
  const Inheritance inheritance = heritage(arena, found);
  TrainingSettings settings = brief();
  settings.keep_sequence = true;
  settings.head_gain = 1e-9;
  settings.gait_log_std = -3.0;

  SECTION("it begins where the sequence is, and keeps it") {
    const TrainResult result = trained(arena, settings, 1, "new", inheritance);
    CHECK(result.curve.front().evaluation == Approx(*found.fitness).margin(1e-6));
    CHECK(std::get<ReplayController>(std::get<Policy>(*result.controller).base.value()) ==
          sequence);
  }
  SECTION("a resumed training ends with the same bytes") {
    check_resumes(3, [&] { return Trainer(arena, settings, 1, "new", inheritance); });
  }
  SECTION("a child keeps its parent's sequence with the parent's network") {
    const TrainResult parent = trained(arena, settings, 1, "new", inheritance);
    settings.keep_sequence = false;
    const TrainResult child = trained(arena, settings, 1, "child", heritage(arena, parent));
    CHECK(child.curve.front().evaluation == Approx(*parent.fitness).margin(1e-9));
  }
  SECTION("without the setting the network is alone") {
    settings.keep_sequence = false;
    const TrainResult result = trained(arena, settings, 1, "new", inheritance);
    CHECK_FALSE(std::get<Policy>(*result.controller).base);
  }
}

TEST_CASE("a wave's middle comes back from a checkpoint") {
  SineController wave = travelling_wave(3, 0.2, 20.0, 0.5);
  wave.middle = 0.9;
  Checkpoint checkpoint;
  serialize(Archive::saving(checkpoint), wave);
  SineController loaded;
  serialize(Archive::loading(checkpoint), loaded);
  CHECK(loaded == wave);
}

TEST_CASE("a finished training continues with more steps") {
  const Arena arena(test::walker(10), test::small_body());
  TrainingSettings settings = brief(GENERATE("ppo", "gait", "sequence"));
  Trainer first(arena, settings, 4, "robot");
  const TrainResult part = train(first);
  settings.steps += 10 * 64;
  Trainer second(arena, settings, 4, "robot");
  second.restore(first.checkpoint());
  CHECK_FALSE(second.done());
  const TrainResult whole = train(second);
  CHECK(whole.steps > part.steps + 8 * 64);
  CHECK(whole.steps <= settings.steps);
  CHECK(*whole.fitness >= *part.fitness);
  REQUIRE(whole.curve.size() > part.curve.size());
  CHECK(std::equal(part.curve.begin(), part.curve.end(), whole.curve.begin()));
}
