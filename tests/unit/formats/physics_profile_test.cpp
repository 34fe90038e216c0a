#include "formats/task/physics_profile.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "tests/unit/expect.h"

using namespace evo;
using namespace evo::test;

namespace {

const DataFolders data{std::filesystem::path(EVO_SOURCE_DIR) / "tasks"};

Physics read(const std::string& text) {
  return physics_profiles().read(Node::yaml(text, "p.yaml"), "", data);
}

std::string message(const std::string& text) {
  return error_of(Failure::data, [&] { read(text); });
}

std::string override_message(const std::string& assignment) {
  Physics physics;
  return error_of(Failure::usage, [&] {
    physics_profiles().assign(physics, assignment);
    physics_profiles().check(physics);
  });
}

}  // namespace

TEST_CASE("the profile evogym is what libevo has built in") {
  CHECK(physics_profiles().load("evogym", data) == Physics{});
  CHECK(physics_profiles().load("evogym", {}) == Physics{});
  CHECK(read("{}") == Physics{});
}

TEST_CASE("the profile paper differs in contact, friction, soft cells and actuators") {
  Physics expected;
  expected.contact_stiffness = 2.1e7;
  expected.soft = {3e8 / 5.0, 3e8 / 10.0};
  expected.actuator = {3e8 / 6.0, 3e8 / 24.0};
  expected.friction_coefficient = 0.1;
  expected.friction_multiplier = 2.4e3;
  CHECK(physics_profiles().load("paper", data) == expected);
}

TEST_CASE("a profile gives what differs from its base") {
  Physics expected = physics_profiles().load("paper", data);
  expected.gravity = 50.0;
  expected.rigid.edge = 3e8 / 3.7;
  CHECK(read("base: paper\ngravity: 50\nrigid: {edge: 3e8 / 3.7}\n") == expected);
}

TEST_CASE("a base may be a file beside the profile") {
  const ScratchFolder folder;
  std::ofstream(folder / "moon.yaml") << "base: paper\ngravity: 18\n";
  std::ofstream(folder / "slow.yaml") << "base: ./moon.yaml\nsubsteps: 10\n";
  std::ofstream(folder / "ring.yaml") << "base: ./ring.yaml\n";
  const Physics slow = physics_profiles().load((folder / "slow.yaml").string(), data);
  CHECK(slow.gravity == 18.0);
  CHECK(slow.substeps == 10);
  CHECK(slow.contact_stiffness == 2.1e7);
  CHECK_THROWS_WITH(physics_profiles().load((folder / "ring.yaml").string(), data),
                    Catch::Contains("in a circle"));
}

TEST_CASE("every constant can be overridden") {
  for (const SettingRow& row : physics_profiles().rows({})) {
    const std::string& key = row.key;
    Physics physics;
    physics_profiles().assign(physics, key + (key == "min_target" ? "=1" : "=7"));
    INFO(key);
    CHECK_FALSE(physics == Physics{});
  }
  Physics physics;
  physics_profiles().assign(physics, "soft.edge=3e8/7");
  CHECK(physics.soft.edge == 3e8 / 7.0);
  CHECK(physics.soft.diagonal == 3e8 / 24.0);
}

TEST_CASE("mistakes in overrides are named") {
  CHECK(override_message("gravty=50")
            .find("unknown physics constant 'gravty' (did you mean 'gravity'?); allowed: ") == 0);
  CHECK(override_message("gravity=heavy") ==
        "a number of at least 0 is expected for 'gravity', found 'heavy'");
  CHECK(override_message("gravity").find("KEY=VALUE is expected") == 0);
  CHECK(override_message("=5").find("KEY=VALUE is expected") == 0);
  CHECK(override_message("substeps=0.5").find("a whole number from 1 to 10000") == 0);
  CHECK(override_message("substep=0").find("a number above 0") == 0);
  CHECK(override_message("min_target=3").find("min_target 3 is greater than max_target 1.6") == 0);
}

TEST_CASE("mistakes in profiles are named with their place") {
  CHECK(message("gravity: 5\nfrction_coefficient: 1\n")
            .find("p.yaml:2:1: physics profile: unknown key 'frction_coefficient' (did you mean "
                  "'friction_coefficient'?); allowed: ") == 0);
  CHECK(message("gravity: -5\n").find("p.yaml:1:10: a number of at least 0") == 0);
  CHECK(message("gravity: 1/0\n").find("p.yaml:1:10: ") == 0);
  CHECK(message("soft: 5\n").find("p.yaml:1:7: soft: a mapping") == 0);
  CHECK(message("soft: {egde: 5}\n")
            .find("p.yaml:1:8: soft: unknown key 'egde' (did you mean "
                  "'edge'?)") == 0);
  CHECK(message("base: papper\n")
            .find("p.yaml:1:7: unknown physics profile 'papper' (did you mean "
                  "'paper'?); allowed: evogym, paper") == 0);
  CHECK(message("base: ./nowhere.yaml\n").find("p.yaml:1:7: ") == 0);
  CHECK(message("format: evo/task\n") ==
        "p.yaml:1:9: format 'evo/physics' is expected, found 'evo/task'");
  CHECK(message("version: 2\n") ==
        "p.yaml:1:10: evo/physics version 2 is newer than this program, which reads up to 1");
  CHECK(message("min_target: 2\n").find("p.yaml:1:1: min_target 2 is greater") == 0);
}
