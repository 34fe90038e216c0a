#include "formats/robot/evogym.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "formats/io/files.h"
#include "formats/io/npz.h"
#include "formats/task/text.h"
#include "libevo/base/random.h"
#include "libevo/body/operators.h"
#include "tests/unit/expect.h"
#include "tests/unit/formats/damage.h"

using namespace evo;
using namespace evo::test;
namespace fs = std::filesystem;

namespace {

// A 5x3 grid: a ground of three fixed cells at the bottom, a block of two soft
// cells on it, listed top row first as the design tool does.
const char* const example = R"({
  "grid_width": 5, "grid_height": 3,
  "objects": {
    "ground": {"indices": [1, 2, 3], "types": [5, 5, 5],
               "neighbors": {"1": [2], "2": [1, 3], "3": [2]}},
    "block":  {"indices": [12, 7], "types": [2, 1],
               "neighbors": {"12": [7], "7": [12]}}
  },
  "made_by": "a field that is not known"
})";

World world_of(const Json& document, const WorldWarning& warn = {}) {
  return read_evogym_world(to_node(document, "w.json"), warn);
}

Json parsed(const World& world) { return Json::parse(evogym_world_to_json(world)); }

void refuses(const std::string& words, const Json& document) {
  expect_error(Failure::data, Catch::Contains(words), [&] { (void)world_of(document); });
}

bool same(const World& a, const World& b) {
  return std::equal(a.objects.begin(), a.objects.end(), b.objects.begin(), b.objects.end(),
                    [](const Object& p, const Object& q) {
                      return p.name == q.name && p.x == q.x && p.y == q.y && p.body == q.body;
                    });
}

}  // namespace

TEST_CASE("EvoGym world: objects with their boxes and links") {
  CHECK(same(world_of(Json::parse(example)), {{{"ground", Body::from_rows({"###"}), 1, 0},
                                               {"block", Body::from_rows({"S", "R"}), 2, 1}}}));
}

TEST_CASE("EvoGym world: the grid's own size is not kept, the rest comes back") {
  const World world = world_of(Json::parse(example));
  const Json written = parsed(world);
  CHECK(written["grid_width"] == 4);
  CHECK(written["grid_height"] == 3);
  CHECK(same(world_of(written), world));
  const ScratchFolder folder;
  write_file(folder / "w.json", evogym_world_to_json(world));
  CHECK(same(read_evogym_world(folder / "w.json"), world));
}

TEST_CASE("EvoGym world: round trip of random worlds") {
  for (std::uint64_t i = 0; i < 100; ++i) {
    Stream stream(1, "test/worlds", i);
    World world;
    int x = 0;
    for (int k = stream.integer(1, 4); k > 0; --k) {
      Body body = sample_body(stream.integer(1, 5), stream.integer(1, 5), default_weights, stream);
      const int cols = body.cols;
      world.objects.push_back(
          {"object/" + std::to_string(k), std::move(body), x, stream.integer(0, 3)});
      x += cols;
    }
    REQUIRE(same(world_of(parsed(world)), world));
  }
}

TEST_CASE("EvoGym world: single cells, enclosed objects, links from one end") {
  // A block inside the box of a frame, listed before it.
  const World world = world_of(Json::parse(R"({"grid_width":3,"grid_height":2,"objects":{
      "inside":{"indices":[1],"types":[1],"neighbors":{"1":[]}},
      "frame":{"indices":[0,3,4,5,2],"types":[5,5,5,5,5],
               "neighbors":{"0":[3],"3":[4],"4":[5],"5":[2],"2":[]}}}})"));
  CHECK(same(world, {{{"inside", Body::from_rows({"R"}), 1, 0},
                      {"frame", Body::from_rows({"###", "#.#"}), 0, 0}}}));
  CHECK(same(world_of(parsed(world)), world));
}

