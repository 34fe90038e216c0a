#include "formats/foreign/minari.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "formats/io/files.h"
#include "formats/io/hdf5.h"
#include "formats/task/physics_profile.h"
#include "tests/unit/expect.h"

using namespace evo;
using namespace evo::test;
namespace fs = std::filesystem;

namespace {

Rollout reference(const std::string& name) {
  return read_rollout("tests/data/reference/" + name + ".h5");
}

}  // namespace

TEST_CASE("Minari: a dataset folder of all episodes") {
  const ScratchFolder folder;
  const Rollout walker = reference("Walker-v0_A");
  const std::string id = minari_dataset_id(walker);
  CHECK(id == "evo/Walker-v0/rollouts-v0");
  write_minari(folder / "dataset", {walker, walker}, id);
  CHECK(folder.entries() == 1);

  const fs::path data = folder / "dataset" / "data";
  const Json metadata = Json::parse(read_file(data / "metadata.json"));
  CHECK(metadata["total_episodes"] == 2);
  CHECK(metadata["total_steps"] == 200);
  CHECK(metadata["data_format"] == "hdf5");
  CHECK(metadata["dataset_id"] == id);
  const auto spec = Json::parse(metadata["env_spec"].get<std::string>());
  CHECK(spec["id"] == "evo/Walker-v0");
  CHECK(spec["kwargs"]["task"] == "Walker-v0");
  CHECK(spec["entry_point"] == "evo_robots.environment:Environment");
  CHECK(metadata["minari_version"] == "0.5.0");
  const auto actions = Json::parse(metadata["action_space"].get<std::string>());
  CHECK(actions["type"] == "Box");
  CHECK(actions["dtype"] == "float64");
  CHECK(actions["shape"] == Json::array({13}));
  CHECK(actions["low"].size() == 13);
  CHECK(actions["low"][0] == 0.6);
  CHECK(actions["high"][12] == 1.6);
  const std::string observations = metadata["observation_space"];
  CHECK(contains(observations, R"("shape": [66], "low": [-Infinity, -Infinity)"));

  const hdf5::Reader file(data / "main_data.hdf5");
  CHECK(file.children("/") == std::vector<std::string>{"episode_0", "episode_1"});
  CHECK(file.number<int>("/episode_1", "id") == 1);
  CHECK(file.number<int>("/episode_1", "total_steps") == 100);
  CHECK(contains(file.text("/episode_1", "robot"), walker.robot->id));
  CHECK(file.array<double>("/episode_1/observations").values == walker.episodes[0].observations);
  CHECK(file.array<double>("/episode_1/actions").values == walker.episodes[0].actions);
  CHECK(file.vector<double>("/episode_1/rewards") == walker.episodes[0].rewards);
  CHECK(file.vector<std::uint8_t>("/episode_1/truncations") == walker.episodes[0].truncations);
  CHECK(file.shape("/episode_1/infos/positions") == hdf5::Shape{101, 234, 2});
}

TEST_CASE("Minari: the bounds of actions are those of the physics, the widest of all rollouts") {
  const ScratchFolder folder;
  Rollout stronger = reference("Walker-v0_A");
  Physics physics;
  physics.max_target = 2.25;
  stronger.physics_yaml = physics_profiles().to_yaml(physics);
  Rollout shorter = stronger;
  physics.min_target = 0.5;
  physics.max_target = 1.5;
  shorter.physics_yaml = physics_profiles().to_yaml(physics);
  const auto bounds = [&](const char* name, const std::vector<Rollout>& rollouts) {
    write_minari(folder / name, rollouts, "a-v0");
    const Json metadata = Json::parse(read_file(folder / name / "data" / "metadata.json"));
    const Json space = Json::parse(metadata["action_space"].get<std::string>());
    return std::pair{space["low"][12].get<double>(), space["high"][0].get<double>()};
  };
  CHECK(bounds("stronger", {stronger}) == std::pair{0.6, 2.25});
  CHECK(bounds("both", {shorter, stronger}) == std::pair{0.5, 2.25});
}

TEST_CASE("Minari: what does not make a dataset leaves nothing behind") {
  const ScratchFolder folder;
  const Rollout walker = reference("Walker-v0_A");
  const auto refused = [&](Failure kind, const std::vector<Rollout>& rollouts,
                           const std::string& id) {
    return error_of(kind, [&] { write_minari(folder / "dataset", rollouts, id); });
  };
  CHECK(contains(refused(Failure::data,
                         {walker, reference("Walker-v0_B"), reference("Climber-v0_A"),
                          reference("Climber-v2_A")},
                         "a-v0"),
                 "of one length"));
  CHECK(contains(refused(Failure::data, {}, "a-v0"), "at least one"));
  Rollout without_actions = walker;
  without_actions.episodes[0].actions.clear();
  CHECK(contains(refused(Failure::data, {without_actions}, "a-v0"), "0 numbers of actions"));
  for (const char* id : {"", "name", "-v0", "a-v", "a-vx", "/a-v0", "a/-v0", "a b-v0", "a.b-v0"})
    CHECK(contains(refused(Failure::usage, {walker}, id), "dataset id"));
  CHECK(folder.entries() == 0);
  error_of(Failure::cannot_create,
           [&] { write_minari(folder.path() / "no" / "such", {walker}, "a-v0"); });
  write_minari(folder / "dataset", {walker}, "a-v0");
  CHECK(contains(refused(Failure::cannot_create, {walker}, "a-v0"), "exists already"));
}
