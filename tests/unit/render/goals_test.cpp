#include "render/scene/goals.h"

#include <catch2/catch.hpp>

#include "example.h"
#include "formats/io/files.h"
#include "render/scene/clip.h"

namespace evo::render {
namespace {

TEST_CASE("the goal moves on when the robot's centre is nearer than the radius") {
  Rollout rollout;
  rollout.task_yaml = "goals: {start: 35, between: [20, 49], distance: 100, radius: 2}";
  RolloutEpisode episode;
  episode.random_draws = {{"goals", {37, 38, 30}}};
  const auto goals = [&](std::vector<Vec2> centres) {
    std::vector<double> places;
    for (const GoalOfStep& goal : goals_by_step(rollout, episode, centres))
      places.push_back(goal.x);
    return places;
  };
  // Nothing is reached at the start; exactly the radius is not near enough; two
  // goals may be reached at once; the last one stays.
  CHECK(goals({{36.5, 0}, {35, 0}, {35.01, 0}, {39, 0}}) == std::vector<double>{37, 37, 38, 30});
  CHECK(goals({{35, 0}, {36.5, 0}, {30, 0}, {20, 0}}) == std::vector<double>{37, 30, 30, 30});

  episode.random_draws = Json::object();
  CHECK(goals({{35, 0}}).empty());
  episode.random_draws = {{"goals", {37}}};
  rollout.task_yaml = "name: Walker-v0";
  CHECK(goals({{35, 0}}).empty());
}

TEST_CASE("a flag stands on the ground") {
  Rollout rollout = example::simulate("BidirectionalWalker-v0", example::walker, 5);
  rollout.task_yaml = read_file("tasks/BidirectionalWalker-v0.yaml");
  CHECK_FALSE(Clip({&rollout, 0, ""}, {}, 1.5).scene(3).goal);
  rollout.episodes[0].random_draws = {{"goals", {40, 20}}};
  const Clip clip({&rollout, 0, ""}, {}, 1.5);
  const auto goal = clip.scene(3).goal;
  REQUIRE(goal);
  CHECK(goal->at.x == 40);
  CHECK(goal->at.y == Approx(1));
  CHECK(goal->away == Approx(40 - clip.centre(3).x));
  CHECK(clip.caption(3).goal == "0 goals reached, next 4.5 voxels to the right");
}

}  // namespace
}  // namespace evo::render
