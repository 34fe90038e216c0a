// Random values of the formats that hold numbers by the thousand, written and read
// again: what comes back is what was written, to the last bit. (Robots, worlds, genomes
// and settings of runs have theirs beside their other tests.)
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "formats/io/files.h"
#include "formats/rollout/rollout.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/training/controller_json.h"
#include "formats/training/policy.h"
#include "formats/training/policy_json.h"
#include "formats/training/training.h"
#include "libevo/body/operators.h"
#include "libevo/control/modular_passes.h"
#include "tests/unit/expect.h"

using namespace evo;
using namespace evo::test;

namespace {

const DataFolders data{"tasks"};

// ---- random parts -----------------------------------------------------------------------

// A number of every size that a double has, and now and then one that is easily lost.
double any_number(Stream& stream) {
  using Limits = std::numeric_limits<double>;
  switch (stream.below(12)) {
    case 0:
      return -0.0;
    case 1:
      return stream.below(2) == 0 ? Limits::denorm_min() : Limits::max();
    case 2:
      return 0.1 + 0.2;
    default:
      return std::ldexp(stream.gaussian(), stream.integer(-60, 60));
  }
}

std::uint64_t any_bits(Stream& stream) {
  return std::uint64_t{stream.bits()} << 32U | stream.bits();
}

std::vector<double> numbers(Stream& stream, int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(any_number(stream));
  return values;
}

// Text as people and programs leave it in documents.
std::string any_text(Stream& stream) {
  static const std::vector<std::string> pieces{"a",  "größer", "\n",    "\t", "'",      "\"", "\\",
                                               "# ", ": ",     "---\n", "{",  "\u2028", "%",  " "};
  std::string text;
  for (std::uint32_t n = stream.below(8); n > 0; --n)
    text += pieces[stream.below(static_cast<std::uint32_t>(pieces.size()))];
  return text;
}

Robot any_robot(Stream& stream) {
  Robot robot(sample_body(stream.integer(1, 5), stream.integer(1, 5), default_weights, stream));
  if (stream.below(2) == 0) robot.document["note"] = any_text(stream);
  if (stream.below(2) == 0) robot.document["fitness"] = stream.gaussian();
  return robot;
}

SineController any_wave(Stream& stream, int actuators) {
  SineController wave{numbers(stream, actuators), numbers(stream, actuators),
                      8.0 + stream.uniform(), stream.gaussian()};
  if (stream.below(2) == 0) wave.shift = numbers(stream, actuators);
  return wave;
}

Policy any_policy(Stream& stream) {
  const int observed = stream.integer(1, 9);
  const int actuators = stream.integer(1, 5);
  std::vector<int> hidden;
  for (std::uint32_t layers = stream.below(4); layers > 0; --layers)
    hidden.push_back(stream.integer(1, 7));
  Policy policy;
  for (std::uint32_t periods = stream.below(3); periods > 0; --periods)
    policy.clock.push_back(4.0 + stream.uniform());
  const int inputs = observed + 2 * static_cast<int>(policy.clock.size());
  policy.actor = orthogonal_network(inputs, hidden, actuators, 1.4, 0.01, stream);
  policy.critic = orthogonal_network(inputs, hidden, 1, 1.4, 1.0, stream);
  policy.log_std = Vector::Constant(actuators, static_cast<float>(stream.gaussian()));
  policy.normalizer.mean = Eigen::VectorXd::Constant(observed, stream.gaussian());
  policy.normalizer.variance = Eigen::VectorXd::Constant(observed, stream.uniform());
  policy.normalizer.count = static_cast<double>(stream.bits());
  policy.normalizer.clip = 1.0 + stream.uniform();
  if (stream.below(2) == 0) {
    policy.action_map = ActionMap::squash;
  } else if (stream.below(2) == 0) {
    policy.base = any_wave(stream, actuators);
  } else if (stream.below(2) == 0) {
    policy.base = ReplayController{numbers(stream, actuators * stream.integer(1, 4)), actuators};
  }
  policy.action_offset = stream.gaussian();
  policy.low = 0.5 + 0.4 * stream.uniform();
  policy.high = 1.1 + stream.uniform();
  return policy;
}

ModularPolicy any_modular_policy(Stream& stream) {
  TrainingSettings settings;
  settings.hidden = {6, 5};
  settings.clock = {20};
  ModularPolicy policy = initial_modular_policy(settings, 3, 0.6, 1.5, stream);
  policy.local.mean.setLinSpaced(-1.0, stream.gaussian());
  policy.task.count = 77.25;
  for (Gate& gate : policy.actor.gates) {
    gate.scale.setConstant(0.25F);
    gate.shift.setConstant(-0.75F);
  }
  return policy;
}

TrainedController any_controller(Stream& stream) {
  switch (stream.below(5)) {
    case 0:
      return any_wave(stream, stream.integer(1, 6));
    case 1:
      return ReplayController{numbers(stream, 3 * stream.integer(1, 9)), 3};
    case 2:
      return any_modular_policy(stream);
    default:
      return any_policy(stream);
  }
}

PolicyFile any_policy_file(Stream& stream) {
  PolicyFile file;
  file.robot = any_robot(stream);
  file.task = "task " + any_text(stream);
  file.task_yaml = any_text(stream);
  file.physics_yaml = any_text(stream);
  file.training_yaml = any_text(stream);
  file.seed = any_bits(stream);
  file.created_by = any_text(stream);
  file.identity = "evo-training 2\nseed=" + std::to_string(file.seed) + "\n";
  file.settings_hash = std::string(64, 'b');
  const int parts = stream.integer(1, 4);
  for (int i = 0, at = 0; i < parts; ++i) {
    const int length = stream.integer(1, 9);
    file.layout.push_back({"part " + any_text(stream), at, length});
    at += length;
  }
  file.controller = any_controller(stream);
  if (stream.below(3) == 0) file.robots = {file.robot, any_robot(stream)};
  file.fitness = any_number(stream);
  file.steps = static_cast<std::int64_t>(any_bits(stream) >> 1U);
  file.best_step = file.steps / 2;
  for (std::uint32_t points = stream.below(20); points > 0; --points)
    file.curve.push_back({static_cast<std::int64_t>(any_bits(stream) >> 1U), any_number(stream),
                          any_number(stream)});
  if (stream.below(2) == 0)
    file.final_score = FinalScore{stream.integer(1, 100), any_number(stream), stream.uniform()};
  return file;
}

RolloutEpisode any_episode(Stream& stream, const Rollout& rollout) {
  const int steps = stream.integer(0, 12);
  RolloutEpisode episode;
  episode.seed = any_bits(stream);
  if (stream.below(2) == 0) episode.random_draws = {{"ox", stream.integer(-9, 9)}};
  if (stream.below(2) == 0) {
    episode.jitter = stream.uniform();
    episode.jitter_seed = any_bits(stream);
  }
  episode.observations = numbers(stream, (steps + 1) * rollout.observation_length);
  episode.actions = numbers(stream, steps * rollout.action_length);
  episode.rewards = numbers(stream, steps);
  for (int t = 0; t < steps; ++t) {
    episode.terminations.push_back(static_cast<std::uint8_t>(stream.below(2)));
    episode.truncations.push_back(static_cast<std::uint8_t>(stream.below(2)));
  }
  for (int i = 0; i < (steps + 1) * rollout.points; ++i)
    episode.positions.push_back({any_number(stream), any_number(stream)});
  return episode;
}

Rollout any_rollout(Stream& stream) {
  Rollout rollout;
  rollout.task = any_text(stream);
  rollout.task_yaml = any_text(stream);
  rollout.physics_yaml = any_text(stream);
  if (stream.below(2) == 0) rollout.robot = any_robot(stream);
  rollout.seed = any_bits(stream);
  rollout.created_by = any_text(stream);
  rollout.observation_length = stream.integer(1, 6);
  rollout.action_length = stream.integer(1, 4);
  for (int object = 0, objects = stream.integer(1, 4); object < objects; ++object) {
    const int cells = stream.integer(1, 3);
    const int points = 4 * cells;
    rollout.world.objects.push_back({"object " + any_text(stream), rollout.points, points,
                                     static_cast<int>(rollout.world.cells.size()), cells, false});
    for (int cell = 0; cell < cells; ++cell) {
      const int first = rollout.points + 4 * cell;
      rollout.world.cells.push_back(
          {object, Voxel::soft, {first, first + 1, first + 2, first + 3}});
    }
    rollout.points += points;
  }
  for (int k = 0, episodes = stream.integer(1, 12); k < episodes; ++k)
    rollout.episodes.push_back(any_episode(stream, rollout));
  return rollout;
}

// A random value for every setting that takes one: what is refused stays.
template <typename Settings>
Settings any_settings(const Profiles<Settings>& profiles, Stream& stream) {
  Settings settings;
  for (const SettingRow& row : profiles.rows(settings)) {
    const double value =
        stream.below(2) == 0 ? std::abs(any_number(stream)) : stream.integer(1, 1000);
    try {
      Settings changed = settings;
      profiles.assign(changed, fmt::format("{}={}", row.key, value));
      profiles.check(changed);
      settings = changed;
    } catch (const Error&) {
      continue;
    }
  }
  return settings;
}

// ---- the same, to the last bit ----------------------------------------------------------

// As ==, but for zeros, which have a sign.
bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

// Whatever a value holds is in its file: the same bytes are the same value, as the
// tests of each format see to field by field.
template <typename Write, typename Read, typename Value>
Value through_file(const ScratchFolder& folder, const Value& value, const Write& write,
                   const Read& read) {
  write(folder / "once", value);
  Value back = read(folder / "once");
  write(folder / "twice", back);
  REQUIRE(read_file(folder / "twice") == read_file(folder / "once"));
  return back;
}

}  // namespace

