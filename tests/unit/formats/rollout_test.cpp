#include "formats/rollout/rollout.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "formats/io/files.h"
#include "formats/io/hdf5.h"
#include "libevo/base/random.h"
#include "tests/unit/expect.h"

using namespace evo;
using namespace evo::test;
namespace fs = std::filesystem;

namespace {

std::vector<double> numbers(Stream& stream, int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(stream.gaussian());
  return values;
}

// Two objects of one cell each, two episodes of different lengths.
Rollout example() {
  Stream stream(1, "test/rollout");
  Rollout rollout;
  rollout.task = "Walker-v0";
  rollout.task_yaml = "name: Walker-v0\n# größer\n";
  rollout.physics_yaml = "dt: 0.001\n";
  rollout.robot = Robot(Body::from_rows({"H"}));
  rollout.robot->document["note"] = "stays";
  rollout.seed = 18446744073709551615U;
  rollout.created_by = "evo-eval 0.1.0";
  rollout.observation_length = 3;
  rollout.action_length = 1;
  rollout.points = 8;
  rollout.world.objects = {{"robot", 0, 4, 0, 1, false}, {"ground", 4, 4, 1, 1, true}};
  rollout.world.cells = {{0, Voxel::horizontal, {0, 1, 2, 3}}, {1, Voxel::fixed, {4, 5, 6, 7}}};
  for (const int steps : {5, 2}) {
    RolloutEpisode episode;
    episode.seed = stream.bits();
    episode.random_draws = {{"goals", {47, 32}}, {"ox", 3}};
    if (steps == 2) {  // the other one began at the official start
      episode.jitter = 1e-4;
      episode.jitter_seed = stream.bits();
    }
    episode.observations = numbers(stream, (steps + 1) * 3);
    episode.actions = numbers(stream, steps);
    episode.rewards = numbers(stream, steps);
    episode.truncations.assign(static_cast<std::size_t>(steps), 0);
    for (int t = 1; t <= steps; ++t) episode.terminations.push_back(t == steps ? 1 : 0);
    for (int i = 0; i < (steps + 1) * 8; ++i)
      episode.positions.push_back({stream.gaussian(), stream.gaussian()});
    rollout.episodes.push_back(episode);
  }
  return rollout;
}

fs::path reference(const std::string& name) {
  return fs::path(EVO_TEST_DATA) / "reference" / (name + ".h5");
}

template <typename Change>
std::string refused_after(const Change& change) {
  const ScratchFolder folder;
  hdf5::Writer file(folder / "r.h5");
  change(file);
  file.commit();
  return error_of(Failure::data, [&] { (void)read_rollout(folder / "r.h5"); });
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
  CHECK(contains(refused_after([](auto& f) { f.group("/x"); }), "no episodes"));
  CHECK(contains(refused_after([](auto& f) { f.attribute("/", "format", "evo/policy"); }),
                 "/@format: format 'evo/rollout' is expected, found 'evo/policy'"));
  CHECK(contains(refused_after([](auto& f) { f.attribute("/", "version", 2); }),
                 "evo/rollout version 2 is newer"));
  CHECK(contains(refused_after([](auto& f) { f.group("/episode_0"); }),
                 "/episode_0/rewards: is missing"));
  const std::vector<double> two{1, 2};
  CHECK(contains(refused_after([&](auto& f) {
                   f.vector("/episode_0/rewards", two);
                   f.array("/episode_0/actions", {3, 1}, std::vector<double>(3));
                 }),
                 "/episode_0/actions: has shape [3 x 1], expected [2 x any]"));
  CHECK(contains(refused_after([&](auto& f) {
                   f.vector("/episode_0/rewards", two);
                   f.array("/episode_0/actions", {2, 1}, two);
                   f.vector("/episode_1/rewards", two);
                   f.array("/episode_1/actions", {2, 2}, std::vector<double>(4));
                 }),
                 "/episode_1/actions: has shape [2 x 2], expected [2 x 1]"));
  CHECK(contains(refused_after([&](auto& f) {
                   f.vector("/episode_0/rewards", two);
                   f.attribute("/", "robot", R"({"body":["HX"]})");
                 }),
                 "/@robot:1:10: /body/0: unknown letter"));
  CHECK(contains(refused_after([&](auto& f) {
                   f.vector("/episode_0/rewards", two);
                   f.attribute("/episode_0", "random_draws", "[1]");
                 }),
                 "/episode_0@random_draws:1:1: a mapping"));

  const auto with_world = [&](const std::vector<int>& owners, const std::vector<int>& types,
                              const std::vector<int>& corners) {
    return refused_after([&](auto& f) {
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
  CHECK(contains(with_world({2}, {1}, {0, 1, 2, 3}), "/world/cell_object: cell 0 has 2, expected"));
  CHECK(contains(with_world({0}, {6}, {0, 1, 2, 3}), "/world/cell_type: cell 0 has 6, expected"));
  CHECK(contains(with_world({0}, {1}, {0, 1, 2, 4}), "/world/cell_points: cell 0 has 4, expected"));
  CHECK(contains(with_world({0}, {1}, {0, 1, 2, -1}), "/world/cell_points"));
  CHECK(contains(with_world({0}, {1, 1}, {0, 1, 2, 3}), "/world/cell_type: has shape [2]"));
  CHECK(contains(with_world({1, 0}, {1, 1}, {0, 1, 2, 3, 0, 1, 2, 3}), "not in order"));
  CHECK(contains(refused_after([&](auto& f) {
                   f.vector("/episode_0/rewards", std::vector<double>{});
                   f.strings("/world/object_names", {"robot"});
                   f.vector("/world/object_first_point", std::vector<int>{0});
                   f.vector("/world/object_points", std::vector<int>{4});
                 }),
                 "object 'robot' has points 0 to 3, but there are 0"));
}

TEST_CASE("Rollout: missing and foreign files") {
  const ScratchFolder folder;
  error_of(Failure::no_input, [&] { (void)read_rollout(folder / "none.h5"); });
  error_of(Failure::no_input, [&] { (void)read_actions(folder / "none.h5"); });
  write_file(folder / "x.h5", "text");
  error_of(Failure::data, [&] { (void)read_rollout(folder / "x.h5"); });
  error_of(Failure::data, [&] { (void)read_draws(folder / "x.h5"); });
  error_of(Failure::cannot_create,
           [&] { write_rollout(folder.path() / "no" / "r.h5", example()); });
}

TEST_CASE("Actions: from HDF5") {
  const ScratchFolder folder;
  const auto read = [&](const auto& fill) {
    hdf5::Writer file(folder / "a.h5");
    fill(file);
    file.commit();
    return read_actions(folder / "a.h5");
  };
  const ActionSequence actions = read([](auto& f) {
    f.array("/actions", {2, 3}, std::vector<float>{1, 2, 3, 4, 5, 6});
  });
  CHECK(actions.steps == 2);
  CHECK(actions.actuators == 3);
  CHECK(actions.values == std::vector<double>{1, 2, 3, 4, 5, 6});
  CHECK(contains(error_of(Failure::data, [&] { (void)read([](auto& f) { f.group("/x"); }); }),
                 "/actions: is missing"));
  CHECK(contains(
      error_of(Failure::data,
               [&] {
                 (void)read([](auto& f) {
                   for (const char* group : {"/episode_0", "/episode_1"})
                     f.array(std::string(group) + "/actions", {1, 1}, std::vector<double>{1});
                 });
               }),
      "2 episodes, actions are of one"));
  CHECK(contains(
      error_of(Failure::data,
               [&] { (void)read([](auto& f) { f.vector("/actions", std::vector<double>{1}); }); }),
      "expected [any x any]"));
  CHECK(contains(error_of(Failure::data,
                          [&] {
                            (void)read([](auto& f) {
                              f.array("/actions", {2, 1}, std::vector<double>{1, std::nan("")});
                            });
                          }),
                 "step 1 holds nan"));
}

TEST_CASE("Whatever reads a rollout looks at its version") {
  const ScratchFolder folder;
  const auto file = folder / "r.h5";
  const auto write = [&](const char* format, const auto& version) {
    hdf5::Writer out(file);
    if (format != nullptr) out.attribute("/", "format", std::string(format));
    version(out);
    out.attribute("/", "robot", R"({"body":["HV"]})");
    out.array("/actions", {1, 2}, std::vector<double>{1, 1});
    out.group("/episode_0");
    out.attribute("/episode_0", "random_draws", "{}");
    out.commit();
  };
  const auto refuses = [&](const std::string& why) {
    CHECK(contains(error_of(Failure::data, [&] { (void)read_actions(file); }), why));
    CHECK(contains(error_of(Failure::data, [&] { (void)read_draws(file); }), why));
    CHECK(contains(error_of(Failure::data, [&] { (void)read_robots(file.string()); }), why));
  };
  const auto version = [](auto number) {
    return [number](hdf5::Writer& out) { out.attribute("/", "version", number); };
  };
  const auto none = [](hdf5::Writer&) {};
  write("evo/rollout", version(2));
  refuses("version 2 is newer");
  write("evo/rollout", version(0));
  refuses("found '0'");
  write("evo/rollout", version(1.5));
  refuses("found '1.5'");
  write("evo/rollout", version(std::numeric_limits<double>::infinity()));
  refuses("found 'inf'");
  write("evo/rollout", none);
  refuses("version");
  for (const char* format : {"evo/rollout", static_cast<const char*>(nullptr)}) {
    if (format != nullptr)
      write(format, version(1));
    else
      write(format, none);  // as the benchmark writes them
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
