// The library as another program sees it: nothing here includes more than its header.
#include "evo/evo.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <type_traits>

namespace {

using libevo::Error;

const libevo::Robot walker({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"});
const libevo::Robot small({"HV", "VH"});

// Other ones for every step and place.
std::vector<double> wave(std::size_t count, int t) {
  std::vector<double> actions(count);
  for (std::size_t i = 0; i < count; ++i)
    actions[i] = 1.1 + 0.5 * std::sin(0.3 * t + 0.7 * static_cast<double>(i));
  return actions;
}

std::vector<double> copy(std::span<const double> values) { return {values.begin(), values.end()}; }

template <typename Work>
void fails(Error::Kind kind, const std::string& text, const Work& work) {
  try {
    work();
    FAIL("nothing was thrown");
  } catch (const Error& failure) {
    CHECK(failure.kind() == kind);
    CHECK_THAT(failure.what(), Catch::Contains(text));
  }
}

}  // namespace

TEST_CASE("api: an environment moves the same alone and among others, on any threads") {
  const libevo::Task task("Catcher-v0");
  libevo::VectorEnv one(task, {walker});
  libevo::VectorEnv many(task, {small, walker}, 3, 2);
  REQUIRE(many.num_envs() == 6);
  one.reset({.seed = 4, .episode = 2, .jitter = 1e-3});
  many.reset({.seed = 4, .jitter = 1e-3});
  const std::size_t begin = many.action_offset(5);
  const auto length = static_cast<std::size_t>(many.action_length(5));
  REQUIRE(begin + length == many.action_values());
  for (int t = 0; t < 30; ++t) {
    const std::vector<double> actions = wave(many.action_values(), t);
    many.step(actions);
    one.step(std::span(actions).subspan(begin, length));
  }
  CHECK(copy(many.observation(5)) == copy(one.observations()));
  CHECK(copy(many.observation(5)) ==
        copy(many.observations().subspan(many.observation_offset(5),
                                         static_cast<std::size_t>(many.observation_length(5)))));
  CHECK(many.rewards()[5] == one.rewards()[0]);
  CHECK(many.steps()[5] == 30);
  CHECK(one.status(0) == libevo::Status::ok);
}

TEST_CASE("api: an episode goes on from a state, as often as it is restored, to the same bits") {
  const libevo::Task task("Catcher-v0");
  libevo::VectorEnv envs(task, {walker}, 2);
  fails(Error::Kind::usage, "unreset", [&] { (void)envs.save(0); });
  envs.reset({.seed = 4});
  for (int t = 0; t < 10; ++t) envs.step(wave(envs.action_values(), t));
  const std::vector<std::uint8_t> state = envs.save(0);
  const auto at_save = copy(envs.observation(0));
  const auto go_on = [&](libevo::VectorEnv& of, int environment) {
    for (int t = 10; t < 30; ++t) {
      const std::vector<double> actions = wave(envs.action_values(), t);
      std::vector<double> given(of.action_values(), 1.0);
      std::copy_n(actions.begin(), static_cast<std::size_t>(of.action_length(environment)),
                  given.begin() + static_cast<std::ptrdiff_t>(of.action_offset(environment)));
      of.step(given);
    }
    return copy(of.observation(environment));
  };
  const auto end = go_on(envs, 0);
  envs.restore(0, state);
  CHECK(copy(envs.observation(0)) == at_save);
  CHECK(envs.steps()[0] == 10);
  CHECK(go_on(envs, 0) == end);
  envs.restore(1, state);
  CHECK(go_on(envs, 1) == end);
  libevo::VectorEnv fresh(task, {walker});
  fresh.restore(0, state);
  CHECK(fresh.status(0) == libevo::Status::ok);
  CHECK(go_on(fresh, 0) == end);

  std::vector<std::uint8_t> damaged = state;
  damaged.back() ^= 1U;
  fails(Error::Kind::data, "damaged", [&] { fresh.restore(0, damaged); });
  fails(Error::Kind::data, "damaged", [&] { fresh.restore(0, {}); });
  fails(Error::Kind::usage, "no environment 7", [&] { fresh.restore(7, state); });
  CHECK(copy(fresh.observations()) == end);
  libevo::VectorEnv other(libevo::Task("Walker-v0"), {walker});
  fails(Error::Kind::data, "another", [&] { other.restore(0, state); });
}

TEST_CASE("api: episodes are counted on, and a seed begins anew") {
  libevo::VectorEnv envs(libevo::Task("BidirectionalWalker-v0"), {small}, 2);
  const auto start = [&](const libevo::Start& how) {
    envs.reset(how);
    return copy(envs.observations());
  };
  const auto first = start({.seed = 9});
  const auto second = start({});
  CHECK(first != second);
  CHECK(start({.seed = 9}) == first);
  CHECK(start({}) == second);
  envs.reset(1, {.seed = 9, .episode = 1});
  CHECK(copy(envs.observation(1)) ==
        std::vector(first.begin() + envs.observation_length(0), first.end()));
}

TEST_CASE("api: environments that take no part stay as they are") {
  libevo::VectorEnv envs(libevo::Task("Walker-v0"), {walker}, 2);
  envs.reset();
  const auto before = copy(envs.observation(0));
  const std::vector<std::uint8_t> active{0, 1};
  envs.step(wave(envs.action_values(), 1), active);
  CHECK(copy(envs.observation(0)) == before);
  CHECK(copy(envs.observation(1)) != before);
  CHECK(envs.steps()[0] == 0);
  CHECK(envs.steps()[1] == 1);
}

TEST_CASE("api: an episode ends with its time and goes on if it is told to") {
  libevo::Task task("Walker-v0");
  libevo::VectorEnv envs(task, {small});
  envs.reset();
  const std::vector<double> rest(4, 1.0);
  for (int t = 0; t < task.episode_steps(); ++t) {
    CHECK(envs.truncated()[0] == 0);
    envs.step(rest);
  }
  CHECK(envs.truncated()[0] == 1);
  CHECK(envs.terminated()[0] == 0);
  envs.step(rest);
  CHECK(envs.steps()[0] == task.episode_steps() + 1);
}

TEST_CASE("api: physics can be changed, of one task and not of its copy") {
  const libevo::Task plain("Walker-v0");
  libevo::Task changed = plain;
  changed.set("gravity=50");
  changed.set_physics("paper");
  changed.set("gravity=55");
  const auto after = [](const libevo::Task& task) {
    libevo::VectorEnv envs(task, {walker});
    envs.reset();
    for (int t = 0; t < 10; ++t) envs.step(wave(envs.action_values(), t));
    return copy(envs.observations());
  };
  CHECK(after(plain) == after(libevo::Task("Walker-v0")));
  CHECK(after(plain) != after(changed));
  fails(Error::Kind::usage, "gravity", [&] { changed.set("gravty=1"); });
}

TEST_CASE("api: the world is there to look at") {
  libevo::VectorEnv envs(libevo::Task("Carrier-v0"), {small});
  envs.reset();
  const auto objects = envs.objects(0);
  const auto robot = std::find_if(objects.begin(), objects.end(),
                                  [](const auto& object) { return object.name == "robot"; });
  REQUIRE(robot != objects.end());
  CHECK(robot->points == 9);  // corners of 2x2 voxels
  const auto positions = envs.positions(0);
  REQUIRE(positions.size() == envs.velocities(0).size());
  const auto [left, right] = std::minmax_element(
      positions.begin() + static_cast<std::ptrdiff_t>(robot->first_point),
      positions.begin() + static_cast<std::ptrdiff_t>(robot->first_point + robot->points),
      [](const auto& a, const auto& b) { return a.x < b.x; });
  CHECK(right->x - left->x == Approx(0.2));
}

TEST_CASE("api: robots from rows, text and files") {
  CHECK(walker.rows() == std::vector<std::string>{"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"});
  const auto read = libevo::parse_robots(walker.json() + "\n" + small.json() + "\n");
  REQUIRE(read.size() == 2);
  CHECK(read[0].id() == walker.id());
  CHECK(read[1].id() == small.id());
  // Without one of the links between its voxels it is another robot.
  const auto cut =
      libevo::parse_robots(R"({"body":["HV","VH"],"connections":[[0,1],[0,2],[1,3]]})");
  CHECK(cut.at(0).id() != small.id());
  fails(Error::Kind::no_input, "none.json", [] { libevo::read_robots("none.json"); });
}

TEST_CASE("api: what makes no sense is refused in words and changes nothing") {
  using libevo::Robot, libevo::Task, libevo::VectorEnv;
  fails(Error::Kind::usage, "Walker-v0", [] { Task("Walkr-v0"); });
  fails(Error::Kind::no_input, "none.yaml", [] { Task("none.yaml"); });
  fails(Error::Kind::data, "actuator", [] { Robot({"RR"}); });
  fails(Error::Kind::data, "X", [] { Robot({"HX"}); });
  fails(Error::Kind::data, "", [] { Robot(std::vector<std::string>{}); });
  fails(Error::Kind::data, "", [] { Robot({"H\xff"}); });
  const Task task("Walker-v0");
  fails(Error::Kind::usage, "robot", [&] { VectorEnv(task, {}); });
  fails(Error::Kind::usage, "thread", [&] { VectorEnv(task, {small}, 1, 0); });
  fails(Error::Kind::usage, "environments", [&] { VectorEnv(task, {small}, 0); });

  VectorEnv envs(task, {small}, 2);
  const auto actions = wave(envs.action_values(), 0);
  fails(Error::Kind::usage, "reset", [&] { envs.step(actions); });
  CHECK(envs.status(1) == libevo::Status::unreset);
  envs.reset();
  const auto before = copy(envs.observations());
  fails(Error::Kind::usage, "8 actions", [&] { envs.step(std::span(actions).subspan(1)); });
  fails(Error::Kind::usage, "active", [&] { envs.step(actions, std::vector<std::uint8_t>{1}); });
  auto bad = actions;
  bad[6] = std::numeric_limits<double>::quiet_NaN();
  fails(Error::Kind::usage, "action 2 of environment 1", [&] { envs.step(bad); });
  fails(Error::Kind::usage, "jitter", [&] { envs.reset({.jitter = 0.6}); });
  fails(Error::Kind::usage, "no environment 2", [&] { envs.reset(2); });
  fails(Error::Kind::usage, "no environment -1", [&] { (void)envs.observation(-1); });
  fails(Error::Kind::usage, "no environment 7", [&] { (void)envs.positions(7); });
  CHECK(copy(envs.observations()) == before);
  CHECK(envs.steps()[0] == 0);
}

TEST_CASE("api: a modular policy at work on bodies that it was not trained on") {
  const libevo::Task task("Walker-v0");
  const libevo::Policy policy =
      libevo::train(task, small, {.profile = "modular", .set = {"environments=2"}, .steps = 512});
  CHECK(policy.action_length() == 0);
  libevo::VectorEnv both(task, {small, walker}, 2);
  libevo::VectorEnv alone(task, {walker});
  both.reset();
  alone.reset();
  std::vector<double> actions(both.action_values());
  std::vector<double> of_one(alone.action_values());
  for (int t = 0; t < 20; ++t) {
    both.act(policy, actions);
    alone.act(policy, of_one);
    const auto begin = actions.begin() + static_cast<std::ptrdiff_t>(both.action_offset(2));
    REQUIRE(std::equal(of_one.begin(), of_one.end(), begin));
    both.step(actions);
    alone.step(of_one);
  }
  const evo_voxels voxels = both.voxels(2);
  CHECK(voxels.actions == of_one.size());
  CHECK(voxels.linked[0] == 0);
  std::vector<double> local(alone.voxels(0).voxels * voxels.local_length);
  std::vector<double> shown(voxels.task_length);
  alone.look(local, shown);
  CHECK(std::any_of(local.begin(), local.end(), [](double x) { return x != 0.0; }));
  fails(Error::Kind::usage, "local and", [&] { both.look(local, shown); });
  fails(Error::Kind::usage, "evo_envs_act", [&] { policy.act({}, both.steps(), actions); });
  fails(Error::Kind::usage, "actions are expected", [&] { both.act(policy, of_one); });
}

TEST_CASE("api: a training, its file, and the policy at work") {
  const libevo::Task task("Walker-v0");
  std::int64_t seen = 0;
  // Judged by one episode from the official start, as it is played below.
  const libevo::TrainingOptions options{.set = {"evaluation_episodes=1", "evaluation_jitter=0"},
                                        .steps = 4096,
                                        .seed = 3,
                                        .go_on = [&](std::int64_t step) {
                                          CHECK(step >= seen);  // the final episodes take no more
                                          seen = step;
                                          return true;
                                        }};
  const libevo::Policy trained = libevo::train(task, small, options);
  CHECK(seen == 4096);
  REQUIRE_FALSE(trained.curve().empty());
  CHECK(trained.curve().back().best == trained.fitness());

  const std::filesystem::path file = std::filesystem::temp_directory_path() / "api.policy.h5";
  trained.save(file.string());
  const libevo::Policy policy(file.string());
  std::filesystem::remove(file);
  CHECK(policy.fitness() == trained.fitness());
  CHECK(policy.robot().id() == small.id());
  CHECK(policy.task().name() == "Walker-v0");

  libevo::VectorEnv envs(policy.task(), {policy.robot()});
  CHECK(policy.observation_length() == envs.observation_length(0));
  CHECK(policy.action_length() == envs.action_length(0));
  envs.reset();
  std::vector<double> actions(envs.action_values());
  double earned = 0;
  while (envs.truncated()[0] == 0 && envs.terminated()[0] == 0) {
    policy.act(envs.observations(), envs.steps(), actions);
    envs.step(actions);
    earned += envs.rewards()[0];
  }
  CHECK(earned == trained.fitness());
  fails(Error::Kind::usage, "observations",
        [&] { policy.act(envs.observations().subspan(1), envs.steps(), actions); });
}

TEST_CASE("api: a training can be ended, and what its caller throws passes through") {
  const libevo::Task task("Walker-v0");
  fails(Error::Kind::work, "ended", [&] {
    libevo::train(task, small, {.steps = 8192, .go_on = [](std::int64_t) { return false; }});
  });
  struct Enough {};
  CHECK_THROWS_AS(
      libevo::train(task, small,
                    {.steps = 8192, .go_on = [](std::int64_t) -> bool { throw Enough(); }}),
      Enough);
  fails(Error::Kind::usage, "gamma", [&] { libevo::train(task, small, {.set = {"gamm=1"}}); });
  fails(Error::Kind::usage, "steps", [&] { libevo::train(task, small, {.steps = 0}); });
  fails(Error::Kind::usage, "paper", [&] { libevo::train(task, small, {.profile = "papr"}); });
}

TEST_CASE("api: values are copied, environments moved") {
  static_assert(std::is_copy_constructible_v<libevo::Task>);
  static_assert(std::is_copy_assignable_v<libevo::Robot>);
  static_assert(std::is_copy_assignable_v<libevo::Policy>);
  static_assert(!std::is_copy_constructible_v<libevo::VectorEnv>);
  static_assert(std::is_nothrow_move_constructible_v<libevo::VectorEnv>);
  libevo::Robot robot = small;
  robot = walker;
  CHECK(robot.id() == walker.id());
  CHECK(robot.id() != small.id());
  libevo::VectorEnv envs(libevo::Task("Walker-v0"), {robot});
  envs.reset();
  const auto before = copy(envs.observations());
  const libevo::VectorEnv moved = std::move(envs);
  CHECK(copy(moved.observations()) == before);
  CHECK(std::string(libevo::version()) == EVO_LIBRARY_VERSION);
}
