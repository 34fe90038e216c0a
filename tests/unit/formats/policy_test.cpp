#include "formats/training/policy.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "formats/io/files.h"
#include "formats/io/hdf5.h"
#include "formats/io/json.h"
#include "formats/task/task.h"
#include "formats/training/controller_json.h"
#include "formats/training/policy_json.h"
#include "formats/training/training.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/modular_passes.h"
#include "tests/unit/expect.h"

using namespace evo;
using namespace evo::test;

namespace {

const DataFolders data{"tasks"};

SineController shifted_wave() {
  SineController wave = travelling_wave(3, 0.3, 17.5, 0.4);
  wave.shift = {0.1, -0.05, 0.0};
  return wave;
}

Policy network_policy() {
  Stream stream(1, "policy");
  Policy policy;
  policy.actor = orthogonal_network(7, {8, 6}, 3, 1.4, 1.0, stream);
  policy.critic = orthogonal_network(7, {8, 6}, 1, 1.4, 1.0, stream);
  policy.log_std = Vector::Constant(3, -0.25F);
  policy.normalizer.mean = Eigen::VectorXd::LinSpaced(7, -1.0, 1.0);
  policy.normalizer.variance = Eigen::VectorXd::Constant(7, 1.0 / 3.0);
  return policy;
}

// As trained from an inherited gait: on it, with its clock.
Policy policy_on_gait() {
  Stream stream(2, "policy");
  Policy policy = network_policy();
  policy.clock = {40.0, 17.5};
  policy.base = shifted_wave();
  policy.actor = orthogonal_network(7 + 4, {8, 6}, 3, 1.4, 1.0, stream);
  policy.critic = orthogonal_network(7 + 4, {8, 6}, 1, 1.4, 1.0, stream);
  return policy;
}

PolicyFile example(TrainedController controller) {
  PolicyFile file;
  file.robot = Robot(Body::from_rows({"HV", "VS"}));
  file.controller = std::move(controller);
  return file;
}

std::string message_reading(const std::filesystem::path& path) {
  return error_of(Failure::data, [&] { read_policy(path); });
}

}  // namespace

TEST_CASE("a JSON controller that does not fit together is refused with its place",
          "[formats][policy]") {
  const auto problem = [](const std::function<void(Json&)>& change) {
    Json document = Json::parse(policy_to_json(example(network_policy())));
    change(document);
    return error_of(Failure::data, [&] { read_controller(to_node(document, "policy")); });
  };
  CHECK_THAT(problem([](Json& d) { d["kind"] = "dream"; }),
             Catch::Contains(": /kind: unknown kind of policy 'dream'; allowed: network, sine"));
  CHECK(problem([](Json& d) { d["actor"][0]["bias"].push_back(1.0); }).find("actor: layer 0 has") !=
        std::string::npos);
  CHECK(problem([](Json& d) { d["actor"][0]["weight"][0].erase(0); }).find("/actor/0/weight/1") !=
        std::string::npos);
  CHECK(problem([](Json& d) { d["normalizer"]["mean"].push_back(1.0); }).find("normalizer: ") !=
        std::string::npos);
  CHECK(problem([](Json& d) { d.erase("action"); }) == "policy:1:1: key 'action' is missing");

  TrainingSettings settings;
  settings.hidden = {6, 5};
  Json gated = Json::parse(
      policy_to_json(example(initial_modular_policy(settings, 3, 0.6, 1.5, Stream(4, "policy")))));
  CHECK_NOTHROW(read_controller(to_node(gated, "policy")));
  gated["actor"]["gates"].erase(1);
  CHECK_THROWS_WITH(read_controller(to_node(gated, "policy")),
                    "policy:1:1: actor: 1 gates for 2 layers");
}

TEST_CASE("as JSON a policy keeps its clock, its gait and the shifts of its waves") {
  const Json network = Json::parse(policy_to_json(example(policy_on_gait())));
  CHECK(network.at("clock") == Json{40.0, 17.5});
  CHECK(network.at("gait").at("period") == 17.5);
  CHECK(network.at("gait").at("shift") == Json{0.1, -0.05, 0.0});
  const Json plain = Json::parse(policy_to_json(example(network_policy())));
  CHECK_FALSE(plain.contains("clock"));
  CHECK_FALSE(plain.contains("gait"));
  const Json wave = Json::parse(policy_to_json(example(shifted_wave())));
  CHECK(wave.at("sine").at("shift") == network.at("gait").at("shift"));
}

