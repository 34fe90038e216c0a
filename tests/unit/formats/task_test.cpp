#include "formats/task/task.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "formats/io/files.h"
#include "formats/task/physics_profile.h"
#include "formats/task/text.h"
#include "libevo/task/env.h"
#include "tests/unit/expect.h"

using namespace evo;
using namespace evo::test;
namespace fs = std::filesystem;

namespace {

const fs::path task_folder = "tasks";
const DataFolders data{task_folder};

// A small task to spoil, line by line.
const std::string good = R"(name: test
steps: 100
robot: {at: [1, 1]}
world:
  objects:
    ground: {at: [0, 0], size: [30, 1], fill: "#"}
    package: {at: [12, 1], size: [3, 2], fill: S}
observation:
  - velocity: robot
reward:
  - displacement: {of: robot, axis: x}
rules:
  - when: {position: {of: robot, axis: x, above: 20}}
    reward: 1
)";

std::string message(const std::string& text) {
  return error_of(Failure::data, [&] { parse_task(text, "t.yaml", "", data); });
}

// The good task with one piece of text replaced.
std::string changed(const std::string& piece, const std::string& by) {
  const std::size_t at = good.find(piece);
  REQUIRE(at != std::string::npos);
  return good.substr(0, at) + by + good.substr(at + piece.size());
}

}  // namespace

// ---- a task that starts from another ------------------------------------------------

TEST_CASE("what a task does not say is as in its base") {
  const std::string easier = R"(name: level
base: PlatformJumper-v0
world:
  objects:
    platform_1: {at: [0, 5], size: [60, 1], fill: "#"}
)";
  const TaskSpec task = parse_task(easier, "t.yaml", "", data);
  const TaskSpec base = load_task("PlatformJumper-v0", data);
  CHECK(task.name == "level");
  CHECK(task.aliases.empty());
  CHECK(task.episode_steps == base.episode_steps);
  CHECK(task.robot_y == base.robot_y);
  CHECK(task.observation.size() == base.observation.size());
  CHECK(task.rules.size() == base.rules.size());
  CHECK(task.description == base.description);
  REQUIRE(task.objects.size() == 1);
  CHECK(task.objects[0].object.body.cols == 60);

  // The source is whole: it is read without any other file.
  const TaskSpec again = parse_task(task.source, "s.yaml");
  CHECK(again.source == task.source);
  CHECK(again.rules.size() == base.rules.size());

  CHECK(parse_task(easier + "steps: 7\n", "t.yaml", "", data).episode_steps == 7);
  CHECK(parse_task(easier + "physics: paper\n", "t.yaml", "", data).physics ==
        physics_profiles().load("paper", data));
}

TEST_CASE("every easier world observes what its task does") {
  int worlds = 0;
  for (const auto& entry : fs::directory_iterator(task_folder / "easier")) {
    const std::string name = entry.path().stem().string();
    INFO(name);
    const TaskSpec easier = load_task(name, data);
    CHECK(easier.name == name);
    const TaskSpec task = load_task(name.substr(0, name.rfind('-')), data);
    CHECK(easier.robot_x == task.robot_x);
    CHECK(easier.robot_y == task.robot_y);
    const Body body = full_body(5, 5);
    CHECK(Arena(easier, body).observation_length() == Arena(task, body).observation_length());
    ++worlds;
  }
  CHECK(worlds > 0);
}

