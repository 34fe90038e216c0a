#include "formats/robot/robot.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "formats/io/files.h"
#include "formats/io/hdf5.h"
#include "formats/io/npz.h"
#include "formats/robot/children.h"
#include "libevo/base/random.h"
#include "libevo/body/operators.h"
#include "tests/unit/expect.h"
#include "tests/unit/formats/damage.h"

using namespace evo;
using namespace evo::test;

namespace {

std::string refused(const std::string& text, BodyCheck check = BodyCheck::robot) {
  return error_of(Failure::data, [&] { (void)parse_robots(text, "in", check); });
}

Robot one(const std::string& text, BodyCheck check = BodyCheck::robot) {
  const auto robots = parse_robots(text, "in", check);
  REQUIRE(robots.size() == 1);
  return robots.front();
}

const std::string example =
    R"({"format":"evo/robot","version":1,"id":"66ea808bff25",)"
    R"("body":["HHHHH","V.R.V","V...V"],"parents":["a01b44d09e2c"],)"
    R"("origin":{"tool":"evo-mutate","seed":7,"index":3},"fitness":9.81,"task":"Walker-v0",)"
    R"("steps":512000,"policy":"policies/3f9c02d41b7a.policy.h5"})";

}  // namespace

TEST_CASE("Robot: a document passes through unchanged") {
  const Robot robot = one(example + "\n");
  CHECK(robot_to_line(robot) == example);
  CHECK(robot.fitness() == 9.81);
  CHECK(robot.id == identity(robot.body));
  // As an indented document, as YAML, and as an element of an array, too.
  CHECK(robot_to_line(one(robot_to_json(robot))) == example);
  CHECK(robot_to_line(one(robot_to_yaml(robot))) == example);
  CHECK(robot_to_line(one("[" + example + "]")) == example);
}

TEST_CASE("Robot: unknown fields stay, after the known ones in canonical order") {
  const std::string line =
      R"({"note":{"b":[1,2.5,null,true,"x/\u00fc"],"a":0.1},"fitness":1e-7,"body":["H"],)"
      R"("returns":[0.30000000000000004,-0.0,1e300]})";
  const std::string written = robot_to_line(one(line));
  CHECK(written ==
        R"({"format":"evo/robot","version":1,"id":"84f928926ab9","body":["H"],"fitness":1e-07,)"
        R"("note":{"b":[1,2.5,null,true,"x/ü"],"a":0.1},)"
        R"("returns":[0.30000000000000004,-0.0,1e+300]})");
  CHECK(robot_to_line(one(written)) == written);
  CHECK(robot_to_line(one(robot_to_yaml(one(line)))) == written);
  CHECK(robot_to_line(one(robot_to_json(one(line)))) == written);
}

TEST_CASE("Robot: numbers come back to the last bit") {
  Stream stream(1, "test/numbers");
  Robot robot(Body::from_rows({"H"}));
  for (int i = 0; i < 2000; ++i) {
    const double value = stream.gaussian() * std::exp(200 * stream.gaussian());
    if (!std::isfinite(value)) continue;
    robot.document["fitness"] = value;
    REQUIRE(one(robot_to_line(robot)).fitness() == value);
    REQUIRE(one(robot_to_yaml(robot)).fitness() == value);
  }
}

TEST_CASE("Robot: all the forms that a body can have") {
  const std::string id = identity(Body::from_rows({"HH.", "V.S", "VRS"}));
  for (const std::string text : {
           R"({"body":["HH.","V.S","VRS"]})",
           R"({"body":[[3,3,0],[4,0,2],[4,1,2]]})",
           R"({"body":[[3.0,3.0,0.0],[4.0,0.0,2.0],[4.0,1.0,2.0]]})",
           R"({"body":"HH.\nV.S\nVRS\n"})",
           R"({"version":1,"id":null,"connections":null,"body":["HH.","V.S","VRS"]})",
           "\xEF\xBB\xBF{\"body\":[\"HH.\",\"V.S\",\"VRS\"]}",
           "HH.\nV.S\nVRS",
           "\n\n  \nHH.\r\nV.S \r\nVRS\t\r\n\r\n",
           "body:\n  - HH.\n  - V.S\n  - VRS\n",
           "# drawn by hand\nbody: |\n  HH.\n  V.S\n  VRS\n",
           "---\nbody: [HH., V.S, VRS]\n...\n",
           "- body: [[3, 3, 0], [4, 0, 2], [4, 1, 2]]\n",
       })
    CHECK(one(text).id == id);
}