TEST_CASE("EvoGym world: what the benchmark passes over is told and passed over") {
  const auto told_of = [](const Json& document) {
    std::vector<std::string> warnings;
    CHECK(same(world_of(document, [&](const std::string& text) { warnings.push_back(text); }),
               world_of(Json::parse(example))));
    return fmt::format("{}", fmt::join(warnings, "; "));
  };
  CHECK(told_of(Json::parse(example)).empty());
  const auto told = [&](const char* place, const Json& value) {
    Json document = Json::parse(example);
    document[Json::json_pointer(place)] = value;
    return told_of(document);
  };
  // As published collections of terrain have it; the benchmark uses grid_width alone.
  CHECK(told("/grid_height", 1) ==
        "w.json:1:31: /grid_height: is 1, but there are cells up to row 2; read as 3");
  CHECK(told("/grid_height", "3") ==
        "w.json:1:31: /grid_height: '3' is no number of rows; read as 3");
  CHECK(contains(told("/grid_height", nullptr), "nothing is no number of rows"));
  CHECK(contains(told("/grid_height", 0), "'0' is no number"));
  CHECK(contains(told("/grid_height", 1000000000), "'1000000000' is no number"));
  CHECK(told("/grid_height", 99).empty());
  CHECK(contains(told("/objects/ground/neighbors/1", {2, 3}),
                 ": /objects/ground/neighbors/1/1: neighbour 3 of cell 1 is not adjacent to it; "
                 "left out"));
  CHECK(contains(told("/objects/ground/neighbors/1", {1, 2}), "not adjacent"));
  CHECK(told("/objects/ground/neighbors/1", {2.0}).empty());
  CHECK(told("/objects/ground/types/0", 5.0).empty());
  Json twice = Json::parse(example);
  Json& block = twice["objects"]["block"];
  block["indices"].insert(block["indices"].begin(), block["indices"][0]);
  block["types"].insert(block["types"].begin(), 2);
  block["neighbors"]["x"] = {99};
  CHECK_THAT(told_of(twice),
             Catch::Matches(R"([^;]*/indices/1: cell 12 is listed twice; its last type counts; )"
                            R"([^;]*/neighbors/x: 'x' is not a cell of this object; left out)"));
}

TEST_CASE("EvoGym world: partial links are kept") {
  Json document = Json::parse(R"({"grid_width":2,"grid_height":2,"objects":{
      "a":{"indices":[0,1,2,3],"types":[3,3,3,3],
           "neighbors":{"0":[2],"1":[3],"2":[0,3],"3":[1,2]}}}})");
  const World world = world_of(document);
  CHECK(world.objects[0].body.links == std::vector<Link>{{0, 1}, {0, 2}, {1, 3}});
  CHECK(same(world_of(parsed(world)), world));
}

