// Profiles of physics and of trainings: what is of both, then what is of one.
#include "formats/io/profile.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <utility>
#include <vector>

#include "formats/io/files.h"
#include "formats/task/physics_profile.h"
#include "formats/training/training.h"
#include "tests/unit/expect.h"

using namespace evo;
using namespace evo::test;

namespace {

const DataFolders data{"tasks"};

template <typename Settings>
Settings read(const Profiles<Settings>& profiles, const std::string& text) {
  return profiles.read(Node::yaml(text, "p.yaml"), "", data);
}

// Texts, and how the message of their mistake begins.
using Mistakes = std::vector<std::pair<const char*, const char*>>;

template <typename Settings>
void check_mistakes(const Profiles<Settings>& profiles, const Mistakes& files,
                    const Mistakes& assignments) {
  for (const auto& [text, message] : files) {
    INFO(text);
    expect_error(Failure::data, Catch::StartsWith(message), [&] { read(profiles, text); });
  }
  for (const auto& [text, message] : assignments) {
    INFO(text);
    expect_error(Failure::usage, Catch::StartsWith(message), [&] {
      Settings settings;
      profiles.assign(settings, text);
      profiles.check(settings);
    });
  }
}

}  // namespace

TEST_CASE("the profiles evogym and paper are what libevo has built in") {
  const auto check = [](const auto& profiles, const char* root) {
    const auto built_in = profiles.load(root, {});
    CHECK(built_in == decltype(built_in){});
    CHECK(profiles.load(root, data) == built_in);
    CHECK(read(profiles, "{}") == built_in);
  };
  check(physics_profiles(), "evogym");
  check(training_profiles(), "paper");
}

TEST_CASE("mistakes in profiles of physics are named with their place, in settings with the key") {
  check_mistakes(
      physics_profiles(),
      {{"gravity: 5\nfrction_coefficient: 1\n",
        "p.yaml:2:1: physics profile: unknown key 'frction_coefficient' (did you mean "
        "'friction_coefficient'?); allowed: "},
       {"gravity: -5\n", "p.yaml:1:10: a number of at least 0"},
       {"gravity: 1/0\n", "p.yaml:1:10: "},
       {"soft: 5\n", "p.yaml:1:7: soft: a mapping"},
       {"soft: {egde: 5}\n", "p.yaml:1:8: soft: unknown key 'egde' (did you mean 'edge'?)"},
       {"base: papper\n",
        "p.yaml:1:7: unknown physics profile 'papper' (did you mean 'paper'?); allowed: evogym, "
        "paper"},
       {"base: ./nowhere.yaml\n", "p.yaml:1:7: "},
       {"format: evo/task\n", "p.yaml:1:9: format 'evo/physics' is expected, found 'evo/task'"},
       {"version: 2\n",
        "p.yaml:1:10: evo/physics version 2 is newer than this program, which reads up to 1"},
       {"min_target: 2\n", "p.yaml:1:1: min_target 2 is greater"}},
      {{"gravty=50", "unknown physics constant 'gravty' (did you mean 'gravity'?); allowed: "},
       {"gravity=heavy", "a number of at least 0 is expected for 'gravity', found 'heavy'"},
       {"gravity", "KEY=VALUE is expected"},
       {"=5", "KEY=VALUE is expected"},
       {"substeps=0.5", "a whole number from 1 to 10000"},
       {"substep=0", "a number above 0"},
       {"min_target=3", "min_target 3 is greater than max_target 1.6"}});
}