TEST_CASE("Robot: several documents in every form") {
  const auto ids = [](const std::string& text) {
    std::string joined;
    for (const Robot& robot : parse_robots(text, "in")) joined += robot.body.to_rows()[0] + " ";
    return joined;
  };
  CHECK(ids("{\"body\":[\"H\"]}\n{\"body\":[\"HV\"]}\n\n{\"body\":[\"V\"]}") == "H HV V ");
  CHECK(ids("{\n\"body\":[\n\"H\"]\n}\n{\"body\":[\"HV\"]}{\"body\":[\"V\"]}") == "H HV V ");
  CHECK(ids("[{\"body\":[\"H\"]},{\"body\":[\"V\"]}]") == "H V ");
  CHECK(ids("H\n\n\nHV\nHV\n\nV\n") == "H HV V ");
  CHECK(ids("body: [H]\n---\nbody: [V]\n---\n") == "H V ");
  CHECK(ids("- body: [H]\n- body: [V]\n") == "H V ");
  CHECK(ids("3 3\n4 4\n\n4 4\n3 3\n") == "HH VV ");
  CHECK(ids("[[[3,3],[4,4]], [[4]]]") == "HH V ");
  CHECK(ids("[[3 3]\n [4 4]]\n[[4]]\n") == "HH V ");
  CHECK(ids("").empty());
  CHECK(ids(" \n\t\r\n").empty());
}

TEST_CASE("Robot: YAML values keep their kinds") {
  const Robot robot =
      one("body: [H]\nid: 84f928926ab9\nparents: [000000000012, 1e5]\nfitness: 3\na: '3'\nb: -7\n"
          "c: .5\nd: yes\ne: null\nf: ~\ng: \"true\"\nh: true\ni: 1e400\nj: 18446744073709551615\n"
          "k: [.inf, 2026-01-01]\nl: {x: {y: -1.5e-3}}\n");
  const Json expected = Json::parse(R"({"parents":["000000000012","1e5"],"fitness":3,"a":"3",
      "b":-7,"c":0.5,"d":"yes","e":null,"f":null,"g":"true","h":true,"i":"1e400",
      "j":18446744073709551615,"k":[".inf","2026-01-01"],"l":{"x":{"y":-0.0015}}})");
  for (const auto& [key, value] : expected.items()) {
    INFO(key);
    CHECK(robot.document.at(key) == value);
  }
  // What looks like something else in YAML is quoted on writing.
  Robot tricky(Body::from_rows({"...", ".H."}));
  tricky.document["n: #"] = {"- a", ": b", "# c", "null", "1", "\n\t\"'", "\u00e4"};
  CHECK(one(robot_to_yaml(tricky)).document == tricky.document);
}

TEST_CASE("Robot: connections are part of the robot, but only where they say something") {
  const Robot slit = one(R"({"body":["HH","VV"],"connections":[[1,0],[2,0],[3,1],[1,3]]})");
  CHECK(slit.body.links == std::vector<Link>{{0, 1}, {0, 2}, {1, 3}});
  CHECK(slit.document["connections"] == Json({{0, 1}, {0, 2}, {1, 3}}));
  CHECK(slit.id != one(R"({"body":["HH","VV"]})").id);
  CHECK(one(robot_to_line(slit)).body == slit.body);
  CHECK(one(robot_to_yaml(slit)).body == slit.body);

  const Robot full = one(R"({"body":["HH","VV"],"connections":[[0,1],[0,2],[1,3],[2,3]]})");
  CHECK_FALSE(full.document.contains("connections"));
  CHECK(full.id == one(R"({"body":["HH","VV"]})").id);

  // As two lists of cells, as the benchmark has them; but [2, 2] are two pairs.
  CHECK(one(R"({"body":["HHH","V.V"],"connections":[[0,1,0,2],[1,2,3,5]]})").body.links ==
        std::vector<Link>{{0, 1}, {0, 3}, {1, 2}, {2, 5}});
  CHECK(one(R"({"body":["HV","S."],"connections":[[0,1],[0,2]]})").body.links ==
        std::vector<Link>{{0, 1}, {0, 2}});
}

