#include "formats/rollout/rollout.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "formats/io/files.h"
#include "formats/io/hdf5.h"
#include "tests/unit/expect.h"

using namespace evo;
using namespace evo::test;
namespace fs = std::filesystem;

namespace {

// Two objects of one cell each, two episodes of different lengths.
Rollout example() {
  Rollout rollout;
  rollout.task = "Walker-v0";
  rollout.observation_length = 3;
  rollout.action_length = 1;
  rollout.points = 8;
  rollout.world.objects = {{"robot", 0, 4, 0, 1, false}, {"ground", 4, 4, 1, 1, true}};
  rollout.world.cells = {{0, Voxel::horizontal, {0, 1, 2, 3}}, {1, Voxel::fixed, {4, 5, 6, 7}}};
  for (const std::size_t steps : {5, 2}) {
    RolloutEpisode episode;
    episode.random_draws = {{"goals", {47, 32}}, {"ox", 3}};
    episode.observations.resize((steps + 1) * 3);
    episode.actions.resize(steps);
    episode.rewards.resize(steps);
    episode.terminations.resize(steps);
    episode.truncations.resize(steps);
    episode.positions.resize((steps + 1) * 8);
    rollout.episodes.push_back(episode);
  }
  return rollout;
}

fs::path reference(const std::string& name) { return "tests/data/reference/" + name + ".h5"; }

// A file that is made so is refused with these words.
void refuses(const std::string& words, const std::function<void(hdf5::Writer&)>& make,
             const std::function<void(const fs::path&)>& read = read_rollout) {
  const ScratchFolder folder;
  hdf5::Writer file(folder / "r.h5");
  make(file);
  file.commit();
  expect_error(Failure::data, Catch::Contains(words), [&] { read(folder / "r.h5"); });
}

}  // namespace

TEST_CASE("Rollout: the layout is the one of the specification") {
  const ScratchFolder folder;
  write_rollout(folder / "r.h5", example());
  const hdf5::Reader file(folder / "r.h5");
  CHECK(file.text("/", "format") == "evo/rollout");
  CHECK(file.number<int>("/", "version") == 1);
  CHECK(file.number<int>("/", "total_episodes") == 2);
  CHECK(file.number<int>("/", "total_steps") == 7);
  CHECK(file.number<int>("/episode_1", "id") == 1);
  CHECK(file.number<int>("/episode_1", "total_steps") == 2);
  CHECK(Json::parse(file.text("/episode_1", "random_draws"))["ox"] == 3);
  CHECK(file.shape("/episode_0/observations") == hdf5::Shape{6, 3});
  CHECK(file.shape("/episode_0/actions") == hdf5::Shape{5, 1});
  CHECK(file.shape("/episode_0/rewards") == hdf5::Shape{5});
  CHECK(file.shape("/episode_0/terminations") == hdf5::Shape{5});
  CHECK(file.shape("/episode_0/truncations") == hdf5::Shape{5});
  CHECK(file.shape("/episode_0/infos/positions") == hdf5::Shape{6, 8, 2});
  CHECK(file.strings("/world/object_names") == std::vector<std::string>{"robot", "ground"});
  CHECK(file.shape("/world/cell_points") == hdf5::Shape{2, 4});
}

TEST_CASE("Rollout: files of other makers are read") {
  // Written by h5py: no cells, no seeds, draws at the root.
  const Rollout catcher = read_rollout(reference("Catcher-v0_A"));
  CHECK(catcher.task == "Catcher-v0");
  REQUIRE(catcher.robot);
  CHECK(catcher.robot->body.to_rows()[0] == "RHHHR");
  REQUIRE(catcher.episodes.size() == 1);
  CHECK(catcher.episodes[0].random_draws.contains("oy"));
  CHECK(read_draws(reference("Catcher-v0_A")) == catcher.episodes[0].random_draws);
  CHECK(catcher.world.objects.size() == 5);
  CHECK(catcher.world.objects[0].name == "robot");
  CHECK(catcher.world.cells.empty());
  CHECK(catcher.episodes[0].positions.size() ==
        static_cast<std::size_t>((catcher.episodes[0].steps() + 1) * catcher.points));

  const ActionSequence actions = read_actions(reference("Catcher-v0_A"));
  CHECK(actions.steps == catcher.episodes[0].steps());
  CHECK(actions.actuators == 13);
  CHECK(actions.values == catcher.episodes[0].actions);
}

