#include "formats/training/identity.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <map>

#include "formats/io/files.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/training/training.h"

using namespace evo;

namespace {

const DataFolders data{std::filesystem::path(EVO_SOURCE_DIR) / "tasks"};

const Body robot = Body::from_rows({"HV", "VS"});

std::string lines(const TaskSpec& task, const TrainingSettings& settings = {},
                  std::uint64_t seed = 1) {
  return identify(robot, task, settings, seed).lines;
}

TaskSpec with_physics(TaskSpec task, const std::string& assignment) {
  Physics physics = task.physics;
  apply_override(physics, assignment);
  set_physics(task, physics);
  return task;
}

}  // namespace

// These hashes are what policies and runs in people's folders are known by: with others,
// evo-train refuses to go on with them (status 73). When this fails, a task, a constant of the
// physics or a setting was added or changed; write the new hashes here.
TEST_CASE("identities are pinned") {
  const std::map<std::string, std::string> pinned{
      {"AreaMaximizer-v0", "cf1ef10f8fffe28bb11db666058a663bb530a805db706ec23a78957a71828a76"},
      {"Balancer-v1", "f5093af5c4899b79be82dc3f5a16b79f89d90835b4dcaa06e6a79a680a2f9f95"},
      {"BeamToppler-v0", "723750d8c8ae7e1632d06a622826e934a93af5ae9c6b4fa8849e0aba7e831d7a"},
      {"Carrier-v1", "8c29f078afb46eb5b5ac2494cd653d809e5e8196b979bda06a9145d7c5e66764"},
      {"Catcher-v0", "94520cd6112f9955837bc3a33ae4803dfeaef2beb33ff2ccfe484b3afea07814"},
      {"Climber-v2", "e63aa4e4977391281a5d4672e59ad5f932c26ba55746b7d4041ea51f09ba716c"},
      {"Flipper-v0", "bc40b7b6d8f200422e64bcdbb58266b2a0b9cd6dd7f4c9f635b3588d3b2e7990"},
      {"Traverser-v0", "d6857c7b39e6e6c975e0cf1c76dc2037adf18f12e3bd75b4ce8dc1e67c4807d8"},
      {"Walker-v0", "b6f8483ddc6bb3521eb3f9a4c0822ca0876abf4cbb4fdc195219ab810521a46f"},
      {"BidirectionalWalker-v0",
       "01ee95d339549ca20bb465da0232616dddcdfc9f4850f6bc49a37724f3ed9297"}};
  for (const auto& [task, hash] : pinned) {
    INFO(lines(load_task(task, data)));
    CHECK(identify(robot, load_task(task, data), {}, 1).hash() == hash);
  }
  TaskSpec task = with_physics(load_task("Walker-v0", data), "gravity=0.1");
  task = with_physics(task, "soft.edge=3e8/7");
  TrainingSettings settings;
  settings.steps = 65536;
  settings.lambda = 0.9;
  settings.time_limit = TimeLimit::bootstrap;
  CHECK(identify(robot, task, settings, 7).hash() ==
        "67cfdd1bef1d88ba93223c13adc7a0be731e96c6eea4c071513122a266cea675");
}

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
  for (const SettingRow& row : physics_table(task.physics))
    CHECK_THAT(all, Catch::Contains("\nphysics." + row.key + "="));
  for (const SettingRow& row : training_table(settings))
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