TEST_CASE("a base is a task by name or by file, and no circle") {
  CHECK(message("name: x\nbase: PlatformJumpr-v0\n") ==
        "t.yaml:2:7: unknown task 'PlatformJumpr-v0' (did you mean 'PlatformJumper-v0'?); "
        "`evo-inspect tasks` lists them, a task of your own is given as a file (NAME.yaml)");
  CHECK_THAT(message("name: x\nbase: nowhere.yaml\n"), Catch::StartsWith("t.yaml:2:7: "));
  CHECK_THAT(message("base: Walker-v0\n"), Catch::Contains("key 'name' is missing"));
  // What the base says of an object that the new world has not.
  CHECK_THAT(message("name: x\nbase: Carrier-v0\nworld: {objects: {ground: {at: [0, 0], size: [9, "
                     "1], fill: \"#\"}}}\n"),
             Catch::StartsWith("Carrier-v0:") && Catch::Contains("package"));

  const ScratchFolder folder;
  std::ofstream(folder / "a.yaml") << "name: a\nbase: Walker-v0\nsteps: 3\n";
  std::ofstream(folder / "b.yaml") << "name: b\nbase: a.yaml\n";
  std::ofstream(folder / "round.yaml") << "name: round\nbase: round.yaml\n";
  CHECK(load_task((folder / "b.yaml").string(), data).episode_steps == 3);
  CHECK_THROWS_WITH(load_task((folder / "round.yaml").string(), data),
                    Catch::Contains("start from one another in a circle"));
}

// ---- the 32 tasks ------------------------------------------------------------------

TEST_CASE("written tasks are read back, with nothing else at hand") {
  const std::vector<std::string> names = task_names(data);
  CHECK(names.size() == 32);
  for (const std::string& name : names) {
    INFO(name);
    const TaskSpec task = load_task(name, data);
    const std::string text = task_to_yaml(task);
    const TaskSpec again = parse_task(text, "written");
    CHECK(task_to_yaml(again) == text);
    CHECK(again.source == text);
    CHECK(task_to_yaml(parse_task(task.source, "source")) == text);
  }
}

// ---- finding tasks ------------------------------------------------------------------------

TEST_CASE("an unknown task is named with the nearest one") {
  CHECK_THAT(error_of(Failure::usage, [] { load_task("Walkr-v0", data); }),
             Catch::StartsWith("unknown task 'Walkr-v0' (did you mean 'Walker-v0'?)") &&
                 Catch::Contains("evo-inspect tasks"));
  for (const char* word : {"walker", "Walker", "WALKER-V0", "wlaker", "walke"})
    CHECK_THROWS_WITH(load_task(word, data), Catch::Contains("(did you mean 'Walker-v0'?)"));
  CHECK_THROWS_WITH(load_task("bridge", data), Catch::Contains("'BridgeWalker-v0'"));
  CHECK_THROWS_WITH(load_task("zebra", data), !Catch::Contains("did you mean"));
  CHECK_THROWS_WITH(load_task("Walker-v0.yaml", data), Catch::Contains("given as 'Walker-v0'"));
  CHECK_THROWS_WITH(load_task("README.md", data), Catch::Contains("'./README.md'"));
  error_of(Failure::no_input, [] { load_task("./nowhere.yaml", data); });
}

TEST_CASE("other YAML in a data folder is no task") {
  const ScratchFolder folder;
  std::ofstream(folder / "neat.yaml") << "population: 5\n";
  std::ofstream(folder / "mine.yaml") << "format: evo/task\naliases: [ours]\n" << good;
  CHECK(task_names({folder.path()}) == std::vector<std::string>{"mine"});
  CHECK_THROWS_WITH(load_task("neat", {folder.path()}), Catch::Contains("unknown task 'neat'"));
  CHECK(load_task("ours", {folder.path()}).name == "test");
  CHECK(load_task("Walker-v0", {folder.path(), task_folder}).name == "Walker-v0");
}

// ---- worlds ---------------------------------------------------------------------------------

TEST_CASE("a task that is there but cannot be read is not called unknown") {
  const ScratchFolder folder;
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder / name) << text;
  };
  write("broken.yaml", "format: evo/task\nname: [broken\n");
  write("walk.yaml",
        "format: evo/task\nname: walk\naliases: [stroll]\n" + good.substr(good.find("steps:")));
  CHECK_THROWS_WITH(load_task("broken", {folder.path()}),
                    Catch::StartsWith((folder / "broken.yaml").string() + ":"));
  CHECK_THROWS_WITH(task_names({folder.path()}),
                    Catch::StartsWith((folder / "broken.yaml").string() + ":"));
  // Other tasks are found all the same; what is not found may be in it.
  CHECK(load_task("walk", {folder.path()}).name == "walk");
  CHECK(load_task("stroll", {folder.path()}).name == "walk");
  CHECK_THROWS_WITH(load_task("run", {folder.path()}),
                    Catch::StartsWith("unknown task 'run'") && Catch::Contains("broken.yaml:3"));
}