TEST_CASE("Robot: stiffness is part of the robot, but only where it says something") {
  const Robot plain = one(R"({"body":["HS",".V"],"stiffness":[[1,1],[7,1]]})");
  CHECK(plain.id == one(R"({"body":["HS",".V"]})").id);
  CHECK_FALSE(plain.document.contains("stiffness"));
  const Robot stiff = one(R"({"body":["HS",".V"],"stiffness":[[2,1],[0,0.1]]})");
  CHECK(stiff.body.stiffness == std::vector<double>{2, 1, 1, 0.1});
  CHECK(stiff.document["stiffness"] == Json{{2.0, 1.0}, {1.0, 0.1}});
  CHECK(one(robot_to_line(stiff)).body == stiff.body);
  CHECK(one(robot_to_yaml(stiff)).body == stiff.body);
  CHECK_THROWS_WITH(one(R"({"body":["HS"],"stiffness":[[2]]})"),
                    Catch::EndsWith("2 factors are expected, as the body has columns, found 1"));
  CHECK_THROWS_WITH(one(R"({"body":["HS"],"stiffness":[[2,11]]})"),
                    Catch::EndsWith("stiffness 11 at row 1, column 2: a factor from 0.1 to 10 is "
                                    "expected"));
}

TEST_CASE("Robot: bad documents are refused with place, path and reason") {
  const std::vector<std::pair<std::string, const char*>> all{
      {R"({"body":["HHH","V.X"]})",
       "in:1:16: /body/1: unknown letter 'X' at row 2, column 3; allowed . R S H V"},
      {"{\"body\":[\"H\"]}\n\n{\"body\":[\"HHH\",\"V.X\"]}\n", "in:3:16: /body/1: unknown letter"},
      {R"([{"body":["H"]},{"body":["HHH","VX"]}])",
       "in:1:32: /1/body/1: row 2 has 2 cells, but row 1 has 3"},
      {R"({"body":[[3,3],[0,7]]})", "unknown value '7' at row 2, column 2; allowed 0 1 2 3 4"},
      {R"({"body":[[3,1.5]]})", "unknown value '1.5'"},
      {R"({"body":[[3,"H"]]})", "unknown value 'H'"},
      {R"({"body":["H#"]})",
       "letter '#' at row 1, column 2 is a fixed cell, which only worlds have"},
      {R"({"body":[[3,5]]})", "is a fixed cell"},
      {"{\"body\":[\"H\xC3\xA4\"]}", "0xC3"},
      {"{}", "in:1:1: key 'body' is missing"},
      {R"({"body":7})", "/body: a list of rows is expected, found '7'"},
      {R"({"body":[]})", "/body: a list of rows"},
      {R"({"body":[""]})", "/body/0: a row without cells"},
      {R"({"body":["H",null]})", "/body/1: a row of letters"},
      {R"({"body":["...","..."]})", "/body: there is no voxel"},
      {R"({"body":["H.",".V"]})", "/body: the voxel at row 2, column 2 is not connected"},
      {R"({"body":["RS"]})", "/body: there is no actuator"},
      {R"({"body":["HH"],"connections":[]})", "is not connected"},
      {R"({"body":["HH"],"connections":{"a":1}})", "/connections: a list"},
      {R"({"body":["HH"],"connections":[[0]]})", "/connections/0: a pair"},
      {R"({"body":["HH"],"connections":[[0,2]]})",
       "/connections/0/1: a whole number from 0 to 1 is expected, found '2'"},
      {R"({"body":["HH"],"connections":[[0,-1]]})", "/connections/0/1"},
      {R"({"body":["HH"],"connections":[[0,18446744073709551615]]})", "/connections/0/1"},
      {R"({"body":["HHH","V.V"],"connections":[[0,1,0],[1,2]]})", "a pair of cells is expected"},
      {R"({"body":["H.","VV"],"connections":[[0,1]]})",
       "connection 0-1 names the empty cell at row 1, column 2"},
      {R"({"body":["HH","VV"],"connections":[[1,2]]})", "not adjacent"},
      {R"({"body":["H"],"id":"84f928926abb"})",
       "/id: '84f928926abb' is not the id of this body, which is '84f928926ab9'"},
      {R"({"body":["H"],"id":84})", "/id"},
      {R"({"format":"evo/robt","body":["H"]})",
       "/format: format 'evo/robot' is expected, found 'evo/robt'"},
      {R"({"version":2,"body":["H"]})",
       "/version: evo/robot version 2 is newer than this program, which reads up to 1"},
      {R"({"version":"1","body":["H"]})", "/version: a whole number"},
      {R"({"body":["H"],"fitness":"9"})", "/fitness: a number or null is expected, found '9'"},
      {R"({"body":["H"],"parents":["a",1]})", "/parents: a list of robot ids"},
      {R"({"body":["H"],"steps":-1})", "/steps: a number of steps"},
      {R"(["H"])", "/0: a mapping (key: value) is expected, found 'H'"},
      {"HHH\nV.X\n", "in:2:1: unknown letter 'X' at row 2, column 3"},
      {"HH\n\nVV\nV\n", "in:4:1: row 2 has 1 cells"},
      {"3 3\n4 7\n", "in:2:3: unknown value '7'"},
      {"3 3\n4 1.5\n", "unknown value '1.5'"},
      {"3 3\n4 4e\n", "unknown value '4e'"},
      {"3 3\n4\n", "row 2 has 1 cells, but row 1 has 2"},
      {"[[3,3],[4,5]]", "fixed cell"},
      // Text that is malformed.
      {"{\"body\":[\"H\"]}\n{\"body\":[\"H\"],}\n", "in:2:15: not valid JSON: "},
      {"{\n\"body\":[\n\"H\" \"V\"]}", "in:3:7: not valid JSON: "},
      {"{\"body\":[\"H\"]", "unexpected end of input"},
      {"{\"body\":[\"H\"]} x", "in:1:16: a JSON object is expected"},
      {R"({"body":["H"],"body":["V"]})", "in:1:15: /body: key 'body' is given twice"},
      {"{\"body\":[\"H\"],\"x\":1e999}", "number overflow"},
      {"[1,,2]", "in:1:4: not valid JSON"},
      {"body:\n  - [1,,2]\n", "in:2:8: not valid YAML: nothing before the comma"},
      {"body:\n  - [3]\nmine: [1, , 2]\n", "in:3:11: not valid YAML"},
      {"{\"x\":\"\xFF\"}", "UTF-8"},
      {"body: [H\n", "in:2:1: not valid YAML: "},
      {"body: [H]\nbody: [V]\n", "in:2:1: key 'body' is given twice"},
      {"body:\n  - HH\n  - VX\n", "in:3:5: unknown letter 'X'"},
      {"a: 1\nx: [*nothing]\n", "in:2:5: not valid YAML: "},
      {"body: [H]\nx: !!binary \"\\xFF\"\nid: 7", "in:3:5"}};
  for (const auto& [text, message] : all) {
    CAPTURE(text);
    CHECK_THAT(refused(text), Catch::Contains(message));
  }
}

