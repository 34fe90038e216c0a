#include "formats/training/identity.h"

#include <catch2/catch.hpp>

#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/training/training.h"

using namespace evo;

namespace {

const DataFolders data{"tasks"};

const Body robot = Body::from_rows({"HV", "VS"});

std::string lines(const TaskSpec& task, const TrainingSettings& settings = {},
                  std::uint64_t seed = 1) {
  return identify(robot, task, settings, seed).lines;
}

TaskSpec with_physics(TaskSpec task, const std::string& assignment) {
  change_physics(task, {assignment}, data);
  return task;
}

}  // namespace

TEST_CASE("the identity of Walker-v0, line by line") {
  TrainingSettings settings;
  settings.learning_rate = 0.1 + 0.2;
  settings.hidden = {32};
  const TaskSpec task = with_physics(load_task("Walker-v0", data), "rigid.edge=2.5");
  const std::string all = lines(task, settings);
  CHECK_THAT(all, Catch::StartsWith("evo-training 3\n"
                                    "robot=21d277a572ed\n"
                                    "seed=1\n"
                                    "task.name=Walker-v0\n"));
  for (const char* line : {"task.robot.at.1=1", "task.world.objects.ground.fill=#",
                           "task.observation.0.velocity=robot", "task.reward.0.displacement.axis=x",
                           "task.rules.0.when.0.position.above=99", "physics.rigid.edge=2.5",
                           "physics.substeps=30", "training.learning_rate=0.30000000000000004",
                           "training.hidden=[32]", "training.gamma=0.99"})
    CHECK_THAT(all, Catch::Contains(std::string("\n") + line + "\n"));
  // Every constant and every setting has its line.
  for (const SettingRow& row : physics_profiles().rows(task.physics))
    CHECK_THAT(all, Catch::Contains("\nphysics." + row.key + "="));
  for (const SettingRow& row : training_profiles().rows(settings))
    CHECK_THAT(all, Catch::Contains("\ntraining." + row.key + "="));
}

TEST_CASE("words do not matter, numbers do") {
  const TaskSpec task = load_task("Carrier-v0", data);
  TaskSpec reworded = task;
  reworded.description = "Something else.";
  reworded.difficulty = "hard";
  reworded.notes = {"a note"};
  reworded.aliases = {"another"};
  reworded.follow = {"package"};
  CHECK(lines(reworded) == lines(task));

  const auto differs = [&](const auto& change) {
    TaskSpec other = task;
    change(other);
    return lines(other) != lines(task);
  };
  CHECK(differs([](TaskSpec& t) { t.name = "Other"; }));
  CHECK(differs([](TaskSpec& t) { t.episode_steps += 1; }));
  CHECK(differs([](TaskSpec& t) { t.robot_x += 1; }));
  CHECK(differs([](TaskSpec& t) { t.objects[0].object.x += 1; }));
  CHECK(differs([](TaskSpec& t) { std::swap(t.objects[0], t.objects[1]); }));
  CHECK(differs([](TaskSpec& t) { std::swap(t.observation[0], t.observation[1]); }));
  CHECK(differs([](TaskSpec& t) { t.reward[0].weight = 1.0000000000000002; }));
  CHECK(differs([](TaskSpec& t) { t.reward.pop_back(); }));
  CHECK(differs([](TaskSpec& t) { t.folding_reward = -2.0; }));
  CHECK(lines(task, {}, 2) != lines(task, {}, 1));
  CHECK(identify(Body::from_rows({"HV", "SS"}), task, {}, 1).lines != lines(task));
}

TEST_CASE("what differs is said in a few words") {
  const TaskSpec task = load_task("Walker-v0", data);
  TrainingSettings settings;
  settings.steps = 1000;
  CHECK(difference(lines(task), lines(task)).empty());
  CHECK(difference(lines(task), lines(task, settings)) ==
        "training.steps: 512000 there, 1000 asked for");
  settings.gamma = 0.5;
  settings.clip = 0.5;
  settings.epochs = 7;
  CHECK_THAT(difference(lines(task), lines(task, settings, 2)),
             Catch::Contains("seed: 1 there, 2 asked for; ") && Catch::Contains(" more"));
}