TEST_CASE("EvoGym world: every broken rule is named with its path") {
  const std::vector<std::array<const char*, 3>> missing{
      {"", "grid_width", "w.json:1:1: key 'grid_width' is missing"},
      {"", "objects", "key 'objects' is missing"},
      {"/objects/block", "types", "/objects/block: key 'types' is missing"},
      {"/objects/block", "neighbors", "key 'neighbors' is missing"},
      {"/objects/block/neighbors", "7", "/objects/block: 2 indices, 2 types and 1 neighbors"}};
  for (const auto& [parent, key, message] : missing) {
    Json document = Json::parse(example);
    document[Json::json_pointer(parent)].erase(key);
    refuses(message, document);
  }
  struct Broken {
    const char* path;
    Json value;
    const char* message;
  };
  const std::vector<Broken> all{
      {"/grid_width", 0, "/grid_width: a whole number from 1 to 100000 is expected, found '0'"},
      {"/objects", Json::array(), "/objects: a mapping"},
      {"/objects/block", 3, "/objects/block: a mapping"},
      {"/objects/block/indices/0", 500'000,
       "/objects/block/indices/0: cell '500000' is outside the grid of 5x3 cells, 0 to 14"},
      {"/objects/block/indices/0", -1, "cell '-1' is outside"},
      {"/objects/block/indices/0", 1.5, "cell '1.5' is outside"},
      {"/objects/block/types/1", 6,
       "/objects/block/types/1: unknown type '6'; allowed 0 1 2 3 4 5"},
      {"/objects/block/types/1", "R", "unknown type 'R'"},
      {"/objects/block/neighbors/12/0", 2,
       "/objects/block/neighbors/12/0: neighbour 2 of cell 12 is not a cell of this"},
      {"/objects/block/neighbors/12/0", 99, "outside the grid"},
      {"/objects/ground/neighbors/1", 2, "a list is expected"},
      {"/objects/block/types", {0, 0}, "/objects/block: an object without"},
      {"/objects/block/types", {0, 1}, "but one is empty"},
      {"/objects/ground/neighbors", Json({{"1", {2}}, {"2", {1}}, {"3", Json::array()}}),
       "/objects/ground: inside its box, the voxel at row 1, column 3 is not connected"}};
  for (const auto& [path, value, message] : all) {
    Json document = Json::parse(example);
    document[Json::json_pointer(path)] = value;
    refuses(message, document);
  }

  // 9 and 0 follow each other in the object's matrix, but lie at both ends of its rows.
  refuses("neighbour 9 of cell 0 is not adjacent",
          Json::parse(
              R"({"grid_width":5,"grid_height":2,"objects":{"a":{"indices":[0,1,2,3,4,9],
              "types":[1,1,1,1,1,1],
              "neighbors":{"0":[1,9],"1":[2],"2":[3],"3":[4],"4":[9],"9":[]}}}})"));
  // Two objects in one cell.
  Json overlapping = Json::parse(example);
  overlapping["objects"]["peg"] = {
      {"indices", {7}}, {"types", {1}}, {"neighbors", {{"7", Json::array()}}}};
  refuses("/objects/peg: objects 'block' and 'peg' overlap at cell (2, 1)", overlapping);
  // A few cells cannot span a large box.
  refuses("2 cells cannot connect the 100000x100000 cells",
          Json::parse(
              R"({"grid_width":100000,"grid_height":100000,"objects":{"a":{"indices":[0,9999999999],
              "types":[1,1],"neighbors":{"0":[],"9999999999":[]}}}})"));

  const ScratchFolder folder;
  write_file(folder / "w.json", R"({"grid_width":1,"grid_height":1,"objects":{"a":1,"a":2}})");
  CHECK(contains(error_of(Failure::data, [&] { (void)read_evogym_world(folder / "w.json"); }),
                 "key 'a' is given twice"));
  error_of(Failure::no_input, [&] { (void)read_evogym_world(folder / "none.json"); });
}

TEST_CASE("EvoGym world: what the format cannot hold is not written") {
  const Body cell = Body::from_rows({"R"});
  error_of(Failure::data, [&] { (void)evogym_world_to_json({{{"a", cell, -1, 0}}}); });
  error_of(Failure::data, [&] {
    (void)evogym_world_to_json({{{"a", cell, 0, 0}, {"a", cell, 1, 0}}});
  });
}

TEST_CASE("EvoGym world: a robot is a world of one object, with its empty border and id") {
  for (const auto& rows : std::vector<std::vector<std::string>>{{"HVH", "S.S"},
                                                                {"...", ".H.", "..."},
                                                                {".HV", "..."},
                                                                {"..", "H.", "V."},
                                                                {"H.", ".."}}) {
    const Robot robot(Body::from_rows(rows));
    const World world = world_of(parsed(evogym_world_of_robot(robot)));
    const Robot back = robot_from_evogym_world(world, "r.json");
    CHECK(back.id == robot.id);
    CHECK(back.body == robot.body);
    CHECK(world.objects.front().x == 0);
    CHECK(world.objects.front().y == 0);
  }
  const World two = world_of(Json::parse(example));
  CHECK(contains(error_of(Failure::data, [&] { (void)robot_from_evogym_world(two, "r.json"); }),
                 "r.json: a world of 2 objects, 0 with actuators; one is expected, the robot"));
}

