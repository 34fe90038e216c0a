#include "formats/training/training.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "formats/io/files.h"
#include "tests/unit/expect.h"

using namespace evo;
using evo::test::error_of;

namespace {

const DataFolders data{std::filesystem::path(EVO_SOURCE_DIR) / "tasks"};

TrainingSettings read(const std::string& text) {
  return training_profiles().read(Node::yaml(text, "t.yaml"), "", data);
}

std::string message(const std::string& text) {
  return error_of(Failure::data, [&] { read(text); });
}

std::string override_message(const std::string& assignment) {
  TrainingSettings settings;
  return error_of(Failure::usage, [&] { training_profiles().assign(settings, assignment); });
}

}  // namespace

TEST_CASE("the profile paper is what libevo has built in") {
  CHECK(training_profiles().load("paper", data) == TrainingSettings{});
  CHECK(training_profiles().load("paper", {}) == TrainingSettings{});
  CHECK(read("{}") == TrainingSettings{});
  const auto path = find_data_file(data, "training", "paper");
  REQUIRE(path);
  const Node node = Node::yaml(read_file(*path), "paper.yaml");
  const Mapping mapping(node, "profile", [] {
    std::vector<std::string> keys{"format", "version", "name", "description"};
    for (const SettingRow& row : training_profiles().rows({})) keys.push_back(row.key);
    return keys;
  }());
  for (const char* key : {"steps", "rollout", "gamma", "learning_rate", "hidden"})
    CHECK(mapping.has(key));
}

TEST_CASE("the help of the setting algorithm names every algorithm") {
  const SettingRow algorithm = training_profiles().rows({}).front();
  REQUIRE(algorithm.key == "algorithm");
  for (const std::string& name : algorithm_names())
    CHECK_THAT(algorithm.meaning, Catch::Contains(name));
}

TEST_CASE("every profile in the repository reads and can be written back") {
  const std::vector<std::string> names = data_names(data, "training");
  CHECK(names.size() >= 3);
  for (const std::string& name : names) {
    INFO(name);
    const TrainingSettings settings = training_profiles().load(name, data);
    CHECK(read(training_profiles().to_yaml(settings)) == settings);
  }
}

TEST_CASE("a training profile gives what differs from its base") {
  TrainingSettings expected;
  expected.hidden = {32, 16, 8};
  expected.entropy_coefficient = 0.0;
  expected.time_limit = TimeLimit::bootstrap;
  CHECK(read("base: paper\nhidden: [32, 16, 8]\nentropy_coefficient: 0\ntime_limit: bootstrap\n") ==
        expected);
  expected = {};
  expected.hidden = {};
  CHECK(read("hidden: []") == expected);
  CHECK(read(training_profiles().to_yaml(expected)) == expected);
}

TEST_CASE("mistakes in a training profile are named with place and remedy") {
  CHECK_THAT(message("gama: 0.9"), Catch::Contains("t.yaml:1") && Catch::Contains("'gamma'"));
  CHECK_THAT(message("epochs: 4\nclip: wide"),
             Catch::Contains("t.yaml:2") &&
                 Catch::Contains("a number above 0 is expected for 'clip'") &&
                 Catch::Contains("'wide'"));
  CHECK_THAT(message("epochs: 2.5"),
             Catch::Contains("a whole number of at least 1 is expected for 'epochs'"));
  CHECK_THAT(message("algorithm: dqn"), Catch::Contains("one of ppo, gait, sequence, modular"));
  CHECK_THAT(message("clip: [1, 2]"), Catch::Contains("a number above 0 is expected for 'clip'"));
  CHECK_THAT(
      message("hidden: [64, x]"),
      Catch::Contains("a list, each a whole number of at least 1, is expected for 'hidden'"));
  CHECK_THAT(message("gamma: 1.5"),
             Catch::Contains("a number from 0 to 1 is expected for 'gamma', found '1.5'"));
  CHECK_THAT(message("time_limit: bootstrapp"), Catch::Contains("did you mean 'bootstrap'"));
  CHECK_THAT(message("clip: {a: 1}"), Catch::Contains("a value is expected for 'clip'"));
  CHECK_THAT(message("minibatches: 1000"), Catch::Contains("fewer samples"));
  CHECK_THAT(message("steps: 100"), Catch::Contains("less than one rollout"));
  CHECK_THAT(message("base: papr"), Catch::Contains("did you mean 'paper'"));
  CHECK_THAT(message("version: 2"), Catch::Contains("version"));
}

TEST_CASE("single settings can be overridden") {
  TrainingSettings settings;
  training_profiles().assign(settings, "gamma=0.995");
  training_profiles().assign(settings, "hidden=32,32");
  training_profiles().assign(settings, "clip_value_loss=false");
  training_profiles().assign(settings, "steps=3M");
  CHECK(settings.gamma == 0.995);
  CHECK(settings.hidden == std::vector<int>{32, 32});
  CHECK_FALSE(settings.clip_value_loss);
  CHECK(settings.steps == 3'000'000);
  CHECK_THAT(override_message("gamma"), Catch::Contains("KEY=VALUE"));
  CHECK_THAT(override_message("gmma=1"), Catch::Contains("did you mean 'gamma'"));
  CHECK_THAT(override_message("epochs=many"), Catch::Contains("a whole number"));
}
