#include "formats/rollout/ending.h"

#include <catch2/catch.hpp>

#include "formats/io/files.h"

using namespace evo;

namespace {

// One step at that task after which a robot of one point is there, and the task is over.
Rollout ended_at(const std::string& task, Vec2 voxels) {
  Rollout rollout;
  rollout.task = task;
  rollout.task_yaml = read_file("tasks/" + task + ".yaml");
  rollout.points = 1;
  ModelObject robot;
  robot.name = "robot";
  robot.points = 1;
  rollout.world.objects.push_back(robot);
  RolloutEpisode episode;
  episode.rewards = {0.0};
  episode.terminations = {1};
  episode.truncations = {0};
  episode.positions = {{}, {0.1 * voxels.x, 0.1 * voxels.y}};
  rollout.episodes.push_back(episode);
  return rollout;
}

Ending of(const Rollout& rollout) { return ending(rollout, rollout.episodes.front()); }

}  // namespace

TEST_CASE("an episode's end is told as what the rule is worth") {
  const Ending walked = of(ended_at("Walker-v0", {99.5, 1}));
  CHECK(walked.kind == Ending::Kind::goal);
  CHECK(walked.text == "goal reached: robot beyond x = 99");
  // Of voxels of another size.
  Rollout large = ended_at("Walker-v0", {2 * 99.5, 2});
  large.physics_yaml = "voxel_length: 0.2\n";
  CHECK(of(large).kind == Ending::Kind::goal);
  large.episodes.front().positions.back().x = 0.2 * 98.5;
  CHECK(of(large).kind == Ending::Kind::rule);
  // A rule that pays nothing is neither: whoever flips along the whole ground gets there.
  const Ending flipped = of(ended_at("Flipper-v0", {0.5, 1}));
  CHECK(flipped.kind == Ending::Kind::rule);
  CHECK(flipped.text == "the task ends here: robot left of x = 1");
}
