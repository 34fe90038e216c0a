#include "libevo/task/env.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/base/random.h"
#include "libevo/task/measure.h"
#include "tests/unit/expect.h"
#include "tests/unit/sim/fixtures.h"

using namespace evo;

namespace {

TaskSpec walking() {
  TaskSpec task;
  task.name = "Test-walk";
  task.episode_steps = 7;
  task.robot_x = 2;
  task.robot_y = 1;
  task.objects.push_back({fixed_ground(30), "", ""});
  task.observation = {observation::Velocity{robot_name}, observation::Orientation{robot_name},
                      observation::RelativePositions{robot_name},
                      observation::Floor{2, 5.0, {"ground"}}};
  task.reward = {{1.0, reward::Displacement{robot_name, Axis::x}, {}}};
  return task;
}

TaskSpec drawing() {
  TaskSpec task = walking();
  task.name = "Test-draw";
  task.draws = {{"ox", -1, 3}, {"oy", 0, 2}};
  task.objects.push_back({{"box", Body::from_rows({"SS", "SS"}), 12, 2}, "ox", "oy"});
  task.observation.push_back(observation::Offset{"box", robot_name});
  return task;
}

TaskSpec seeking() {
  TaskSpec task = walking();
  task.name = "Test-seek";
  task.goals = DrawnGoals{8, 3, 20, 60, 2.0};
  task.observation = {observation::GoalIndex{}, observation::GoalPosition{},
                      observation::GoalOffset{}};
  task.reward = {{1.0, reward::GoalApproach{}, {}}};
  task.rules = {{{condition::GoalsReached{}}, 1.0, true}};
  return task;
}

Body walker() { return Body::from_rows({"HSH", "V.V"}); }

std::vector<double> actions(const Arena& arena, int environments, int step) {
  Stream stream(1, "test/actions", static_cast<std::uint64_t>(step));
  std::vector<double> values(static_cast<std::size_t>(environments * arena.action_length()));
  for (double& value : values) value = 0.5 + 1.2 * stream.uniform();
  return values;
}

std::string message(const TaskSpec& task, const Body& robot) {
  return test::error_of(Failure::data, [&] { const Arena arena(task, robot); });
}

std::vector<double> copy(std::span<const double> values) { return {values.begin(), values.end()}; }

// The largest difference of two coordinates; infinite where one is not a number.
double distance(std::span<const Vec2> a, std::span<const Vec2> b) {
  REQUIRE(a.size() == b.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (const double d : {std::abs(a[i].x - b[i].x), std::abs(a[i].y - b[i].y)})
      if (!(d <= largest)) largest = std::isnan(d) ? HUGE_VAL : d;
  return largest;
}

void reset_all(const Arena& arena, VecEnv& env) {
  for (int i = 0; i < env.environments(); ++i)
    env.reset(i,
              {arena.draw(9, static_cast<std::uint64_t>(i)), 0.01, static_cast<std::uint64_t>(i)});
}

// The start, at rest, the robot moved to the right.
Snapshot moved(const Model& model, double dx) {
  Snapshot snapshot;
  snapshot.positions = model.initial_positions();
  snapshot.velocities.resize(snapshot.positions.size());
  for (int i = 0; i < model.objects().front().points; ++i)
    snapshot.positions[static_cast<std::size_t>(i)].x += dx;
  return snapshot;
}

}  // namespace

TEST_CASE("a robot that does not fit, and a task that makes no sense, are refused") {
  CHECK_THAT(message(walking(), Body::from_rows({"RR", "SS"})),
             Catch::Contains("task 'Test-walk'") && Catch::Contains("actuator"));
  TaskSpec low = walking();
  low.robot_y = 0;
  CHECK_THAT(message(low, walker()), Catch::Contains("robot") && Catch::Contains("ground"));
  TaskSpec misspelt = walking();
  misspelt.reward = {{1.0, reward::Displacement{"robt", Axis::x}, {}}};
  CHECK_THAT(message(misspelt, walker()),
             Catch::Contains("unknown object 'robt' (did you mean 'robot'?)"));
  TaskSpec aimless = walking();
  aimless.observation = {observation::GoalIndex{}};
  CHECK_THAT(message(aimless, walker()),
             Catch::Contains("goal_index needs the task to draw goals"));
  TaskSpec crowded = walking();
  crowded.objects.push_back({{"rival", walker(), 10, 1}, "", ""});
  CHECK_THAT(message(crowded, walker()), Catch::Contains("'rival' has actuators"));
  TaskSpec undrawn = walking();
  undrawn.objects.push_back({{"box", Body::from_rows({"S"}), 12, 2}, "ox", ""});
  CHECK_THAT(message(undrawn, walker()), Catch::Contains("'ox', which the task does not draw"));
}

TEST_CASE("draws follow from seed and index alone, and stay in their range") {
  const Arena one(drawing(), walker());
  const Arena other(drawing(), Body::from_rows({"HH"}));
  bool low = false;
  bool high = false;
  for (std::uint64_t index = 0; index < 200; ++index) {
    const Draws draws = one.draw(3, index);
    CHECK(draws == other.draw(3, index));
    const int ox = draws.integers.at("ox");
    CHECK((ox >= -1 && ox <= 3));
    low = low || ox == -1;
    high = high || ox == 3;
  }
  CHECK(low);
  CHECK(high);
  CHECK_FALSE(one.draw(3, 0) == one.draw(4, 0));
}

TEST_CASE("goals are drawn until the path is long enough") {
  const Arena arena(seeking(), walker());
  for (std::uint64_t index = 0; index < 100; ++index) {
    const std::vector<int> goals = arena.draw(1, index).goals;
    int place = 8;
    int path = 0;
    for (const int goal : goals) {
      CHECK(path < 60);
      CHECK((goal >= 3 && goal <= 20));
      path += std::abs(goal - place);
      place = goal;
    }
    CHECK(path >= 60);
  }
}

TEST_CASE("draws that are not the task's are refused") {
  const Arena arena(drawing(), walker());
  VecEnv env(arena, 1);
  const auto refused = [&](const Draws& draws) {
    return test::error_of(Failure::usage, [&] { env.reset(0, {draws, 0.0, 0}); });
  };
  CHECK(refused({{{"ox", 1}}, {}}) == "task 'Test-draw' draws 'oy', for which no value was given");
  CHECK(refused({{{"ox", 1}, {"oy", 0}, {"xo", 2}}, {}}) ==
        "task 'Test-draw' does not draw 'xo' (did you mean 'ox'?)");
  CHECK(refused({{{"ox", 1}, {"oy", 0}}, {3}}) == "task 'Test-draw' does not draw goals");
}

TEST_CASE("environments that are not active stay as they are") {
  const Arena arena(walking(), walker());
  VecEnv env(arena, 3);
  reset_all(arena, env);
  const auto before = copy(env.observations());
  env.step(actions(arena, 3, 0), std::vector<std::uint8_t>{0, 1, 0});
  const auto d = static_cast<std::size_t>(arena.observation_length());
  const auto after = copy(env.observations());
  const auto part = [&](const std::vector<double>& all, std::size_t i) {
    return copy(std::span(all).subspan(i * d, d));
  };
  CHECK(part(before, 0) == part(after, 0));
  CHECK(part(before, 1) != part(after, 1));
  CHECK(part(before, 2) == part(after, 2));
  CHECK(env.steps(0) == 0);
  CHECK(env.steps(1) == 1);
}

TEST_CASE("episodes are truncated at the time limit and not before") {
  const Arena arena(walking(), walker());
  VecEnv env(arena, 1);
  env.reset(0, {});
  for (int step = 1; step <= 8; ++step) {
    env.step(actions(arena, 1, step));
    CHECK(env.steps(0) == step);
    CHECK((env.truncated()[0] != 0) == (step >= 7));
    CHECK(env.terminated()[0] == 0);
  }
  env.reset(0, {});
  CHECK(env.truncated()[0] == 0);
  CHECK(env.steps(0) == 0);
}

TEST_CASE("jitter shifts start coordinates by up to its size, the same for a seed") {
  const Arena arena(walking(), walker());
  VecEnv env(arena, 3);
  env.reset(0, {});
  env.reset(1, {{}, 1e-4, 7});
  env.reset(2, {{}, 1e-4, 7});
  const double largest = distance(env.positions(0), env.positions(1));
  CHECK(largest <= 1.0001e-5);
  CHECK(largest > 5e-6);
  CHECK(distance(env.positions(1), env.positions(2)) == 0.0);
  // The orientation refers to the shifted start.
  CHECK(env.observations()[static_cast<std::size_t>(arena.observation_length()) + 2] < 0.0045);
}

TEST_CASE("an episode continues from any of its moments, in any environment, to the same bits") {
  const Arena arena(drawing(), walker());
  VecEnv env(arena, 3);
  reset_all(arena, env);
  std::vector<std::uint8_t> moment;
  std::vector<double> rewards;
  const auto length = static_cast<std::size_t>(arena.observation_length());
  for (int step = 0; step < 9; ++step) {
    if (step == 4) moment = env.save(1);
    env.step(actions(arena, 3, step));
    if (step >= 4) rewards.push_back(env.rewards()[1]);
  }
  const auto seen = copy(env.observations().subspan(length, length));
  for (const int to : {2, 1}) {
    const auto others = env.save(0);
    env.load(to, moment);
    CHECK(env.save(to) == moment);
    CHECK(env.save(0) == others);
    std::vector<double> again;
    for (int step = 4; step < 9; ++step) {
      // What environment 1 was told.
      std::vector<double> targets = actions(arena, 3, step);
      const auto width = static_cast<std::ptrdiff_t>(arena.action_length());
      std::copy_n(targets.begin() + width, width, targets.begin() + to * width);
      env.step(targets);
      again.push_back(env.rewards()[static_cast<std::size_t>(to)]);
    }
    CHECK(again == rewards);
    CHECK(copy(env.observations().subspan(static_cast<std::size_t>(to) * length, length)) == seen);
  }
  const Arena other(walking(), Body::from_rows({"HH"}));
  VecEnv smaller(other, 1);
  CHECK_THROWS_AS(smaller.load(0, moment), Error);
  moment.pop_back();
  CHECK_THROWS_AS(env.load(0, moment), Error);
}

TEST_CASE("a perturbed episode continues from where it was, every point moved a little") {
  const Arena arena(drawing(), walker());
  VecEnv env(arena, 3);
  reset_all(arena, env);
  for (int step = 0; step < 4; ++step) env.step(actions(arena, 3, step));
  const auto moment = env.save(0);
  env.load(1, moment);
  env.load(2, moment);
  env.perturb(1, 1e-2, 7);
  env.perturb(2, 1e-2, 7);
  CHECK(env.save(1) == env.save(2));
  CHECK(env.steps(1) == 4);
  const double largest = distance(env.positions(0), env.positions(1));
  CHECK(largest <= 1.0001e-3);  // a hundredth of a voxel of 0.1
  CHECK(largest > 5e-4);
  CHECK(distance(env.velocities(0), env.velocities(1)) == 0.0);
  const auto d = static_cast<std::ptrdiff_t>(arena.observation_length());
  CHECK_FALSE(std::equal(env.observations().begin(), env.observations().begin() + d,
                         env.observations().begin() + d));
  // Other moves follow from another seed; none leaves everything as it was.
  env.load(2, moment);
  env.perturb(2, 1e-2, 8);
  CHECK(env.save(1) != env.save(2));
  env.load(2, moment);
  env.perturb(2, 0.0, 8);
  CHECK(env.save(2) == moment);
}

TEST_CASE("saved draws that are not the task's are refused") {
  // Two tasks have the same observation and world, and one draws goals.
  TaskSpec with_goals = seeking();
  with_goals.observation.clear();
  with_goals.reward.clear();
  TaskSpec without = with_goals;
  without.goals.reset();
  without.rules.clear();
  const Arena goals(with_goals, walker());
  const Arena none(without, walker());
  VecEnv from(none, 1);
  from.reset(0, {});
  from.step(std::vector<double>(static_cast<std::size_t>(none.action_length()), 1.0));
  VecEnv to(goals, 1);
  CHECK_THROWS_AS(to.load(0, from.save(0)), Error);
  CHECK_THROWS_AS(to.load(from.save()), Error);
  VecEnv never_reset(goals, 1);
  to.load(never_reset.save());
}

TEST_CASE("bytes that belong elsewhere are refused") {
  const Arena arena(walking(), walker());
  VecEnv env(arena, 2);
  reset_all(arena, env);
  auto bytes = env.save();
  VecEnv three(arena, 3);
  CHECK_THROWS_AS(three.load(bytes), Error);
  const Arena other(walking(), Body::from_rows({"HH"}));
  VecEnv smaller(other, 2);
  CHECK_THROWS_AS(smaller.load(bytes), Error);
  bytes.pop_back();
  CHECK_THROWS_AS(env.load(bytes), Error);
  CHECK_THROWS_AS(env.load({}), Error);
}

TEST_CASE("a target that is not a number is refused") {
  const Arena arena(walking(), walker());
  VecEnv env(arena, 1);
  env.reset(0, {});
  auto targets = actions(arena, 1, 0);
  targets[1] = std::nan("");
  CHECK_THROWS_WITH(env.step(targets), "target 1 of environment 0 is not a finite number");
}

// ---- judging -------------------------------------------------------------------------

TEST_CASE("rules add up, and need not end the episode") {
  TaskSpec task = walking();
  task.reward.clear();
  task.rules = {{{condition::Position{robot_name, Axis::x, 10.0, {}, {}, {}}}, 5.0, false},
                {{condition::Position{robot_name, Axis::x, 12.0, {}, {}, {}},
                  condition::Position{robot_name, Axis::y, {}, 100.0, {}, {}}},
                 0.5,
                 true}};
  const Arena arena(task, walker());
  const Model& model = arena.model();
  Episode episode;
  const Snapshot start = moved(model, 0.0);
  StepOutcome outcome = judge(arena, model, episode, start, moved(model, 0.7), {}, false);
  CHECK(outcome.reward == 5.0);
  CHECK_FALSE(outcome.terminated);
  outcome = judge(arena, model, episode, start, moved(model, 1.0), {}, false);
  CHECK(outcome.reward == 5.5);
  CHECK(outcome.terminated);
}

TEST_CASE("a reward sees the targets as the physics clips them, and those of the step before") {
  TaskSpec task = walking();
  task.reward = {{-0.5, reward::Effort{}, {}}, {1.0, reward::ActionChange{}, {}}};
  task.step_cost = 0.25;
  const Arena arena(task, Body::from_rows({"HV"}));
  VecEnv env(arena, 1);
  env.reset(0, {});
  env.step(std::vector{1.5, 9.0});  // 9 is clipped to 1.6
  CHECK(env.rewards()[0] == Approx(-0.5 * (0.25 + 0.36) + (0.25 + 0.36) - 0.25));
  const std::vector<std::uint8_t> saved = env.save();
  for (int again = 0; again < 2; ++again) {
    env.step(std::vector{1.0, 1.5});
    CHECK(env.rewards()[0] == Approx(-0.5 * 0.25 + (0.25 + 0.01) - 0.25));
    env.load(saved);
  }
  env.reset(0, {});
  env.step(std::vector{1.0, 1.0});
  CHECK(env.rewards()[0] == -0.25);
}

TEST_CASE("an action that is held is the same action in so many control steps") {
  TaskSpec task = walking();
  const Arena plain(task, walker());
  task.hold = 5;
  const Arena held(task, walker());
  VecEnv one(plain, 1);
  VecEnv five(held, 1);
  one.reset(0, {});
  five.reset(0, {});
  for (int step = 0; step < 8; ++step) {
    const auto targets = actions(plain, 1, step);
    double earned = 0.0;
    for (int k = 0; k < 5; ++k) {
      one.step(targets);
      earned += one.rewards()[0];
    }
    five.step(targets);
    CHECK(std::ranges::equal(one.positions(), five.positions()));
    CHECK(five.rewards()[0] == Approx(earned).margin(1e-12));
  }
  CHECK(five.steps(0) == 8);
}

TEST_CASE("bounds are strict or not, as named") {
  const Arena plain(walking(), walker());
  const Model& model = plain.model();
  const Snapshot start = moved(model, 0.0);
  // The exact centre, as the arena measures it.
  const double x =
      centre(PointRange{0, model.objects().front().points}.of(start.positions), 0.1).raw.x;
  const auto rewarded = [&](const condition::Position& position) {
    TaskSpec task = walking();
    task.reward.clear();
    task.rules = {{{position}, 1.0, false}};
    const Arena arena(task, walker());
    Episode episode;
    return judge(arena, arena.model(), episode, start, start, {}, false).reward == 1.0;
  };
  // A bound b voxels for which b * 0.1 is exactly x.
  double bound = x / 0.1;
  while (bound * 0.1 < x) bound = std::nextafter(bound, 1e9);
  while (bound * 0.1 > x) bound = std::nextafter(bound, -1e9);
  REQUIRE(bound * 0.1 == x);
  CHECK_FALSE(rewarded({robot_name, Axis::x, bound, {}, {}, {}}));
  CHECK_FALSE(rewarded({robot_name, Axis::x, {}, bound, {}, {}}));
  CHECK(rewarded({robot_name, Axis::x, {}, {}, bound, {}}));
  CHECK(rewarded({robot_name, Axis::x, {}, {}, {}, bound}));
}