TEST_CASE("Robot: deep or endless documents are refused, not followed") {
  const std::string deep(200'000, '[');
  CHECK(contains(refused(deep), "nested deeper than 100 levels"));
  CHECK(contains(refused("{\"body\":" + deep), "nested deeper"));
  CHECK_FALSE(refused("a: " + deep).empty());
  std::string dashes;
  for (int i = 0; i < 50'000; ++i) dashes += "- ";
  CHECK_FALSE(refused(dashes).empty());
  CHECK(contains(refused("body: &a [*a]"), "in:1:11: an alias stands inside"));
  std::string doubling = "body: [H]\nx0: &x0 [1]\n";
  for (int i = 1; i < 40; ++i) doubling += fmt::format("x{0}: &x{0} [*x{1}, *x{1}]\n", i, i - 1);
  CHECK(contains(refused(doubling), "aliases repeat too much"));
  CHECK(contains(refused(std::string(largest_side + 1, 'H')), "the largest robot is 1000x1000"));
  Json high;
  high["body"] = std::vector<std::string>(largest_side + 1, "H");
  CHECK(contains(refused(high.dump()), "the largest robot"));
  CHECK(one(std::string(largest_side, 'H')).body.cols == largest_side);
}

TEST_CASE("Robot: a body that is no robot can be read where none is needed") {
  CHECK(one(R"({"body":["RS"]})", BodyCheck::any).id == identity(Body::from_rows({"RS"})));
  CHECK(one(R"({"body":["H.",".V"]})", BodyCheck::any).body.links.empty());
  CHECK(contains(refused(R"({"body":["HX"]})", BodyCheck::any), "unknown letter"));
}

TEST_CASE("Robot: what is written is the body, whatever became of the document") {
  Robot robot = one(example);
  robot.body = Body::from_rows({"HV"});
  robot.id = identity(robot.body);
  CHECK(one(robot_to_line(robot)).body == robot.body);
}

TEST_CASE("Robot: children say where they come from, and nothing else") {
  const Robot child = robot_of({Body::from_rows({"HV"}), "evo-mutate", {"a", "b"}}, 7, 3);
  CHECK(robot_to_line(child) ==
        fmt::format(R"({{"format":"evo/robot","version":1,"id":"{}","body":["HV"],)"
                    R"("parents":["a","b"],"origin":{{"tool":"evo-mutate","seed":7,"index":3}}}})",
                    identity(child.body)));
}

TEST_CASE("Robot: random robots pass through every form") {
  for (std::uint64_t i = 0; i < 200; ++i) {
    Stream stream(2, "test/robots", i);
    Robot robot(sample_body(stream.integer(1, 6), stream.integer(1, 6), default_weights, stream));
    // Take links away as long as the rest holds.
    for (std::size_t k = robot.body.links.size(); k-- > 0;) {
      Body fewer = robot.body;
      fewer.links.erase(fewer.links.begin() + static_cast<std::ptrdiff_t>(k));
      if (stream.below(2) == 0 && is_connected(fewer)) robot = Robot(fewer);
    }
    for (const std::string& text :
         {robot_to_line(robot), robot_to_json(robot), robot_to_yaml(robot)}) {
      const Robot back = one(text);
      REQUIRE(back.body == robot.body);
      REQUIRE(back.id == robot.id);
      REQUIRE(back.document == robot.document);
    }
  }
}

TEST_CASE("Robot: an input is a file, and an HDF5 file stands for its robot") {
  const ScratchFolder folder;
  write_file(folder / "p.jsonl", example + "\n" + example + "\n");
  CHECK(read_robots((folder / "p.jsonl").string()).size() == 2);
  error_of(Failure::no_input, [&] { (void)read_robots((folder / "none").string()); });
  const auto hdf5_with = [&](const std::string& robot) {
    hdf5::Writer file(folder / "r.h5");
    file.attribute("/", "robot", robot);
    file.commit();
    return (folder / "r.h5").string();
  };
  const auto robots = read_robots(hdf5_with(example));
  REQUIRE(robots.size() == 1);
  CHECK(robot_to_line(robots[0]) == example);
  CHECK(contains(error_of(Failure::data, [&] { (void)read_robots(hdf5_with("{")); }), "@robot"));
}

TEST_CASE("Robot: what cannot be robots is refused before it is read to its end") {
  const ScratchFolder folder;
  const auto file = (folder / "endless").string();
  const auto refused = [&](const std::string& beginning) {
    write_file(file, beginning);
    std::filesystem::resize_file(file, largest_input);  // sparse: nothing is written
    return error_of(Failure::data, [&] { (void)read_robot_text(file); });
  };
  CHECK(contains(refused(std::string(1 << 16, 'x')), "endless:1:1: "));
  CHECK(contains(refused("a: b\n"), "8 MiB"));
  CHECK(contains(refused("a: \x01" + std::string(1 << 16, 'x')), "control character"));
  CHECK(contains(refused(R"({"body":[)"), "more than 64 MiB"));
  CHECK(contains(refused(R"({"body":["HV"]}{"body":[)"), "more than 64 MiB"));
  CHECK(contains(refused("HV\n\n"), "64 MiB"));
  CHECK(contains(refused("\x89HDF\r\n\x1a\n"), "damaged or truncated"));
}

TEST_CASE("Robot: too many of them are refused before they are parsed") {
  const ScratchFolder folder;
  std::string text;
  while (text.size() <= largest_value) text += "{\"body\":[\"HV\"]}\n";
  write_file(folder / "many", text);
  CHECK(
      contains(error_of(Failure::data, [&] { (void)read_robot_text((folder / "many").string()); }),
               "more than 1000000 robots"));
}

TEST_CASE("Robot: a long first document is no trap") {
  const ScratchFolder folder;
  const std::string text =
      robot_to_line(Robot(Body::from_rows(std::vector<std::string>(400, std::string(400, 'H'))))) +
      "\n" + example + "\n";
  REQUIRE(text.size() > (1 << 17));
  write_file(folder / "large", text);
  CHECK(read_robot_text((folder / "large").string()) == text);
  CHECK(read_robots((folder / "large").string()).size() == 2);
}

TEST_CASE("Robot: damaged text throws Error and nothing else") {
  const Robot robot =
      one(R"({"body":["HH","VV"],"connections":[[0,1],[0,2],[1,3]],"note":"\u00e4"})");
  const std::vector<std::string> originals{example, robot_to_json(robot), robot_to_yaml(robot),
                                           "HHH\nV.V\n\nHH\n"};
  const int refused = refusals(originals, 6000, text_signs, [](const std::string& text) {
    for (const Robot& read : parse_robots(text, "in")) {
      REQUIRE(is_valid_robot(read.body));
      REQUIRE(one(robot_to_line(read)).id == read.id);
    }
  });
  CHECK(refused > 1000);
  CHECK(refused < 6000);
}

// As the benchmark's scripts and numpy.savetxt write them, and as people keep them; right values
// are the benchmark's.
TEST_CASE("Robot: bodies that others write, print and keep are read") {
  for (const char* text :
       {"3 3 3\n4 0 4\n", "3.000000000000000000e+00 3.0 3\n4 0e0 4\n", "3,3,3\n4,0,4",
        "3, 3, 3\n4, 0, 4\n", "[[3,3,3],[4,0,4]]", "[[3.0, 3.0, 3.0],\n [4.0, 0.0, 4.0]]\n",
        "333/404", "333\n404\n", "HHH/V.V\n", R"({"body":"333/404"})", "body: [333, 404]\n",
        "[[3. 3. 3.]\n [4. 0. 4.]]\n", "[[3 3 3]\n [4 0 4]]", R"({"structure":[[3,3,3],[4,0,4]]})",
        R"({"env_name":"Walker-v0","robot":[[3,3,3],[4,0,4]],"genes":[0.1]})",
        R"({"robot":{"body":["HHH","V.V"]},"score":3})"}) {
    INFO(text);
    CHECK(one(text).id == "9bdfd2342d8b");
    CHECK(one(robot_to_line(one(text))).id == "9bdfd2342d8b");
  }
  CHECK(one(R"({"robot":[[3,4]],"fitness":1.25,"n_in":15})").fitness() == 1.25);
  CHECK(one(R"({"body":["HV"],"structure":"mine"})").document["structure"] == "mine");
}

TEST_CASE("Robot: NumPy's files and worlds of the design tool are robots, told by their bytes") {
  const Body body = Body::from_rows({"HHH", "V.V"});
  CHECK(robots_in(body_to_npz(body), "robot.data").at(0).id == "9bdfd2342d8b");
  const ScratchFolder folder;
  const Body largest(largest_side, largest_side,
                     std::vector(std::size_t{largest_side} * largest_side, Voxel::horizontal));
  write_file(folder / "largest", body_to_npz(largest));
  CHECK(read_robots((folder / "largest").string()).at(0).body == largest);
  std::string header = "{'descr': '<i8', 'fortran_order': False, 'shape': (2, 3), }";
  header.resize(117, ' ');
  std::string npy = std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + "\n";
  for (const char kind : {'\3', '\3', '\3', '\4', '\0', '\4'})
    npy += std::string(1, kind) + std::string(7, '\0');
  CHECK(robots_in(npy, "robot.npy").at(0).id == "9bdfd2342d8b");
  npy.resize(npy.size() - 1);
  CHECK(contains(error_of(Failure::data, [&] { (void)robots_in(npy, "robot.npy"); }),
                 "robot.npy: 2 x 3 numbers are announced, there are 5"));
  const std::string world = R"({"grid_width":4,"grid_height":1,"objects":{
      "ground":{"indices":[0,1],"types":[5,5],"neighbors":{"0":[1],"1":[0]}},
      "walker":{"indices":[4,5],"types":[3,4],"neighbors":{"4":[5],"5":[4]}}}})";
  CHECK(one(world).body == Body::from_rows({"HV"}));
}