TEST_CASE("mistakes in profiles of training are named with place and remedy") {
  check_mistakes(
      training_profiles(),
      {{"gama: 0.9", "p.yaml:1:1: training profile: unknown key 'gama' (did you mean 'gamma'?)"},
       {"epochs: 4\nclip: wide",
        "p.yaml:2:7: a number above 0 is expected for 'clip', found 'wide'"},
       {"epochs: 2.5", "p.yaml:1:9: a whole number of at least 1 is expected for 'epochs'"},
       {"algorithm: dqn", "p.yaml:1:12: one of ppo, gait, sequence, modular"},
       {"clip: [1, 2]", "p.yaml:1:7: a number above 0 is expected for 'clip'"},
       {"hidden: [64, x]",
        "p.yaml:1:9: a list, each a whole number of at least 1, is expected for 'hidden'"},
       {"gamma: 1.5", "p.yaml:1:8: a number from 0 to 1 is expected for 'gamma', found '1.5'"},
       {"time_limit: bootstrapp",
        "p.yaml:1:13: one of end, bootstrap is expected for 'time_limit', found 'bootstrapp' (did "
        "you mean 'bootstrap'?)"},
       {"clip: {a: 1}", "p.yaml:1:7: a value is expected for 'clip'"},
       {"minibatches: 1000", "p.yaml:1:1: training: minibatches is 1000; a rollout has fewer"},
       {"steps: 100", "p.yaml:1:1: training: 100 steps are less than one rollout"}},
      {{"gmma=1", "unknown training setting 'gmma' (did you mean 'gamma'?)"}});
}

TEST_CASE("single settings can be overridden") {
  Physics constants;
  physics_profiles().assign(constants, "soft.edge=3e8/7");
  CHECK(constants.soft.edge == 3e8 / 7.0);
  CHECK(constants.soft.diagonal == 3e8 / 24.0);
  TrainingSettings settings;
  for (const char* assignment :
       {"gamma=0.995", "hidden=32,32", "clip_value_loss=false", "steps=3M"})
    training_profiles().assign(settings, assignment);
  CHECK(settings.gamma == 0.995);
  CHECK(settings.hidden == std::vector<int>{32, 32});
  CHECK_FALSE(settings.clip_value_loss);
  CHECK(settings.steps == 3'000'000);
}

TEST_CASE("a profile gives what differs from its base") {
  Physics expected = physics_profiles().load("paper", data);
  expected.gravity = 50.0;
  expected.rigid.edge = 3e8 / 3.7;
  CHECK(read(physics_profiles(), "base: paper\ngravity: 50\nrigid: {edge: 3e8 / 3.7}\n") ==
        expected);

  TrainingSettings settings;
  settings.hidden = {32, 16, 8};
  settings.entropy_coefficient = 0.0;
  settings.time_limit = TimeLimit::bootstrap;
  CHECK(read(training_profiles(),
             "base: paper\nhidden: [32, 16, 8]\nentropy_coefficient: 0\ntime_limit: bootstrap\n") ==
        settings);
  settings = {};
  settings.hidden = {};
  CHECK(read(training_profiles(), "hidden: []") == settings);
  CHECK(read(training_profiles(), training_profiles().to_yaml(settings)) == settings);
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

// ---- physics ---------------------------------------------------------------------------

TEST_CASE("the profile paper differs in contact, friction, soft cells and actuators") {
  Physics expected;
  expected.contact_stiffness = 2.1e7;
  expected.soft = {3e8 / 5.0, 3e8 / 10.0};
  expected.actuator = {3e8 / 6.0, 3e8 / 24.0};
  expected.friction_coefficient = 0.1;
  expected.friction_multiplier = 2.4e3;
  CHECK(physics_profiles().load("paper", data) == expected);
}

// ---- trainings -------------------------------------------------------------------------

TEST_CASE("the file of the training profile paper says what libevo has built in") {
  const auto path = find_data_file(data, "training", "paper");
  REQUIRE(path);
  const std::string text = read_file(*path);
  for (const char* key : {"steps", "rollout", "gamma", "learning_rate", "hidden"})
    CHECK_THAT(text, Catch::Contains(fmt::format("\n{}: ", key)));
}

TEST_CASE("every training profile in the repository reads and can be written back") {
  const std::vector<std::string> names = data_names(data, "training");
  CHECK(names.size() >= 3);
  for (const std::string& name : names) {
    INFO(name);
    const TrainingSettings settings = training_profiles().load(name, data);
    CHECK(read(training_profiles(), training_profiles().to_yaml(settings)) == settings);
  }
}
