// The library as a program in C sees it: nothing here includes more than its header.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "evo/evo.h"

extern "C" {
extern const size_t sizes_in_c[];
extern const size_t sizes_in_c_count;
}

namespace {

using Catch::Contains;

void fails(int expected, const std::string& text, int result) {
  CHECK(result == expected);
  CHECK_THAT(evo_error(), Contains(text));
}

const std::vector<std::uint8_t> corner{EVO_HORIZONTAL, EVO_VERTICAL, EVO_VERTICAL, EVO_HORIZONTAL};

evo_world* world_of_two() {
  evo_world* world = nullptr;
  REQUIRE(evo_world_new(&world) == EVO_OK);
  const std::vector<std::uint8_t> ground(20, EVO_FIXED);
  REQUIRE(evo_world_add(world, "ground", ground.data(), 1, 20, nullptr, 0, 0, 0) == EVO_OK);
  REQUIRE(evo_world_add(world, "right", corner.data(), 2, 2, nullptr, 0, 9, 1) == EVO_OK);
  REQUIRE(evo_world_add(world, "left", corner.data(), 2, 2, nullptr, 0, 4, 1) == EVO_OK);
  return world;
}

std::vector<double> wave(std::size_t count, int t) {
  std::vector<double> targets(count);
  for (std::size_t i = 0; i < count; ++i)
    targets[i] = 1.1 + 0.5 * std::sin(0.3 * t + 0.7 * static_cast<double>(i));
  return targets;
}

evo_sim_arrays arrays_of(const evo_sims* sims) {
  evo_sim_arrays arrays{};
  REQUIRE(evo_sims_arrays(sims, &arrays, sizeof arrays) == EVO_OK);
  return arrays;
}

std::vector<double> positions_of(const evo_sims* sims, std::size_t sim) {
  const evo_sim_arrays at = arrays_of(sims);
  const double* first = at.positions + 2 * at.points * sim;
  return {first, first + 2 * at.points};
}

struct Session {
  evo_task* task = nullptr;
  evo_robots* robots = nullptr;
  evo_envs* envs = nullptr;