TEST_CASE("random policies come back to the last bit") {
  const ScratchFolder folder;
  for (std::uint64_t i = 0; i < 60; ++i) {
    Stream stream(1, "test/policies", i);
    const PolicyFile file = any_policy_file(stream);
    INFO("policy " << i);
    const PolicyFile back = through_file(
        folder, file, [](const auto& path, const PolicyFile& f) { write_policy(path, f); },
        read_policy);
    REQUIRE(back.controller == file.controller);
    REQUIRE(read_controller(Node::json(policy_to_json(file), "policy")) == file.controller);
    REQUIRE(robot_to_line(back.robot) == robot_to_line(file.robot));
    REQUIRE(back.task_yaml == file.task_yaml);
    REQUIRE(back.seed == file.seed);
    REQUIRE(same({back.fitness}, {file.fitness}));
    REQUIRE(back.steps == file.steps);
    REQUIRE(back.curve == file.curve);
    REQUIRE(back.final_score == file.final_score);
    REQUIRE(back.robots.size() == file.robots.size());
    REQUIRE(read_policy_identity(folder / "once") == file.identity);
  }
}

TEST_CASE("random checkpoints come back to the last bit") {
  const ScratchFolder folder;
  const TrainingIdentity identity{"evo-training 2\nseed=1\n"};
  for (std::uint64_t i = 0; i < 60; ++i) {
    Stream stream(2, "test/checkpoints", i);
    Checkpoint checkpoint;
    if (i % 2 == 0) checkpoint.best = any_controller(stream);
    const auto length = [&] { return stream.below(50); };
    for (std::uint32_t part = 1 + stream.below(3); part > 0; --part) {
      const std::string name = "part_" + std::to_string(part) + "/";
      checkpoint.put(name + "doubles", numbers(stream, static_cast<int>(length())));
      std::vector<float> floats;
      for (std::uint32_t n = length(); n > 0; --n)
        floats.push_back(
            std::ldexp(static_cast<float>(stream.gaussian()), stream.integer(-99, 99)));
      checkpoint.put(name + "floats", floats);
      std::vector<std::uint64_t> counts;
      for (std::uint32_t n = length(); n > 0; --n) counts.push_back(any_bits(stream));
      checkpoint.put(name + "counts", counts);
      std::vector<std::uint8_t> bytes;
      for (std::uint32_t n = length(); n > 0; --n)
        bytes.push_back(static_cast<std::uint8_t>(stream.below(256)));
      checkpoint.put(name + "bytes", bytes);
      Archive::saving(checkpoint).stream(name + "stream", stream);
    }
    INFO("checkpoint " << i);
    REQUIRE(through_file(
                folder, checkpoint,
                [&](const auto& path, const Checkpoint& c) { write_checkpoint(path, c, identity); },
                [&](const auto& path) { return read_checkpoint(path, identity); }) == checkpoint);
  }
  const TrainingIdentity other{"evo-training 2\nseed=2\n"};
  CHECK_THROWS_WITH(read_checkpoint(folder / "once", other),
                    Catch::Contains("other settings (seed: 1 there, 2 asked for)"));
}