TEST_CASE("Rollout: a minimal episode is enough") {
  const ScratchFolder folder;
  {
    hdf5::Writer file(folder / "r.h5");
    file.vector("/episode_0/rewards", std::vector<double>{1, 2});
    file.vector("/episode_10/rewards", std::vector<float>{3});
    file.vector("/episode_2/rewards", std::vector<double>{});
    file.group("/episode_x");
    file.commit();
  }
  const Rollout rollout = read_rollout(folder / "r.h5");
  REQUIRE(rollout.episodes.size() == 3);
  CHECK(rollout.episodes[0].rewards == std::vector<double>{1, 2});
  CHECK(rollout.episodes[0].terminations == std::vector<std::uint8_t>{0, 0});
  CHECK(rollout.episodes[1].steps() == 0);
  CHECK(rollout.episodes[2].rewards == std::vector<double>{3});  // by number, not by name
  CHECK(rollout.points == 0);
  CHECK_FALSE(rollout.robot);
}

TEST_CASE("Rollout: what makes no sense is refused with file and dataset") {
  refuses("no episodes", [](auto& f) { f.group("/x"); });
  refuses("/@format: format 'evo/rollout' is expected, found 'evo/policy'",
          [](auto& f) { f.attribute("/", "format", "evo/policy"); });
  refuses("evo/rollout version 2 is newer", [](auto& f) { f.attribute("/", "version", 2); });
  refuses("/episode_0/rewards: is missing", [](auto& f) { f.group("/episode_0"); });
  const std::vector<double> two{1, 2};
  refuses("/episode_0/actions: has shape [3 x 1], expected [2 x any]", [&](auto& f) {
    f.vector("/episode_0/rewards", two);
    f.array("/episode_0/actions", {3, 1}, std::vector<double>(3));
  });
  refuses("/episode_1/actions: has shape [2 x 2], expected [2 x 1]", [&](auto& f) {
    f.vector("/episode_0/rewards", two);
    f.array("/episode_0/actions", {2, 1}, two);
    f.vector("/episode_1/rewards", two);
    f.array("/episode_1/actions", {2, 2}, std::vector<double>(4));
  });
  refuses("/@robot:1:10: /body/0: unknown letter", [&](auto& f) {
    f.vector("/episode_0/rewards", two);
    f.attribute("/", "robot", R"({"body":["HX"]})");
  });
  refuses("/episode_0@random_draws:1:1: a mapping", [&](auto& f) {
    f.vector("/episode_0/rewards", two);
    f.attribute("/episode_0", "random_draws", "[1]");
  });

  const auto refuses_world = [&](const char* words, const std::vector<int>& owners,
                                 const std::vector<int>& types, const std::vector<int>& corners) {
    refuses(words, [&](auto& f) {
      f.vector("/episode_0/rewards", std::vector<double>{});
      f.array("/episode_0/infos/positions", {1, 4, 2}, std::vector<double>(8));
      f.strings("/world/object_names", {"robot", "ground"});
      f.vector("/world/object_first_point", std::vector<int>{0, 0});
      f.vector("/world/object_points", std::vector<int>{4, 4});
      f.vector("/world/cell_object", owners);
      f.vector("/world/cell_type", types);
      f.array("/world/cell_points", {corners.size() / 4, 4}, corners);
    });
  };
  refuses_world("/world/cell_object: cell 0 has 2, expected", {2}, {1}, {0, 1, 2, 3});
  refuses_world("/world/cell_type: cell 0 has 6, expected", {0}, {6}, {0, 1, 2, 3});
  refuses_world("/world/cell_points: cell 0 has 4, expected", {0}, {1}, {0, 1, 2, 4});
  refuses_world("/world/cell_points", {0}, {1}, {0, 1, 2, -1});
  refuses_world("/world/cell_type: has shape [2]", {0}, {1, 1}, {0, 1, 2, 3});
  refuses_world("not in order", {1, 0}, {1, 1}, {0, 1, 2, 3, 0, 1, 2, 3});
  refuses("object 'robot' has points 0 to 3, but there are 0", [&](auto& f) {
    f.vector("/episode_0/rewards", std::vector<double>{});
    f.strings("/world/object_names", {"robot"});
    f.vector("/world/object_first_point", std::vector<int>{0});
    f.vector("/world/object_points", std::vector<int>{4});
  });
}

