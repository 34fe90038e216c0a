// The whole way of a task, YAML to rewards, against trajectories measured on
// the reference simulator (tests/data/reference; docs/physics.md, "Accuracy").
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "formats/io/json.h"
#include "formats/rollout/episodes.h"
#include "formats/rollout/rollout.h"
#include "formats/task/task.h"
#include "libevo/task/env.h"

using namespace evo;
namespace fs = std::filesystem;

namespace {

double largest_difference(std::span<const double> ours, const double* theirs) {
  double largest = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const double difference = std::abs(ours[i] - theirs[i]);
    if (!(difference <= largest)) largest = difference;
  }
  return largest;
}

void replay(const Rollout& rollout, const TaskSpec& task) {
  const RolloutEpisode& episode = rollout.episodes.at(0);
  const Arena arena(task, rollout.robot.value().body);
  VecEnv env(arena, 1);
  env.reset(0, {read_draws(to_node(episode.random_draws, "random_draws"), task), 0.0, 0});
  const auto steps = static_cast<std::size_t>(episode.steps());
  const auto points = env.positions(0).size();
  const auto length = static_cast<std::size_t>(arena.observation_length());
  const auto actions = static_cast<std::size_t>(arena.action_length());
  REQUIRE(episode.positions.size() == (steps + 1) * points);
  REQUIRE(episode.observations.size() == (steps + 1) * length);
  REQUIRE(episode.actions.size() == steps * actions);
  double worst_observation = 0.0;
  double worst_reward = 0.0;
  for (std::size_t t = 0;; ++t) {
    CHECK(std::ranges::equal(env.positions(0),
                             std::span(episode.positions).subspan(t * points, points)));
    worst_observation =
        std::max(worst_observation,
                 largest_difference(env.observations(), &episode.observations[t * length]));
    if (t == steps) break;
    env.step(std::span(episode.actions).subspan(t * actions, actions));
    worst_reward = std::max(worst_reward, largest_difference(env.rewards(), &episode.rewards[t]));
    CHECK(env.terminated()[0] == episode.terminations[t]);
    CHECK(env.truncated()[0] == episode.truncations[t]);
  }
  CHECK(worst_observation < 1e-8);
  CHECK(worst_reward < 1e-9);
}

}  // namespace

TEST_CASE("every reference trajectory is reproduced, positions to the last bit") {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator("tests/data/reference")) {
    if (entry.path().extension() != ".h5") continue;
    INFO(entry.path().filename().string());
    const Rollout rollout = read_rollout(entry.path());
    replay(rollout, load_task(rollout.task, {"tasks"}));
    ++files;
  }
  CHECK(files == 70);  // two bodies in each of 32 tasks, and six special ones
}