  explicit Session(const char* name, int count = 1, int threads = 1) {
    REQUIRE(evo_task_open(name, &task) == EVO_OK);
    REQUIRE(evo_robots_parse("HV\nVH\n", &robots) == EVO_OK);
    REQUIRE(evo_envs_open(task, robots, count, threads, &envs) == EVO_OK);
  }
  ~Session() {
    evo_envs_free(envs);
    evo_robots_free(robots);
    evo_task_free(task);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

}  // namespace

// A program built with this header counts on these (x86-64 and AArch64 alike).
TEST_CASE("c: the sizes of structs are those that programs were built with") {
  const std::vector<size_t> pinned{48, 32, 120, 40, 24, 72, 40, 24, 48, 56, 48, 56, 72, 72, 80};
  CHECK(std::vector<size_t>(sizes_in_c, sizes_in_c + sizes_in_c_count) == pinned);
}

TEST_CASE("c: a start is moved by at most what is said") {
  const Session s("Carrier-v0", 3, 2);
  evo_arrays at{};
  REQUIRE(evo_envs_arrays(s.envs, &at, sizeof at) == EVO_OK);
  REQUIRE(evo_envs_reset(s.envs, nullptr, 0, nullptr) == EVO_OK);
  const double before = at.positions[2 * at.point_offsets[1]];
  evo_start start{};
  start.jitter = 1e-3;
  REQUIRE(evo_envs_reset(s.envs, nullptr, 0, &start) == EVO_OK);
  const double moved = std::abs(at.positions[2 * at.point_offsets[1]] - before);
  CHECK(moved > 0);
  CHECK(moved <= 1e-4);
  start.jitter = -1;
  fails(EVO_USAGE, "jitter", evo_envs_reset(s.envs, nullptr, 0, &start));
}

TEST_CASE("c: gradients are pulled back through each step that was kept, once") {
  evo_world* world = world_of_two();
  evo_sims* sims = nullptr;
  REQUIRE(evo_sims_open(world, nullptr, 1, 1, &sims) == EVO_OK);
  evo_world_free(world);
  const evo_sim_arrays at = arrays_of(sims);
  std::vector<double> positions(at.points * 2), velocities(positions.size()),
      previous(positions.size()), targets(at.actuators);
  evo_sim_gradients by{
      at.sims,           at.points,       at.actuators,   at.voxels, positions.data(),
      velocities.data(), previous.data(), targets.data(), nullptr,   nullptr};
  fails(EVO_USAGE, "no step is kept", evo_sims_pull_back(sims, &by, sizeof by));
  fails(EVO_USAGE, "0 to 0.1 voxels", evo_sims_record(sims, 0.5));
  REQUIRE(evo_sims_record(sims, 0.0) == EVO_OK);
  REQUIRE(evo_sims_step(sims, wave(at.actuators, 0).data(), at.actuators, nullptr, 0) == EVO_OK);
  REQUIRE(evo_sims_pull_back(sims, &by, sizeof by) == EVO_OK);
  fails(EVO_USAGE, "no step is kept", evo_sims_pull_back(sims, &by, sizeof by));
  by.points = 1;
  fails(EVO_USAGE, "points", evo_sims_pull_back(sims, &by, sizeof by));
  evo_sims_free(sims);
}

TEST_CASE("c: simulations of a world stand still, continue and are moved, each by itself") {
  evo_world* world = world_of_two();
  evo_sims* sims = nullptr;
  REQUIRE(evo_sims_open(world, nullptr, 3, 2, &sims) == EVO_OK);
  const auto begin = positions_of(sims, 2);
  const std::vector<std::uint8_t> active{1, 1, 0};
  for (int t = 0; t < 30; ++t) {
    auto targets = wave(24, t);
    std::copy_n(targets.begin(), 8, targets.begin() + 8);  // the second as the first
    REQUIRE(evo_sims_step(sims, targets.data(), targets.size(), active.data(), 3) == EVO_OK);
  }
  CHECK(positions_of(sims, 0) == positions_of(sims, 1));
  CHECK(positions_of(sims, 2) == begin);
  double angles[3] = {9, 9, 9};
  REQUIRE(evo_sims_orientation(sims, 0, nullptr, angles, 3) == EVO_OK);
  double again_at[1] = {9};
  REQUIRE(evo_sims_orientation(sims, 0, arrays_of(sims).positions, again_at, 1) == EVO_OK);
  CHECK(again_at[0] == angles[0]);
  CHECK(angles[0] == angles[1]);

  REQUIRE(evo_sims_reset(sims, -1) == EVO_OK);
  evo_sim_object right{};
  REQUIRE(evo_sims_object(sims, 1, &right, sizeof right) == EVO_OK);
  REQUIRE(evo_sims_translate(sims, 0, 1, 0.5, 0.25) == EVO_OK);
  auto moved = begin;
  for (std::size_t i = right.first_point; i < right.first_point + right.points; ++i) {
    moved[2 * i] += 0.5;
    moved[2 * i + 1] += 0.25;
  }
  CHECK(positions_of(sims, 0) == moved);
  CHECK(positions_of(sims, 1) == begin);
  fails(EVO_USAGE, "no object 3", evo_sims_translate(sims, 0, 3, 0.5, 0));
  fails(EVO_USAGE, "cannot be moved", evo_sims_translate(sims, 0, 1, std::nan(""), 0));

  void* state = nullptr;
  size_t count = 0;
  REQUIRE(evo_sims_save(sims, 0, &state, &count) == EVO_OK);
  fails(EVO_DATA, "damaged", evo_sims_restore(sims, 0, state, 3));
  evo_sims* of_another_world = nullptr;
  REQUIRE(evo_world_move(world, "left", 5, 1) == EVO_OK);
  REQUIRE(evo_sims_open(world, "paper", 1, 1, &of_another_world) == EVO_OK);
  fails(EVO_DATA, "another world", evo_sims_restore(of_another_world, 0, state, count));
  evo_free(state);
  evo_sims_free(of_another_world);
  evo_world_free(world);
  evo_sims_free(sims);
}

TEST_CASE("c: objects that cannot stand in a world are refused") {
  evo_world* world = world_of_two();
  const auto refused = [&](const char* text, const char* name, int rows, int columns, int x) {
    CAPTURE(name, rows, columns, x);
    fails(EVO_USAGE, text,
          evo_world_add(world, name, corner.data(), rows, columns, nullptr, 0, x, 5));
  };
  refused("name", "", 2, 2, 1);
  refused("outside", "x", 2, 2, INT32_MAX - 1);
  refused("rows", "x", 0, 2, 1);
  refused("rows", "x", 1 << 30, 1 << 30, 1);
  fails(EVO_USAGE, "outside", evo_world_move(world, "left", 1, INT32_MAX));
  const std::uint8_t unknown = 9;
  fails(EVO_USAGE, "voxel 0 is 9", evo_world_add(world, "x", &unknown, 1, 1, nullptr, 0, 1, 5));
  const std::int32_t far[] = {0, 3};
  fails(EVO_USAGE, "", evo_world_add(world, "x", corner.data(), 2, 2, far, 1, 1, 5));
  fails(EVO_USAGE, "no object", evo_world_remove(world, "nothing"));
  REQUIRE(evo_world_move(world, "left", 9, 1) == EVO_OK);
  evo_sims* sims = nullptr;
  CHECK(evo_sims_open(world, nullptr, 1, 1, &sims) == EVO_DATA);  // in one cell
  CHECK(sims == nullptr);
  REQUIRE(evo_world_remove(world, "left") == EVO_OK);
  REQUIRE(evo_sims_open(world, nullptr, 1, 1, &sims) == EVO_OK);
  evo_sims* const before = sims;
  fails(EVO_USAGE, "thread", evo_sims_open(world, nullptr, 1, 0, &sims));
  fails(EVO_USAGE, "1024 threads", evo_sims_open(world, nullptr, 1, 1'000'000, &sims));
  CHECK(sims == before);  // a failed call changes nothing
  evo_sims_free(sims);
  evo_world_free(world);
}

TEST_CASE("c: misuse is answered, not died of") {
  const Session s("Walker-v0", 2);
  evo_arrays at{};
  fails(EVO_USAGE, "evo_task is expected, not NULL", evo_task_set_physics(nullptr, nullptr, 0));
  evo_task* task = nullptr;
  fails(EVO_USAGE, "`name_or_file` is NULL", evo_task_open(nullptr, &task));
  fails(EVO_USAGE, "`words` is NULL", evo_task_set_physics(s.task, nullptr, 1));
  fails(EVO_USAGE, "not of evo_robots",
        evo_task_set_physics(reinterpret_cast<evo_task*>(s.robots), nullptr, 0));
  fails(EVO_USAGE, "struct", evo_envs_arrays(s.envs, nullptr, sizeof at));
  fails(EVO_USAGE, "bytes is not of this version", evo_envs_arrays(s.envs, &at, sizeof at + 8));
  fails(EVO_USAGE, "bytes is not of this version", evo_envs_arrays(s.envs, &at, 0));
  CHECK(evo_envs_arrays(s.envs, &at, 16) == EVO_OK);  // of a caller who knows less
  fails(EVO_USAGE, "`actions` is NULL", evo_envs_step(s.envs, nullptr, 8, nullptr, 0));
  const std::vector<double> actions(8, 1.0);
  const std::uint8_t active[1] = {1};
  fails(EVO_USAGE, "`active` has 1", evo_envs_step(s.envs, actions.data(), 8, active, 1));
  const std::int32_t none[] = {2};
  fails(EVO_USAGE, "no environment 2", evo_envs_reset(s.envs, none, 1, nullptr));
  fails(EVO_USAGE, "no environment -1", evo_envs_restore(s.envs, -1, actions.data(), 8));
  fails(EVO_USAGE, "`bytes` is NULL", evo_envs_restore(s.envs, 0, nullptr, 8));
  evo_object object{};
  fails(EVO_USAGE, "no object 99", evo_envs_object(s.envs, 0, 99, &object, sizeof object));
  evo_robot_facts robot{};
  fails(EVO_USAGE, "no robot 1", evo_robots_describe(s.robots, 1, &robot, sizeof robot));
  fails(EVO_USAGE, "no robot 5", evo_robots_append(s.robots, s.robots, 5));
  evo_envs* envs = nullptr;
  fails(EVO_USAGE, "thread", evo_envs_open(s.task, s.robots, 1, 0, &envs));
  fails(EVO_USAGE, "environments", evo_envs_open(s.task, s.robots, 0, 1, &envs));
  evo_policy* policy = nullptr;
  fails(EVO_NO_INPUT, "none.h5", evo_policy_read("none.h5", &policy));
  CHECK(policy == nullptr);
  const char* const settings[] = {nullptr};
  const evo_training training{nullptr, settings, 1, 1024, 0, nullptr, nullptr};
  fails(EVO_USAGE, "`set` is NULL",
        evo_train(s.task, s.robots, 0, &training, sizeof training, &policy));

  evo_task* freed = nullptr;
  REQUIRE(evo_task_open("Walker-v0", &freed) == EVO_OK);
  evo_task_free(freed);
  evo_task_free(freed);  // again
  fails(EVO_USAGE, "was freed", evo_task_set_physics(freed, nullptr, 0));
  evo_task_free(nullptr);
  evo_envs_free(reinterpret_cast<evo_envs*>(s.task));  // of another kind: left alone
  evo_task_facts facts{};
  CHECK(evo_task_describe(s.task, &facts, sizeof facts) == EVO_OK);
  CHECK(std::string(facts.name) == "Walker-v0");
}

TEST_CASE("c: the last error is the thread's own") {
  CHECK(evo_task_set_physics(nullptr, nullptr, 0) == EVO_USAGE);
  const std::string mine = evo_error();
  std::thread([] { CHECK(std::string(evo_error()).empty()); }).join();
  CHECK(evo_error() == mine);
}

TEST_CASE("c: pictures of environments, simulations and robots, and the same in a child") {
  const Session s("Walker-v0", 2);
  evo_view view{160, 80, 0, 0, {0, 0, 0, 0}};
  std::vector<std::uint8_t> pixels(std::size_t{160} * 80 * 3);
  const auto draw = [&](const double* positions) {
    return evo_envs_render(s.envs, 1, positions, &view, sizeof view, pixels.data(), pixels.size());
  };
  fails(EVO_USAGE, "reset", draw(nullptr));
  REQUIRE(evo_envs_reset(s.envs, nullptr, 0, nullptr) == EVO_OK);
  REQUIRE(draw(nullptr) == EVO_OK);
  const std::vector<std::uint8_t> start = pixels;
  CHECK(std::count(start.begin(), start.end(), start[0]) < 160 * 80 * 2);
  evo_arrays at{};
  REQUIRE(evo_envs_arrays(s.envs, &at, sizeof at) == EVO_OK);
  const double* own = at.positions + 2 * at.point_offsets[1];
  const std::vector<double> kept(own, at.positions + 2 * at.points);
  for (int t = 0; t < 8; ++t) {
    const auto actions = wave(at.action_values, t);
    REQUIRE(evo_envs_step(s.envs, actions.data(), actions.size(), nullptr, 0) == EVO_OK);
  }
  REQUIRE(draw(nullptr) == EVO_OK);
  CHECK(pixels != start);
  REQUIRE(draw(kept.data()) == EVO_OK);
  CHECK(pixels == start);

  // No OpenGL, so that a forked process draws, too.
  const pid_t child = fork();
  if (child == 0) _exit(draw(kept.data()) == EVO_OK && pixels == start ? 0 : 1);
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(status == 0);

  evo_world* world = world_of_two();
  evo_sims* sims = nullptr;
  REQUIRE(evo_sims_open(world, nullptr, 1, 1, &sims) == EVO_OK);
  const auto watch = [&] {
    return evo_sims_render(sims, 0, nullptr, &view, sizeof view, pixels.data(), pixels.size());
  };
  view.window[2] = view.window[3] = 20;
  view.hide = 16;
  fails(EVO_USAGE, "no sum of evo_hide", watch());
  view.hide = 0;
  view.window[3] = 0;
  fails(EVO_USAGE, "shows nothing", watch());
  view.window[3] = std::nan("");
  fails(EVO_USAGE, "window", watch());
  view.window[3] = 20;
  view.width = 200;
  fails(EVO_USAGE, "bytes", watch());
  view.width = -1;
  fails(EVO_USAGE, "each side may be", watch());
  fails(EVO_USAGE, "struct of",
        evo_sims_render(sims, 0, nullptr, &view, sizeof view + 1, pixels.data(), pixels.size()));
  fails(EVO_USAGE, "pixels",
        evo_sims_render(sims, 0, nullptr, nullptr, 0, nullptr, std::size_t{600} * 300 * 3));
  evo_sims_free(sims);
  evo_world_free(world);

  char* svg = nullptr;
  REQUIRE(evo_robots_svg(s.robots, 0, 200, &svg) == EVO_OK);
  CHECK_THAT(svg, Contains("<svg") && Contains("</svg>"));
  evo_free(svg);
  fails(EVO_USAGE, "pixels wide", evo_robots_svg(s.robots, 0, 0, &svg));
}

TEST_CASE("c: a child steps on with one thread; with more it is refused, and frees all the same") {
  const int threads = GENERATE(1, 2);
  Session s("Walker-v0", 4, threads);
  REQUIRE(evo_envs_reset(s.envs, nullptr, 0, nullptr) == EVO_OK);
  const std::vector<double> actions(16, 1.0);
  const auto step = [&] { return evo_envs_step(s.envs, actions.data(), 16, nullptr, 0); };
  const pid_t child = fork();
  if (child == 0) {
    const bool as_said =
        threads == 1 ? step() == EVO_OK
                     : step() == EVO_USAGE && std::strstr(evo_error(), "forked process") != nullptr;
    evo_envs_free(s.envs);  // without waiting for threads that are not there
    _exit(as_said ? 0 : 1);
  }
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(status == 0);
  CHECK(step() == EVO_OK);
}

TEST_CASE("c: the learner, asked from outside, gives the policy that a training does") {
  const Session s("Walker-v0", 4);
  evo_robot_facts robot{};
  REQUIRE(evo_robots_describe(s.robots, 0, &robot, sizeof robot) == EVO_OK);
  const std::vector<const char*> set{"environments=4", "rollout=32", "minibatches=4",
                                     "evaluation_interval=2", "steps=256"};
  const evo_training training{"paper", set.data(), set.size(), 0, 3, nullptr, nullptr};
  evo_policy* expected = nullptr;
  REQUIRE(evo_train(s.task, s.robots, 0, &training, sizeof training, &expected) == EVO_OK);

  evo_arrays at{};
  REQUIRE(evo_envs_arrays(s.envs, &at, sizeof at) == EVO_OK);
  const auto length = static_cast<int32_t>(at.observation_values / 4);
  evo_learner* learner = nullptr;
  const auto open = [&](int32_t observations, double high) {
    return evo_learner_open(&training, sizeof training, observations, 4, 0.6, high, robot.id,
                            &learner);
  };
  fails(EVO_USAGE, "no range", open(length, 0.6));
  fails(EVO_USAGE, "1 or more", open(0, 1.6));
  REQUIRE(open(length, 1.6) == EVO_OK);
  evo_learner_facts facts{};
  REQUIRE(evo_learner_describe(learner, &facts, sizeof facts) == EVO_OK);
  REQUIRE((facts.environments == 4 && facts.rollout == 32 && facts.updates == 2));

  REQUIRE(evo_envs_reset(s.envs, nullptr, 0, nullptr) == EVO_OK);
  std::vector<double> actions(16);
  const auto observe = [&] {
    return evo_learner_observe(learner, at.observations, at.observation_values, at.steps, 4);
  };
  const auto act = [&] { return evo_learner_act(learner, actions.data(), actions.size()); };
  fails(EVO_USAGE, "evo_learner_act is out of turn: evo_learner_observe is next", act());
  REQUIRE(observe() == EVO_OK);
  fails(EVO_USAGE, "0 of its 32 rounds", evo_learner_learn(learner));
  evo_policy* found = nullptr;
  for (int64_t update = 0; update < facts.updates; ++update) {
    for (int t = 0; t < facts.rollout; ++t) {
      REQUIRE(act() == EVO_OK);
      REQUIRE(evo_envs_step(s.envs, actions.data(), 16, nullptr, 0) == EVO_OK);
      REQUIRE(evo_learner_reward(learner, at.rewards, at.terminated, at.truncated, at.observations,
                                 at.observation_values, at.steps, 4) == EVO_OK);
      REQUIRE(observe() == EVO_OK);
    }
    fails(EVO_USAGE, "evo_learner_learn is next", act());
    REQUIRE(evo_learner_learn(learner) == EVO_OK);
  }
  const evo_curve_point point{256, 1.5, 1.5};
  REQUIRE(evo_learner_policy(learner, s.robots, 0, "Walk", &point, 1, &found) == EVO_OK);
  evo_policy_facts described{};
  REQUIRE(evo_policy_describe(found, &described, sizeof described) == EVO_OK);
  CHECK(described.fitness == 1.5);

  const auto answer = [&](const evo_policy* policy) {
    std::vector<double> out(16);
    const std::vector<int32_t> steps(4, 7);
    REQUIRE(evo_policy_act(policy, at.observations, steps.data(), 4, out.data(), 16) == EVO_OK);
    return out;
  };
  CHECK(answer(expected) == answer(found));

  const double wild = std::nan("");
  REQUIRE(act() == EVO_OK);
  const std::vector<double> rewards(4, wild);
  const auto end = [&] {
    return evo_learner_reward(learner, rewards.data(), at.terminated, at.truncated, at.observations,
                              at.observation_values, at.steps, 4);
  };
  fails(EVO_WORK, "reward is not a finite number", end());
  fails(EVO_WORK, "reward is not a finite number", end());
  evo_policy_free(expected);
  evo_policy_free(found);
  evo_learner_free(learner);
}

// A handle, of whatever kind a function takes it for.
struct AnyHandle {
  void* at;
  template <typename T>
  operator T*() const {  // NOLINT(google-explicit-constructor): that is its use
    return static_cast<T*>(at);
  }
};

// Where a function is to write: a place, or nowhere.
struct Writes {
  bool given;
  template <typename T>
  T* operator()(T& place) const {
    return given ? &place : nullptr;
  }
};

TEST_CASE("c: every function refuses handles of other kinds, and NULL where it writes") {
  const Session s("Walker-v0");
  char* text = nullptr;
  void* state = nullptr;
  size_t count = 0;
  double number = 0;
  const std::int32_t step = 0;
  const std::int32_t nowhere = 99;
  const std::uint8_t no = 0;
  evo_task* task = nullptr;
  evo_envs* envs = nullptr;
  evo_sims* sims = nullptr;
  evo_policy* policy = nullptr;
  evo_task_facts task_facts{};
  evo_robot_facts robot{};
  evo_arrays at{};
  evo_object object{};
  evo_voxels voxels{};
  evo_sim_arrays sim_at{};
  evo_sim_object sim_object{};
  evo_policy_facts policy_facts{};
  evo_learner_facts learner_facts{};

  // With a handle that is none, and places to write to; or with a good one, and no places.
  using H = AnyHandle;
  using W = Writes;
  const std::vector<std::function<int(H handle, W places)>> calls{
      [&](H h, W) { return evo_task_set_physics(h, nullptr, 1); },
      [&](H h, W w) { return evo_task_describe(h, w(task_facts), sizeof task_facts); },
      [&](H h, W w) { return evo_robots_count(h, w(count)); },
      [&](H h, W) { return evo_robots_append(h, nullptr, 0); },
      [&](H h, W w) { return evo_robots_describe(h, 0, w(robot), sizeof robot); },
      [&](H h, W w) { return evo_robots_svg(h, 0, 100, w(text)); },
      [&](H h, W w) { return evo_envs_open(h, s.robots, 1, 1, w(envs)); },
      [&](H h, W w) { return evo_envs_open(s.task, h, 1, 1, w(envs)); },
      [&](H h, W w) { return evo_envs_arrays(h, w(at), sizeof at); },
      [&](H h, W) { return evo_envs_reset(h, &nowhere, 1, nullptr); },
      [&](H h, W) { return evo_envs_step(h, nullptr, 4, nullptr, 0); },
      [&](H h, W w) { return evo_envs_save(h, 0, w(state), &count); },
      [&](H h, W) { return evo_envs_restore(h, 0, nullptr, 9); },
      [&](H h, W) { return evo_envs_translate(h, 0, 99, 0, 0); },
      [&](H h, W w) { return evo_envs_object_count(h, 0, w(count)); },
      [&](H h, W w) { return evo_envs_object(h, 0, 0, w(object), sizeof object); },
      [&](H h, W w) { return evo_envs_orientation(h, 0, 0, nullptr, w(number), 1); },
      [&](H h, W w) { return evo_envs_observed(h, 0, w(text)); },
      [&](H h, W w) { return evo_envs_voxels(h, 0, w(voxels), sizeof voxels); },
      [&](H h, W) { return evo_envs_look(h, nullptr, 4, nullptr, 1); },
      [&](H h, W) { return evo_envs_act(h, nullptr, nullptr, 4); },
      [&](H h, W) { return evo_envs_render(h, 0, nullptr, nullptr, 0, nullptr, 600 * 300 * 3); },
      [&](H h, W) { return evo_world_add(h, "a", nullptr, 1, 1, nullptr, 0, 0, 0); },
      [&](H h, W) { return evo_world_stiffen(h, "left", nullptr, 1); },
      [&](H h, W) { return evo_world_move(h, nullptr, 0, 0); },
      [&](H h, W) { return evo_world_remove(h, nullptr); },
      [&](H h, W w) { return evo_world_json(h, w(text)); },
      [&](H h, W w) { return evo_sims_open(h, nullptr, 1, 1, w(sims)); },
      [&](H h, W w) { return evo_sims_arrays(h, w(sim_at), sizeof sim_at); },
      [&](H h, W) { return evo_sims_reset(h, 99); },
      [&](H h, W) { return evo_sims_step(h, nullptr, 8, nullptr, 0); },
      [&](H h, W w) { return evo_sims_save(h, 0, w(state), &count); },
      [&](H h, W) { return evo_sims_restore(h, 0, nullptr, 9); },
      [&](H h, W) { return evo_sims_translate(h, 0, 99, 0, 0); },
      [&](H h, W) { return evo_sims_perturb(h, 99, 0.1, 1); },
      [&](H h, W w) { return evo_sims_object_count(h, w(count)); },
      [&](H h, W w) { return evo_sims_object(h, 0, w(sim_object), sizeof sim_object); },
      [&](H h, W w) { return evo_sims_orientation(h, 0, nullptr, w(number), 1); },
      [&](H h, W) { return evo_sims_render(h, 0, nullptr, nullptr, 0, nullptr, 600 * 300 * 3); },
      [&](H h, W) { return evo_policy_write(h, nullptr); },
      [&](H h, W) { return evo_policy_record(h, nullptr, nullptr, 0, nullptr); },
      [&](H h, W) { return evo_policy_set_final(h, 0, 1.0, 0.0); },
      [&](H h, W w) { return evo_policy_describe(h, w(policy_facts), sizeof policy_facts); },
      [&](H h, W w) { return evo_policy_task(h, w(task)); },
      [&](H h, W) { return evo_policy_act(h, nullptr, nullptr, 1, nullptr, 4); },
      [&](H h, W w) { return evo_train(h, s.robots, 0, nullptr, 0, w(policy)); },
      [&](H h, W w) { return evo_train(s.task, h, 0, nullptr, 0, w(policy)); },
      [&](H h, W w) { return evo_learner_describe(h, w(learner_facts), sizeof learner_facts); },
      [&](H h, W) { return evo_learner_observe(h, nullptr, 1, &step, 1); },
      [&](H h, W) { return evo_learner_act(h, nullptr, 1); },
      [&](H h, W) { return evo_learner_reward(h, &number, &no, &no, nullptr, 1, &step, 1); },
      [&](H h, W) { return evo_learner_learn(h); },
      [&](H h, W w) { return evo_learner_policy(h, s.robots, 0, "own", nullptr, 0, w(policy)); },
  };
  evo_world* freed = nullptr;
  REQUIRE(evo_world_new(&freed) == EVO_OK);
  evo_world_free(freed);
  std::vector<std::uint8_t> bytes(64);
  for (std::size_t k = 0; k < calls.size(); ++k)
    for (void* handle : std::initializer_list<void*>{nullptr, freed, bytes.data()}) {
      CAPTURE(k, handle);
      CHECK(calls[k]({handle}, {true}) == EVO_USAGE);
      CHECK(std::strlen(evo_error()) > 10);
    }
  evo_learner* learner = nullptr;
  const evo_training training{"default", nullptr, 0, 1 << 20, 0, nullptr, nullptr};
  REQUIRE(evo_learner_open(&training, sizeof training, 3, 2, 0.6, 1.6, "x", &learner) == EVO_OK);
  evo_world* world = world_of_two();
  REQUIRE(evo_sims_open(world, nullptr, 1, 1, &sims) == EVO_OK);
  for (std::size_t k = 0; k < calls.size(); ++k)
    for (void* handle :
         std::initializer_list<void*>{s.task, s.robots, s.envs, world, sims, learner}) {
      CAPTURE(k);
      // A handle of another kind, or nowhere to write to.
      CHECK(calls[k]({handle}, {false}) != EVO_OK);
    }
  evo_learner_free(learner);
  evo_sims_free(sims);
  evo_world_free(world);
}