TEST_CASE("Actions: from HDF5") {
  const ScratchFolder folder;
  {
    hdf5::Writer file(folder / "a.h5");
    file.array("/actions", {2, 3}, std::vector<float>{1, 2, 3, 4, 5, 6});
    file.commit();
  }
  const ActionSequence actions = read_actions(folder / "a.h5");
  CHECK(actions.steps == 2);
  CHECK(actions.actuators == 3);
  CHECK(actions.values == std::vector<double>{1, 2, 3, 4, 5, 6});
  const auto refuses_actions = [](const char* words, const auto& make) {
    refuses(words, make, read_actions);
  };
  refuses_actions("/actions: is missing", [](auto& f) { f.group("/x"); });
  refuses_actions("2 episodes, actions are of one", [](auto& f) {
    for (const char* actions : {"/episode_0/actions", "/episode_1/actions"})
      f.array(actions, {1, 1}, std::vector<double>{1});
  });
  refuses_actions("expected [any x any]",
                  [](auto& f) { f.vector("/actions", std::vector<double>{1}); });
  refuses_actions("step 1 holds nan", [](auto& f) {
    f.array("/actions", {2, 1}, std::vector<double>{1, std::nan("")});
  });
}

TEST_CASE("Whatever reads a rollout looks at its version") {
  const ScratchFolder folder;
  const auto file = folder / "r.h5";
  const auto write = [&](const char* format, std::optional<double> version) {
    hdf5::Writer out(file);
    if (format != nullptr) out.attribute("/", "format", std::string(format));
    if (version) out.attribute("/", "version", *version);
    out.attribute("/", "robot", R"({"body":["HV"]})");
    out.array("/actions", {1, 2}, std::vector<double>{1, 1});
    out.group("/episode_0");
    out.attribute("/episode_0", "random_draws", "{}");
    out.commit();
  };
  const std::vector<std::pair<std::optional<double>, const char*>> wrong{
      {2, "version 2 is newer"},
      {0, "found '0'"},
      {1.5, "found '1.5'"},
      {std::numeric_limits<double>::infinity(), "found 'inf'"},
      {std::nullopt, "version"}};
  for (const auto& [version, why] : wrong) {
    write("evo/rollout", version);
    CHECK(contains(error_of(Failure::data, [&] { (void)read_actions(file); }), why));
    CHECK(contains(error_of(Failure::data, [&] { (void)read_draws(file); }), why));
    CHECK(contains(error_of(Failure::data, [&] { (void)read_robots(file.string()); }), why));
  }
  for (const bool ours : {true, false}) {
    if (ours)
      write("evo/rollout", 1);
    else
      write(nullptr, std::nullopt);  // as the benchmark writes them
    CHECK(read_actions(file).steps == 1);
    CHECK(read_draws(file).is_object());
    CHECK(read_robots(file.string()).size() == 1);
  }
}

TEST_CASE("Actions: from CSV") {
  const ScratchFolder folder;
  const auto read = [&](const std::string& text) {
    write_file(folder / "a.csv", text);
    return read_actions(folder / "a.csv");
  };
  for (const std::string text :
       {"0.6,1.6\n1.1,+1\n1e0,.7\n", "# numpy\n0.6, 1.6\r\n\r\n1.1,1\n1,0.7",
        "\xEF\xBB\xBF\"left\",right\n0.6,1.6\n1.1,1\n1,0.7\n",
        "\xEF\xBB\xBF"
        "0.6 1.6\n1.1 1\n1 0.7\n"}) {
    const ActionSequence actions = read(text);
    CHECK(actions.steps == 3);
    CHECK(actions.actuators == 2);
    CHECK(actions.values == std::vector<double>{0.6, 1.6, 1.1, 1, 1, 0.7});
  }
  const auto refused = [&](const std::string& text) {
    return error_of(Failure::data, [&] { (void)read(text); });
  };
  CHECK(contains(refused("1,2\n1,x\n"), "line 2: value 2 is \"x\", expected a number"));
  CHECK(contains(refused("1,2\n1\n"), "line 2: 1 values, but the row before has 2"));
  CHECK(contains(refused("1,\n"), "line 1: value 2"));
  CHECK(contains(refused("1,nan\n"), "expected a number"));
  CHECK(contains(refused("o.6,1.6\n1,1\n"), "line 1: value 1 is"));
  CHECK(contains(refused("1,6;1.1\n1;1\n"), "line 1: value 2 is"));
  CHECK(contains(refused(""), "no actions"));
  CHECK(contains(refused("a,b\n"), "no actions"));
  CHECK(contains(refused("a,b\nc,d\n"), "line 2"));
}