TEST_CASE("random rollouts come back to the last bit") {
  const ScratchFolder folder;
  for (std::uint64_t i = 0; i < 60; ++i) {
    Stream stream(3, "test/rollouts", i);
    const Rollout rollout = any_rollout(stream);
    INFO("rollout " << i);
    const Rollout back = through_file(folder, rollout, write_rollout, read_rollout);
    REQUIRE(back.task_yaml == rollout.task_yaml);
    REQUIRE(back.seed == rollout.seed);
    REQUIRE(back.points == rollout.points);
    REQUIRE(back.world.objects.size() == rollout.world.objects.size());
    REQUIRE(back.world.objects.back().name == rollout.world.objects.back().name);
    REQUIRE(back.robot.has_value() == rollout.robot.has_value());
    if (rollout.robot) REQUIRE(robot_to_line(*back.robot) == robot_to_line(*rollout.robot));
    REQUIRE(back.episodes.size() == rollout.episodes.size());
    for (std::size_t k = 0; k < rollout.episodes.size(); ++k) {
      const RolloutEpisode& a = back.episodes[k];
      const RolloutEpisode& b = rollout.episodes[k];
      REQUIRE(a.seed == b.seed);
      REQUIRE(a.random_draws == b.random_draws);
      REQUIRE(a.jitter == b.jitter);
      REQUIRE(a.jitter_seed == b.jitter_seed);
      REQUIRE(same(a.observations, b.observations));
      REQUIRE(same(a.actions, b.actions));
      REQUIRE(same(a.rewards, b.rewards));
      REQUIRE(a.terminations == b.terminations);
      REQUIRE(a.truncations == b.truncations);
    }
  }
}