TEST_CASE("as JSON a sequence has a row of targets for every step") {
  const Json sequence =
      Json::parse(policy_to_json(example(ReplayController{{0.6, 1.1, 1.6, 1.0}, 2})));
  CHECK(sequence.at("kind") == "sequence");
  CHECK(sequence.at("actions") == Json{{0.6, 1.1}, {1.6, 1.0}});
}

TEST_CASE("a sequence of no actuators or of numbers in a row is refused") {
  const ScratchFolder folder;
  const auto path = folder / "a.policy.h5";
  write_policy(path, example(ReplayController{{0.6, 1.1}, 2}));
  const PolicyFile there = read_policy(path);
  CHECK(std::get<ReplayController>(there.controller).steps() == 1);
  write_policy(path, example(ReplayController{{}, 0}));
  CHECK_THAT(message_reading(path), Catch::Contains("actions: "));
}

TEST_CASE("files that are no policies are refused with file and place") {
  const ScratchFolder folder;
  const auto path = folder / "p.h5";
  const auto message_of = [&](const char* format, std::int64_t version) {
    hdf5::Writer file(path);
    file.attribute("/", "format", format);
    file.attribute("/", "version", version);
    file.commit();
    return message_reading(path);
  };
  CHECK_THAT(message_of("evo/rollout", 1),
             Catch::Contains("'evo/policy' is expected") && Catch::Contains("evo/rollout"));
  CHECK_THAT(message_of("evo/policy", 2), Catch::Contains("version 2 is newer"));
  CHECK_THAT(message_of("evo/policy", 1), Catch::Contains("p.h5") && Catch::Contains("robot"));
}

TEST_CASE("networks whose shapes do not fit are refused") {
  const ScratchFolder folder;
  Policy policy = network_policy();
  policy.actor.layers[1].bias = Vector::Zero(9);
  const auto path = folder / "a.policy.h5";
  write_policy(path, example(policy));
  CHECK_THAT(message_reading(path), Catch::Contains("actor: layer 1 has 9 biases"));
}

// Controllers that nothing has trained are no policies.
static_assert(!std::is_convertible_v<RandomController, TrainedController>);

TEST_CASE("the same training is the same file, and its policy earns its fitness again") {
  const ScratchFolder folder;
  const Robot robot(Body::from_rows({"HHH", "V.V"}));
  TrainingSettings settings;
  settings.algorithm = GENERATE(Algorithm::ppo, Algorithm::gait, Algorithm::sequence);
  settings.steps = settings.algorithm == Algorithm::ppo ? 512 : 4000;
  settings.population = 4;
  settings.evaluation_interval = 2;  // stretches of a sequence
  const Arena arena(load_task("Walker-v0", data), robot.body);
  const auto train_into = [&](const std::filesystem::path& path, bool interrupted) {
    const TrainingIdentity identity = identify(robot.body, arena.task(), settings, 3);
    const auto checkpoint = folder / "a.checkpoint.h5";
    Trainer first(arena, settings, 3, robot.id);
    write_checkpoint(checkpoint, first.checkpoint(), identity);
    Trainer second(arena, settings, 3, robot.id);
    if (interrupted) second.restore(read_checkpoint(checkpoint, identity));
    const TrainResult result = train(second);
    write_policy(path, make_policy_file(robot, arena, settings, 3, result, "test"));
  };
  train_into(folder / "a.h5", false);
  train_into(folder / "b.h5", true);
  CHECK(read_file(folder / "a.h5") == read_file(folder / "b.h5"));

  const PolicyFile file = read_policy(folder / "a.h5");
  CHECK(file.identity == identify(robot.body, arena.task(), settings, 3).lines);
  CHECK(file.settings_hash == identify(robot.body, arena.task(), settings, 3).hash());
  CHECK(file.task == "Walker-v0");
  CHECK(parse_task(file.task_yaml, "stored").name == "Walker-v0");
  CHECK(training_profiles().read(Node::yaml(file.training_yaml, "stored"), "", {}) == settings);
  CHECK(file.layout.size() == 2);
  EvaluationSettings evaluation;
  evaluation.seed = 3;
  CHECK(evaluate(arena, file.controller, evaluation).mean() == file.fitness);
}