TEST_CASE("a picture with a legend, parts and rows draw the same world") {
  const auto objects = [](const std::string& world) {
    const std::string text =
        "name: w\nsteps: 1\nrobot: {at: [0, 9]}\nobservation: [velocity: robot]\n"
        "reward: []\nworld:\n" +
        world;
    return parse_task(text, "w.yaml").objects;
  };
  const auto picture = objects(R"(
  drawing: |
    ..bb.
    #...#
    ##S##
  legend:
    "#": ground
    S: ground
    b: {object: beam, voxel: R}
)");
  const auto rows = objects(R"(
  objects:
    ground: {rows: ["#...#", "##S##"]}
    beam: {at: [2, 2], size: [2, 1], fill: R}
)");
  const auto parts = objects(R"(
  objects:
    ground:
      parts:
        - {size: [5, 2], fill: "#"}
        - {at: [1, 1], size: [3, 1], fill: "."}
        - {at: [2, 0], rows: [S]}
    beam: {at: [1, 1], rows: ["...", ".RR", "..."]}
)");
  for (const auto* other : {&rows, &parts}) {
    REQUIRE(other->size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(picture[i].object.name == (*other)[i].object.name);
      CHECK(picture[i].object.body == (*other)[i].object.body);
      CHECK(picture[i].object.x == (*other)[i].object.x);
      CHECK(picture[i].object.y == (*other)[i].object.y);
    }
  }
}

TEST_CASE("connections are kept when a drawing is cut to its cells") {
  const std::string text =
      "name: w\nsteps: 1\nrobot: {at: [0, 9]}\nobservation: [velocity: robot]\nreward: []\n"
      "world: {objects: {u: {at: [3, 1], rows: ['....', '.SS.', '.SS.'], "
      "connections: [[5, 6], [5, 9], [6, 10]]}}}\n";
  const TaskSpec task = parse_task(text, "w.yaml");
  const Object& u = task.objects.at(0).object;
  CHECK(u.x == 4);
  CHECK(u.y == 1);
  CHECK(u.body.links == std::vector<Link>{{0, 1}, {0, 2}, {1, 3}});
  CHECK(parse_task(task_to_yaml(task), "again").objects.at(0).object.body == u.body);
}

TEST_CASE("bounding boxes may overlap, cells may not") {
  const std::string nested = R"(  objects:
    tub: {rows: ["#...#", "#####"]}
    duck: {at: [2, 1], size: [1, 1], fill: S}
)";
  const std::size_t objects = good.find("  objects");
  CHECK_NOTHROW(parse_task(
      changed(good.substr(objects, good.find("observation") - objects), nested), "t.yaml"));
}

TEST_CASE("a world may come from the design tool, and the task stays complete") {
  const ScratchFolder folder;
  std::ofstream(folder / "world.json") << R"({"grid_width": 5, "grid_height": 3, "objects": {
    "ground": {"indices": [0, 1, 2, 3, 4], "types": [5, 5, 5, 5, 5],
               "neighbors": {"0": [1], "1": [0, 2], "2": [1, 3], "3": [2, 4], "4": [3]}},
    "box": {"indices": [8, 13], "types": [1, 2], "neighbors": {"8": [13], "13": [8]}}}})";
  const std::string head =
      "name: w\nsteps: 1\nrobot: {at: [0, 1]}\nobservation: [velocity: box]\nreward: []\n";
  const TaskSpec task = parse_task(head + "world: world.json\n", "w.yaml", folder.path());
  REQUIRE(task.objects.size() == 2);
  CHECK(task.objects[1].object.name == "box");
  CHECK(task.objects[1].object.x == 3);
  CHECK(task.objects[1].object.y == 1);
  CHECK(task.objects[1].object.body.to_rows() == std::vector<std::string>{"S", "R"});

  const TaskSpec more = parse_task(
      head + "world: {file: world.json, objects: {peg: {at: [0, 2], size: [1, 1], fill: '#'}}}\n",
      "w.yaml", folder.path());
  CHECK(more.objects.size() == 3);
  fs::remove(folder / "world.json");
  CHECK(parse_task(task.source, "alone").objects[1].object.body == task.objects[1].object.body);
  CHECK(parse_task(more.source, "alone").objects.size() == 3);
  CHECK_THAT(message(head + "world: nowhere.json\n"), Catch::StartsWith("t.yaml:6:8: "));
}

