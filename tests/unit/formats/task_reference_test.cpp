// The whole way of a task, YAML to rewards, against trajectories measured on
// the reference simulator (tests/data/reference; docs/physics.md, "Accuracy").
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "formats/io/hdf5.h"
#include "formats/robot/robot.h"
#include "formats/task/task.h"
#include "libevo/task/env.h"

using namespace evo;
namespace fs = std::filesystem;

namespace {

const DataFolders data{fs::path(EVO_SOURCE_DIR) / "tasks"};
const fs::path reference = fs::path(EVO_TEST_DATA) / "reference";

// Loose blocks in exact contact: after that the order of contact sums decides.
constexpr std::size_t traverser_steps = 8;

// A body without a task, falling onto the world floor.
const char* empty_world = R"(
name: floor
steps: 1000
robot: {at: [2, 3]}
world: {}
observation: [velocity: robot]
reward: []
)";

struct Case {
  std::string task;
  Body robot;
  Draws draws;
  std::size_t steps = 0;
  std::vector<double> actions, observations, rewards, positions;
  std::vector<std::uint8_t> terminations, truncations;
};

Case read_case(const fs::path& path) {
  const hdf5::Reader file(path);
  Case c;
  c.task = file.text("/", "task");
  c.robot = parse_robots(file.text("/", "robot"), path.string()).at(0).body;
  const Json draws = Json::parse(file.text("/", "random_draws"));
  for (const auto& [name, value] : draws.items()) {
    if (name == "goals")
      c.draws.goals = value.get<std::vector<int>>();
    else
      c.draws.integers[name] = value.get<int>();
  }
  c.actions = file.array<double>("/episode_0/actions").values;
  c.observations = file.array<double>("/episode_0/observations").values;
  c.rewards = file.array<double>("/episode_0/rewards").values;
  c.positions = file.array<double>("/episode_0/infos/positions").values;
  c.terminations = file.array<std::uint8_t>("/episode_0/terminations").values;
  c.truncations = file.array<std::uint8_t>("/episode_0/truncations").values;
  c.steps = c.rewards.size();
  return c;
}

double largest_difference(std::span<const double> ours, const std::vector<double>& theirs,
                          std::size_t row) {
  double largest = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const double difference = std::abs(ours[i] - theirs.at(row * ours.size() + i));
    if (!(difference <= largest)) largest = difference;
  }
  return largest;
}

double largest_distance(std::span<const Vec2> ours, const std::vector<double>& theirs,
                        std::size_t row) {
  double largest = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const std::size_t at = (row * ours.size() + i) * 2;
    const double difference =
        std::max(std::abs(ours[i].x - theirs.at(at)), std::abs(ours[i].y - theirs.at(at + 1)));
    if (!(difference <= largest)) largest = difference;
  }
  return largest;
}

struct Differences {
  double position = 0.0;
  double observation = 0.0;
  double reward = 0.0;
};

Differences replay(const TaskSpec& task, const Case& c, std::size_t steps, bool positions_only) {
  const Arena arena(task, c.robot);
  VecEnv env(arena, 1);
  env.reset(0, {c.draws, 0.0, 0});
  Differences worst;
  const auto compare = [&](std::size_t row) {
    worst.position = std::max(worst.position, largest_distance(env.positions(0), c.positions, row));
    if (!positions_only)
      worst.observation =
          std::max(worst.observation, largest_difference(env.observations(), c.observations, row));
  };
  compare(0);
  const auto actions = static_cast<std::size_t>(arena.action_length());
  for (std::size_t t = 0; t < steps; ++t) {
    env.step(std::span(c.actions).subspan(t * actions, actions));
    compare(t + 1);
    if (positions_only) continue;
    worst.reward = std::max(worst.reward, std::abs(env.rewards()[0] - c.rewards[t]));
    CHECK(env.terminated()[0] == c.terminations[t]);
    CHECK(env.truncated()[0] == c.truncations[t]);
  }
  return worst;
}

std::vector<fs::path> files(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".h5") found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

void check_case(const fs::path& path, const TaskSpec& task, const Case& c, std::size_t steps,
                bool positions_only = false) {
  const Differences worst = replay(task, c, steps, positions_only);
  INFO(path.filename().string() << ": positions " << worst.position << ", observations "
                                << worst.observation << ", rewards " << worst.reward);
  CHECK(worst.position < 1e-9);
  CHECK(worst.observation < 1e-8);
  CHECK(worst.reward < 1e-9);
}

}  // namespace

TEST_CASE("all tasks follow the reference trajectories") {
  const auto cases = files(reference);
  CHECK(cases.size() == 64);
  for (const fs::path& path : cases) {
    const Case c = read_case(path);
    const std::size_t steps =
        c.task == "Traverser-v0" ? std::min(c.steps, traverser_steps) : c.steps;
    check_case(path, load_task(c.task, data), c, steps);
  }
}

TEST_CASE("special bodies follow the reference trajectories") {
  const auto cases = files(reference / "extra");
  CHECK(cases.size() == 7);
  for (const fs::path& path : cases) {
    const Case c = read_case(path);
    const bool floor = path.stem() == "floor";
    check_case(path, floor ? parse_task(empty_world, "floor") : load_task(c.task, data), c, c.steps,
               floor);
  }
}