TEST_CASE("EvoGym experiment: robots with fitness, each once") {
  const ScratchFolder folder;
  const Body a = Body::from_rows({"HV"});
  const Body b = Body::from_rows({"VV"});
  const Body c = Body::from_rows({"HH", "V."});
  const auto structures = [&](int generation) {
    const fs::path place = folder.path() / fmt::format("generation_{}", generation) / "structure";
    fs::create_directories(place);
    return place;
  };
  write_file(folder / "metadata.txt", "POP_SIZE: 2\nSTRUCTURE_SHAPE: 1 2\nMAX_EVALUATIONS: 4\n");
  CHECK_FALSE(is_evogym_experiment(folder.path()));
  write_file(structures(0) / "0.npz", body_to_npz(a));
  write_file(structures(0) / "1.npz", body_to_npz(b));
  write_file(structures(0).parent_path() / "output.txt", "1\t\t2.5\n0\t\t-0.1\n");
  write_file(structures(1) / "0.npz", body_to_npz(b));  // the survivor
  write_file(structures(1) / "1.npz", body_to_npz(c));
  write_file(structures(1).parent_path() / "output.txt", "1\t\t3.25\n0\t\t2.5\n");
  CHECK(is_evogym_experiment(folder.path()));

  auto robots = read_evogym_experiment(folder.path());
  REQUIRE(robots.size() == 3);
  CHECK(robots[0].body == b);
  CHECK(robots[0].fitness() == 2.5);
  CHECK(robots[0].document["origin"] ==
        Json({{"tool", "evogym"}, {"generation", 0}, {"label", 1}}));
  CHECK(robots[1].body == a);
  CHECK(robots[1].fitness() == -0.1);
  CHECK(robots[2].body == c);
  CHECK(robots[2].fitness() == 3.25);
  CHECK(robots[2].document["origin"]["generation"] == 1);

  SECTION("an unfinished generation has robots without fitness") {
    write_file(structures(2) / "0.npz", body_to_npz(Body::from_rows({"H"})));
    robots = read_evogym_experiment(folder.path());
    REQUIRE(robots.size() == 4);
    CHECK_FALSE(robots[3].document.contains("fitness"));
  }
  SECTION("a fitness that is no number is null") {
    write_file(structures(1).parent_path() / "output.txt", "1\t\t-inf\n0\t\t7\n");
    robots = read_evogym_experiment(folder.path());
    CHECK(robots[2].document["fitness"].is_null());
    CHECK(robots[0].fitness() == 7.0);  // trained again and better
  }
  SECTION("what is wrong is named") {
    const fs::path ranking = structures(1).parent_path() / "output.txt";
    const auto refused = [&](Failure kind) {
      return error_of(kind, [&] { (void)read_evogym_experiment(folder.path()); });
    };
    write_file(ranking, "1\t\t3\n0\t\tx\n");
    CHECK(contains(refused(Failure::data), "output.txt: line 2: expected a label and a fitness"));
    write_file(ranking, "1\t\t3\n1\t\t2\n");
    CHECK(contains(refused(Failure::data), "label 1 is ranked twice"));
    write_file(ranking, "5\t\t3\n");
    CHECK(contains(refused(Failure::no_input), "5.npz"));
    error_of(Failure::no_input, [&] { (void)read_evogym_experiment(folder / "none"); });
    error_of(Failure::no_input, [&] { (void)read_evogym_experiment(structures(0)); });
  }
}

TEST_CASE("EvoGym world: damaged text throws Error and nothing else") {
  const std::string original = compact(Json::parse(example));
  const int refused = refusals({original}, 5000, text_signs, [](const std::string& text) {
    for (const Object& object : read_evogym_world(Node::json(text, "in")).objects)
      REQUIRE_FALSE(defect(object.body, false));
  });
  CHECK(refused > 2500);
}

TEST_CASE("EvoGym world: 200x200 cells are written and read") {
  const Robot robot(full_body(200, 200));
  const std::string text = evogym_world_to_json(evogym_world_of_robot(robot));
  const World world = read_evogym_world(Node::json(text, "large"));
  CHECK(robot_from_evogym_world(world, "large").id == robot.id);
}