// ---- physics in tasks -------------------------------------------------------------------------

TEST_CASE("a task may choose and change its physics, and stays complete") {
  const TaskSpec paper = parse_task(good + "physics: paper\n", "t.yaml", "", data);
  CHECK(paper.physics == physics_profiles().load("paper", data));
  CHECK(parse_task(paper.source, "alone").physics == paper.physics);

  const TaskSpec light =
      parse_task(good + "physics:\n  base: paper\n  gravity: 40\n", "t.yaml", "", data);
  CHECK(light.physics.gravity == 40.0);
  CHECK(light.physics.contact_stiffness == 2.1e7);
  CHECK(parse_task(light.source, "alone").physics == light.physics);

  TaskSpec changed = parse_task(good, "t.yaml", "", data);
  CHECK(changed.source == good);
  change_physics(changed, {"gravity=55", "min_target=1.7", "max_target=1.8"}, data);
  CHECK(parse_task(changed.source, "alone").physics.gravity == 55.0);
  CHECK_THROWS_WITH(change_physics(changed, {"max_target=1"}, data), Catch::Contains("max_target"));

  CHECK_THAT(
      message(good + "physics: papr\n"),
      Catch::StartsWith("t.yaml:15:10: unknown physics profile 'papr' (did you mean 'paper'?)"));
}

// ---- mistakes -----------------------------------------------------------------------------------