TEST_CASE("random profiles come back to the last bit") {
  for (std::uint64_t i = 0; i < 200; ++i) {
    Stream stream(5, "test/profiles", i);
    const Physics physics = any_settings(physics_profiles(), stream);
    const std::string physics_text = physics_profiles().to_yaml(physics);
    INFO(physics_text);
    REQUIRE_FALSE(physics == Physics{});
    REQUIRE(physics_profiles().read(Node::yaml(physics_text, "p.yaml"), "", data) == physics);
    const TrainingSettings training = any_settings(training_profiles(), stream);
    const std::string training_text = training_profiles().to_yaml(training);
    INFO(training_text);
    REQUIRE_FALSE(training == TrainingSettings{});
    REQUIRE(training_profiles().read(Node::yaml(training_text, "t.yaml"), "", data) == training);
  }
}

// Tasks are put together from the parts of tasks that exist.
TEST_CASE("random tasks come back as they were") {
  const std::vector<std::string> names = task_names(data);
  for (std::uint64_t i = 0; i < 100; ++i) {
    Stream stream(6, "test/tasks", i);
    TaskSpec task = load_task(names[stream.below(static_cast<std::uint32_t>(names.size()))], data);
    task.name = "Task-v" + std::to_string(i);
    task.description = any_text(stream);
    task.notes = {"one " + any_text(stream), "two " + any_text(stream)};
    task.episode_steps = stream.integer(1, 5000);
    task.folding_reward = stream.gaussian();
    if (stream.below(2) == 0) task.observation.push_back(task.observation.front());
    for (RewardTerm& term : task.reward) term.weight = std::ldexp(stream.gaussian(), 10);
    task.physics = any_settings(physics_profiles(), stream);
    const std::string text = task_to_yaml(task);
    INFO(text);
    const TaskSpec back = parse_task(text, "t.yaml", "", data);
    REQUIRE(task_to_yaml(back) == text);
    REQUIRE(back.physics == task.physics);
    REQUIRE(back.episode_steps == task.episode_steps);
    REQUIRE(back.objects.size() == task.objects.size());
    for (std::size_t k = 0; k < task.objects.size(); ++k)
      REQUIRE(back.objects[k].object.body == task.objects[k].object.body);
  }
}