TEST_CASE("mistakes in a task and its world are named with their place and the nearest word") {
  struct Mistake {
    const char* piece;
    const char* by;
    const char* message;
  };
  const std::vector<Mistake> mistakes{
      {"velocity", "velocty",
       "t.yaml:9:5: unknown observation part 'velocty' (did you mean 'velocity'?); allowed: "
       "velocity, orientation, "},
      {"displacement: {of: robot", "displacement: {of: pakage",
       "t.yaml:11:24: unknown object 'pakage' (did you mean 'package'?); allowed: robot, ground, "
       "package"},
      {"displacement", "displace",
       "t.yaml:11:5: reward term: unknown key 'displace' (did you mean 'displacement'?); allowed: "
       "displacement, distance, "},
      {"axis: x}\n", "axis: z}\n",
       "t.yaml:11:37: unknown axis 'z' (did you mean 'x'?); allowed: x, y"},
      {"steps: 100", "stesp: 100", "t.yaml:2:1: task: unknown key 'stesp' (did you mean 'steps'?)"},
      {"steps: 100\n", "", "t.yaml:1:1: task: key 'steps' is missing"},
      {"steps: 100", "steps: 0",
       "t.yaml:2:8: a whole number from 1 to 10000000 is expected, found '0'"},
      {"steps: 100", "steps: 100\nsteps: 200",
       "t.yaml:3:1: key 'steps' is given twice (first in line 2)"},
      {"above: 20", "abve: 20",
       "t.yaml:13:43: position: unknown key 'abve' (did you mean 'above'?); allowed: of, axis, "
       "above, below, at_least, at_most"},
      {", above: 20", "", "t.yaml:13:22: a bound is expected"},
      {"position:", "postion:", "unknown condition 'postion' (did you mean 'position'?)"},
      {"reward: 1", "reward: lots", "t.yaml:14:13: a number is expected, found 'lots'"},
      {"name: test", "name: my test", "a name without spaces"},
      {"- velocity: robot", "- goal_index", "goal_index needs the task to have `goals`"},
      {"- velocity: robot", "- velocity", "'velocity' needs a value"},
      {"displacement: {of: robot, axis: x}", "effort: robot", "'effort' takes no value"},
      {"- velocity: robot", "- floor: {width: -1}",
       "a whole number from 0 to 1000 is expected, found '-1'"},
      {"robot: {at: [1, 1]}", "robot: {at: [-1, 1]}", "t.yaml:3:14: a whole number from 0"},
      {"name: test", "format: evo/robot\nname: test",
       "format 'evo/task' is expected, found 'evo/robot'"},
      {"name: test", "version: 9\nname: test", "newer than this"},
      {"size: [30, 1]", "size: [-30, 1]", "t.yaml:6:33: a whole number from 1 to "},
      {"fill: S", "fill: X", "t.yaml:7:48: unknown letter 'X'"},
      {"fill: S", "fill: H",
       "object 'package' has actuators (H, V), which only the robot may have"},
      {"fill: S", "fill: '.'", "object 'package' has no cell"},
      {"size: [3, 2], fill: S", "rows: [SS, S]", "row 2 of the drawing has 1 cells, row 1 has 2"},
      {"size: [3, 2], fill: S", "rows: [S.S]", "object 'package': "},
      {"size: [3, 2], fill: S", "rows: [SS], fill: S", "`fill` goes with `size`"},
      {"size: [3, 2], fill: S", "{}", "t.yaml:7:"},
      {"size: [3, 2], fill: S", "rows: [SS], connections: [[0, 5]]", "a whole number from 0 to 1"},
      {"{at: [12, 1], size", "{at: [12, 0], size",
       "t.yaml:5:3: objects 'ground' and 'package' overlap at cell (12, 0)"},
      {"package:", "robot:", "the name 'robot' belongs to the robot"},
      {"{at: [12, 1], size: [3, 2]", "{at: [12, 1], offset: [ox, 0], size: [3, 2]",
       "unknown draw 'ox'"},
      {"  objects:", "  drawing: 'x'\n  objects:", "world: key 'legend' is missing"},
      {"  objects:", "  drawing: 'xy'\n  legend: {x: {object: a, voxel: S}}\n  objects:",
       "letter 'y' in row 1, column 2 is not in the legend"}};
  CHECK_NOTHROW(parse_task(good, "t.yaml"));
  for (const auto& [piece, by, expected] : mistakes)
    CHECK_THAT(message(changed(piece, by)), Catch::Contains(expected));
  CHECK_NOTHROW(parse_task(
      changed("robot: {at: [1, 1]}", "draws: {d: [-20, 0]}\nrobot: {at: [1, 1]}"), "t.yaml"));
}

// ---- examples ------------------------------------------------------------

TEST_CASE("the examples of the guide load and run") {
  for (const char* name : {"ramp", "kick"}) {
    INFO(name);
    const TaskSpec task =
        load_task((task_folder / "examples" / (std::string(name) + ".yaml")).string(), data);
    const Arena arena(task, Body::from_rows({"SSS", "HSH", "V.V"}));
    VecEnv env(arena, 2);
    for (int i = 0; i < 2; ++i)
      env.reset(i, {arena.draw(0, static_cast<std::uint64_t>(i)), 0.0, 0});
    const auto before = env.positions(0)[0];
    double reward = 0.0;
    for (int step = 0; step < 40; ++step) {
      std::vector<double> targets(static_cast<std::size_t>(2 * arena.action_length()));
      for (std::size_t i = 0; i < targets.size(); ++i)
        targets[i] = 1.1 + 0.5 * std::sin(step / 3.0 + static_cast<double>(i));
      env.step(targets);
      reward += std::abs(env.rewards()[0]);
    }
    CHECK(reward > 0.0);
    CHECK(env.positions(0)[0].x != before.x);
    CHECK_FALSE(describe_task(task, Body::from_rows({"HH"})).empty());
    CHECK(parse_task(task.source, "alone").physics == task.physics);
  }
}

TEST_CASE("the page on tasks shows its example as it is") {
  CHECK_THAT(read_file("docs/make-a-task.md"),
             Catch::Contains(read_file(task_folder / "examples/ramp.yaml")));
}
