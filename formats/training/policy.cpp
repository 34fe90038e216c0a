#include "formats/training/policy.h"

#include <array>
#include <utility>
#include <variant>

#include "formats/foreign/learners.h"
#include "formats/io/format.h"
#include "formats/io/hdf5.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/training/training.h"
#include "libevo/base/alternatives.h"
#include "libevo/base/digest.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

Error bad(const hdf5::Reader& file, const std::string& path, const std::string& problem) {
  return error(Failure::data, "{}: {}: {}", file.name(), path, problem);
}

// ---- parts ------------------------------------------------------------------------

std::size_t size(Eigen::Index n) { return static_cast<std::size_t>(n); }

template <typename Dense>
auto values_of(const Dense& x) {
  return std::vector<typename Dense::Scalar>(x.data(), x.data() + x.size());
}

void write_network(hdf5::Writer& file, const std::string& group, const Network& network) {
  for (std::size_t l = 0; l < network.layers.size(); ++l) {
    const Layer& layer = network.layers[l];
    const std::string at = fmt::format("{}/layer_{}", group, l);
    file.array(at + "/weight", {size(layer.weight.rows()), size(layer.weight.cols())},
               values_of(layer.weight));
    file.vector(at + "/bias", values_of(layer.bias));
  }
}

// `inputs`: how many it has to have, or hdf5::any.
Layer read_layer(const hdf5::Reader& file, const std::string& group,
                 std::size_t inputs = hdf5::any) {
  const auto weight = file.array<float>(group + "/weight", {hdf5::any, inputs});
  const auto bias = file.vector<float>(group + "/bias", weight.shape[0]);
  const auto rows = static_cast<Eigen::Index>(weight.shape[0]);
  const auto cols = static_cast<Eigen::Index>(weight.shape[1]);
  return {Eigen::Map<const Matrix>(weight.values.data(), rows, cols),
          Eigen::Map<const Vector>(bias.data(), rows)};
}

Network read_network(const hdf5::Reader& file, const std::string& group, std::size_t inputs) {
  Network network;
  for (std::size_t l = 0; file.exists(fmt::format("{}/layer_{}", group, l)); ++l) {
    network.layers.push_back(read_layer(file, fmt::format("{}/layer_{}", group, l), inputs));
    inputs = size(network.layers.back().bias.size());
  }
  if (network.layers.empty()) throw bad(file, group, "no layers");
  return network;
}

// ---- controllers ------------------------------------------------------------------
//
// One Stored for every TrainedController; `kind` names it in the file.

template <typename Controller>
struct Stored;

template <>
struct Stored<Policy> {
  static constexpr const char* kind = "network";
  static void write(hdf5::Writer& file, const Policy& policy);
  static Policy read(const hdf5::Reader& file);
};

template <>
struct Stored<SineController> {
  static constexpr const char* kind = "sine";
  static void write(hdf5::Writer& file, const SineController& sine);
  static SineController read(const hdf5::Reader& file);
};

template <>
struct Stored<ReplayController> {
  static constexpr const char* kind = "sequence";
  static void write(hdf5::Writer& file, const ReplayController& sequence);
  static ReplayController read(const hdf5::Reader& file);
};

template <>
struct Stored<ModularPolicy> {
  static constexpr const char* kind = "modular";
  static void write(hdf5::Writer& file, const ModularPolicy& policy);
  static ModularPolicy read(const hdf5::Reader& file);
};

// Shifts are written where there are any: waves without are as ever.
void write_sine(hdf5::Writer& file, const std::string& group, const SineController& sine) {
  file.vector(group + "/amplitude", sine.amplitude);
  file.vector(group + "/phase", sine.phase);
  if (!sine.shift.empty()) file.vector(group + "/shift", sine.shift);
  file.attribute(group, "period", sine.period);
  file.attribute(group, "middle", sine.middle);
}

SineController read_sine(const hdf5::Reader& file, const std::string& group) {
  SineController sine;
  sine.amplitude = file.vector<double>(group + "/amplitude");
  sine.phase = file.vector<double>(group + "/phase", sine.amplitude.size());
  if (file.exists(group + "/shift"))
    sine.shift = file.vector<double>(group + "/shift", sine.amplitude.size());
  sine.period = file.number<double>(group, "period");
  sine.middle = file.number<double>(group, "middle");
  return sine;
}

void write_sequence(hdf5::Writer& file, const std::string& path, const ReplayController& sequence) {
  file.array(
      path,
      {static_cast<std::size_t>(sequence.steps()), static_cast<std::size_t>(sequence.actuators)},
      sequence.actions);
}

ReplayController read_sequence(const hdf5::Reader& file, const std::string& path) {
  auto actions = file.array<double>(path, {hdf5::any, hdf5::any});
  if (actions.values.empty()) throw bad(file, path, "it is empty");
  return {std::move(actions.values), static_cast<int>(actions.shape[1])};
}

void write_base(hdf5::Writer& file, const SineController& gait) { write_sine(file, "/gait", gait); }
void write_base(hdf5::Writer& file, const ReplayController& sequence) {
  write_sequence(file, "/sequence", sequence);
}

std::optional<OpenLoop> read_base(const hdf5::Reader& file) {
  if (file.exists("/gait")) return read_sine(file, "/gait");
  if (file.exists("/sequence")) return read_sequence(file, "/sequence");
  return std::nullopt;
}

void write_normalizer(hdf5::Writer& file, const std::string& group, const Normalizer& normalizer) {
  file.vector(group + "/mean", values_of(normalizer.mean));
  file.vector(group + "/var", values_of(normalizer.variance));
  file.attribute(group, "count", normalizer.count);
  file.attribute(group, "clip", normalizer.clip);
  file.attribute(group, "epsilon", normalizer.epsilon);
}

Normalizer read_normalizer(const hdf5::Reader& file, const std::string& group) {
  Normalizer normalizer;
  const auto mean = file.vector<double>(group + "/mean");
  const auto variance = file.vector<double>(group + "/var", mean.size());
  const auto length = static_cast<Eigen::Index>(mean.size());
  normalizer.mean = Eigen::Map<const Eigen::VectorXd>(mean.data(), length);
  normalizer.variance = Eigen::Map<const Eigen::VectorXd>(variance.data(), length);
  normalizer.count = file.number<double>(group, "count");
  normalizer.clip = file.number<double>(group, "clip");
  normalizer.epsilon = file.number<double>(group, "epsilon");
  return normalizer;
}

// Of a policy of either kind of network.
template <typename AnyPolicy>
void write_action(hdf5::Writer& file, const AnyPolicy& policy) {
  file.attribute("/", "action_map", word(policy.action_map));
  file.attribute("/", "action_offset", policy.action_offset);
  file.attribute("/", "action_bounds", std::vector<double>{policy.low, policy.high});
}

template <typename AnyPolicy>
void read_action(const hdf5::Reader& file, AnyPolicy& policy) {
  const std::string map = file.text("/", "action_map");
  const auto known_map = from_word<ActionMap>(map);
  if (!known_map)
    throw bad(file, "/@action_map", unknown_name("action map", map, words_of<ActionMap>()));
  policy.action_map = *known_map;
  policy.action_offset = file.number<double>("/", "action_offset");
  const auto bounds = file.numbers<double>("/", "action_bounds");
  if (bounds.size() != 2 || !(bounds[0] <= bounds[1]))
    throw bad(file, "/@action_bounds", "two numbers, the lower one first, are expected");
  policy.low = bounds[0];
  policy.high = bounds[1];
}

void Stored<Policy>::write(hdf5::Writer& file, const Policy& policy) {
  write_network(file, "/actor", policy.actor);
  write_network(file, "/critic", policy.critic);
  file.vector("/log_std", values_of(policy.log_std));
  write_normalizer(file, "/normalizer", policy.normalizer);
  write_action(file, policy);
  if (!policy.clock.empty()) file.vector("/clock", policy.clock);
  if (policy.base) std::visit([&](const auto& base) { write_base(file, base); }, *policy.base);
}

Policy Stored<Policy>::read(const hdf5::Reader& file) {
  Policy policy;
  policy.normalizer = read_normalizer(file, "/normalizer");
  if (file.exists("/clock")) policy.clock = file.vector<double>("/clock");
  policy.base = read_base(file);
  const std::size_t inputs = size(policy.normalizer.mean.size()) + 2 * policy.clock.size();
  policy.actor = read_network(file, "/actor", inputs);
  policy.critic = read_network(file, "/critic", inputs);
  const std::size_t actions = size(policy.actor.layers.back().bias.size());
  const auto log_std = file.vector<float>("/log_std", actions);
  if (policy.critic.layers.back().bias.size() != 1)
    throw bad(file, "/critic", "its last layer has more than one output");
  policy.log_std =
      Eigen::Map<const Vector>(log_std.data(), static_cast<Eigen::Index>(log_std.size()));
  read_action(file, policy);
  return policy;
}

void write_modular_network(hdf5::Writer& file, const std::string& group,
                           const ModularNetwork& network) {
  const auto write = [&](const char* name, const Matrix& weight) {
    file.array(group + "/first/" + name, {size(weight.rows()), size(weight.cols())},
               values_of(weight));
  };
  write("local", network.local);
  write("task", network.task);
  write("fixed", network.fixed);
  file.vector(group + "/first/bias", values_of(network.bias));
  write_network(file, group + "/rest", network.rest);
  for (std::size_t l = 0; l < network.gates.size(); ++l)
    for (const auto& [name, weight] :
         {std::pair{"scale", &network.gates[l].scale}, std::pair{"shift", &network.gates[l].shift}})
      if (weight->size() > 0)
        file.array(fmt::format("{}/gates/layer_{}/{}", group, l, name),
                   {size(weight->rows()), size(weight->cols())}, values_of(*weight));
}

ModularNetwork read_modular_network(const hdf5::Reader& file, const std::string& group,
                                    std::size_t task_inputs) {
  ModularNetwork network;
  const auto bias = file.vector<float>(group + "/first/bias");
  network.bias = Eigen::Map<const Vector>(bias.data(), static_cast<Eigen::Index>(bias.size()));
  const auto read = [&](const char* name, std::size_t inputs) {
    const auto weight = file.array<float>(group + "/first/" + name, {bias.size(), inputs});
    return Matrix(Eigen::Map<const Matrix>(weight.values.data(), network.bias.size(),
                                           static_cast<Eigen::Index>(inputs)));
  };
  network.local = read("local", VoxelViews::local_length);
  network.task = read("task", task_inputs);
  network.fixed = read("fixed", VoxelViews::fixed_length);
  for (std::size_t l = 0; file.exists(fmt::format("{}/rest/layer_{}", group, l)); ++l)
    network.rest.layers.push_back(read_layer(file, fmt::format("{}/rest/layer_{}", group, l)));
  for (std::size_t l = 0;; ++l) {
    const std::string gate = fmt::format("{}/gates/layer_{}", group, l);
    if (!file.exists(gate) || l > network.rest.layers.size()) return network;
    const std::size_t units = l == 0 ? bias.size() : size(network.rest.layers[l - 1].bias.size());
    const auto part = [&](const char* name) {
      const auto weight =
          file.array<float>(gate + "/" + name, {units, size(VoxelViews::fixed_length)});
      return Matrix(Eigen::Map<const Matrix>(weight.values.data(), static_cast<Eigen::Index>(units),
                                             VoxelViews::fixed_length));
    };
    network.gates.push_back({part("scale"), l == 0 ? Matrix() : part("shift")});
  }
}

void Stored<ModularPolicy>::write(hdf5::Writer& file, const ModularPolicy& policy) {
  write_modular_network(file, "/actor", policy.actor);
  write_modular_network(file, "/critic", policy.critic);
  file.vector("/log_std", values_of(policy.log_std));
  write_normalizer(file, "/normalizer/local", policy.local);
  write_normalizer(file, "/normalizer/task", policy.task);
  write_action(file, policy);
  if (!policy.clock.empty()) file.vector("/clock", policy.clock);
}

ModularPolicy Stored<ModularPolicy>::read(const hdf5::Reader& file) {
  ModularPolicy policy;
  policy.local = read_normalizer(file, "/normalizer/local");
  policy.task = read_normalizer(file, "/normalizer/task");
  if (policy.local.mean.size() != VoxelViews::local_length)
    throw bad(file, "/normalizer/local/mean", "it is not as long as a voxel's view");
  if (file.exists("/clock")) policy.clock = file.vector<double>("/clock");
  const std::size_t inputs = size(policy.task.mean.size()) + 2 * policy.clock.size();
  policy.actor = read_modular_network(file, "/actor", inputs);
  policy.critic = read_modular_network(file, "/critic", inputs);
  const auto log_std = file.vector<float>("/log_std", 1);
  policy.log_std = Vector::Constant(1, log_std.front());
  read_action(file, policy);
  if (const auto problem = defect(policy)) throw bad(file, "/", *problem);
  return policy;
}

void Stored<SineController>::write(hdf5::Writer& file, const SineController& sine) {
  write_sine(file, "/sine", sine);
}

SineController Stored<SineController>::read(const hdf5::Reader& file) {
  return read_sine(file, "/sine");
}

void Stored<ReplayController>::write(hdf5::Writer& file, const ReplayController& sequence) {
  write_sequence(file, "/actions", sequence);
}

ReplayController Stored<ReplayController>::read(const hdf5::Reader& file) {
  return read_sequence(file, "/actions");
}

void write_controller(hdf5::Writer& file, const TrainedController& controller) {
  std::visit(
      [&]<typename T>(const T& c) {
        file.attribute("/", "kind", Stored<T>::kind);
        Stored<T>::write(file, c);
      },
      controller);
}

TrainedController read_controller(const hdf5::Reader& file) {
  const std::string kind = file.text("/", "kind");
  std::optional<TrainedController> controller;
  std::vector<std::string> kinds;
  for_each_alternative<TrainedController>([&]<typename T>(std::type_identity<T>) {
    kinds.emplace_back(Stored<T>::kind);
    if (kind == Stored<T>::kind) controller = Stored<T>::read(file);
  });
  if (!controller) throw bad(file, "/@kind", unknown_name("kind of policy", kind, kinds));
  return std::move(*controller);
}

void write_curve(hdf5::Writer& file, const std::vector<CurvePoint>& curve) {
  std::vector<std::int64_t> step;
  std::vector<double> evaluation;
  std::vector<double> best;
  for (const CurvePoint& point : curve) {
    step.push_back(point.step);
    evaluation.push_back(point.evaluation);
    best.push_back(point.best);
  }
  file.vector("/curve/step", step);
  file.vector("/curve/evaluation", evaluation);
  file.vector("/curve/best", best);
}

std::vector<CurvePoint> read_curve(const hdf5::Reader& file) {
  const auto step = file.vector<std::int64_t>("/curve/step");
  const auto evaluation = file.vector<double>("/curve/evaluation", step.size());
  const auto best = file.vector<double>("/curve/best", step.size());
  std::vector<CurvePoint> curve;
  for (std::size_t i = 0; i < step.size(); ++i) curve.push_back({step[i], evaluation[i], best[i]});
  return curve;
}

std::string layout_to_json(const std::vector<ObservationSlice>& layout) {
  Json list = Json::array();
  for (const ObservationSlice& slice : layout)
    list.push_back({{"name", slice.name}, {"offset", slice.offset}, {"length", slice.length}});
  return list.dump();
}

std::vector<ObservationSlice> layout_from_json(const hdf5::Reader& file) {
  std::vector<ObservationSlice> layout;
  try {
    for (const Json& slice : Json::parse(file.text("/", "observation_layout")))
      layout.push_back({slice.at("name").get<std::string>(), slice.at("offset").get<int>(),
                        slice.at("length").get<int>()});
  } catch (const Json::exception&) {
    throw bad(file, "/@observation_layout", "a list of name, offset and length is expected");
  }
  return layout;
}

Robot read_robot(const hdf5::Reader& file) {
  const std::string where = file.name() + ": /@robot";
  std::vector<Robot> robots = parse_robots(file.text("/", "robot"), where);
  if (robots.size() != 1) throw bad(file, "/@robot", "one robot is expected");
  return std::move(robots.front());
}

std::vector<std::string> lines_of(const std::vector<Robot>& robots) {
  std::vector<std::string> lines;
  for (const Robot& robot : robots) lines.push_back(robot_to_line(robot));
  return lines;
}

std::vector<Robot> read_list_of_robots(const hdf5::Reader& file) {
  std::vector<Robot> robots;
  for (const std::string& line : file.strings("/robots"))
    for (Robot& robot : parse_robots(line, file.name() + ": /robots"))
      robots.push_back(std::move(robot));
  return robots;
}

}  // namespace

// ---- policies -----------------------------------------------------------------------

PolicyFile make_policy_file(const Robot& robot, const Arena& arena,
                            const TrainingSettings& settings, std::uint64_t seed,
                            const TrainResult& result, const std::string& created_by,
                            const TrainingOrigin& origin) {
  PolicyFile file;
  file.robot = robot;
  file.task = arena.task().name;
  file.task_yaml = task_to_yaml(arena.task());
  file.physics_yaml = physics_to_yaml(arena.task().physics);
  file.training_yaml = training_to_yaml(settings);
  file.layout = arena.layout();
  file.seed = seed;
  file.created_by = created_by;
  const TrainingIdentity training = identify(arena.robot(), arena.task(), settings, seed, origin);
  file.identity = training.lines;
  file.settings_hash = training.hash();
  file.controller = result.controller.value();
  file.fitness = result.fitness.value();
  file.best_step = result.best_step;
  file.steps = result.steps;
  file.curve = result.curve;
  file.final_score = result.final_score;
  return file;
}

void write_policy(const std::filesystem::path& path, const PolicyFile& policy, Existing existing) {
  hdf5::Writer file(path);
  file.attribute("/", "format", format::policy.name);
  file.attribute("/", "version", std::int64_t{format::policy.version});
  file.attribute("/", "robot", robot_to_line(policy.robot));
  file.attribute("/", "task", policy.task);
  file.attribute("/", "task_yaml", policy.task_yaml);
  file.attribute("/", "physics_yaml", policy.physics_yaml);
  file.attribute("/", "training_yaml", policy.training_yaml);
  file.attribute("/", "observation_layout", layout_to_json(policy.layout));
  file.attribute("/", "seed", policy.seed);
  file.attribute("/", "isa", policy.isa);
  file.attribute("/", "created_by", policy.created_by);
  file.attribute("/", "identity", policy.identity);
  file.attribute("/", "settings_hash", policy.settings_hash);
  file.attribute("/", "fitness", policy.fitness);
  file.attribute("/", "best_step", policy.best_step);
  file.attribute("/", "steps", policy.steps);
  write_controller(file, policy.controller);
  write_curve(file, policy.curve);
  if (!policy.robots.empty()) file.strings("/robots", lines_of(policy.robots));
  if (policy.final_score) {
    file.attribute("/", "final_episodes", std::int64_t{policy.final_score->episodes});
    file.attribute("/", "final_mean", policy.final_score->mean);
    file.attribute("/", "final_standard_error", policy.final_score->standard_error);
  }
  file.commit(existing);
}

PolicyFile read_policy(const std::filesystem::path& path) {
  if (!hdf5::is_hdf5(path)) refuse_learner_file(path);
  const hdf5::Reader file(path);
  check_format(file, format::policy, Head::required);
  PolicyFile policy;
  policy.robot = read_robot(file);
  policy.task = file.text("/", "task");
  policy.task_yaml = file.text("/", "task_yaml");
  policy.physics_yaml = file.text("/", "physics_yaml");
  policy.training_yaml = file.text("/", "training_yaml");
  policy.layout = layout_from_json(file);
  policy.seed = file.number<std::uint64_t>("/", "seed");
  policy.isa = file.text("/", "isa");
  policy.created_by = file.text("/", "created_by");
  policy.identity = file.text("/", "identity");
  policy.settings_hash = file.text("/", "settings_hash");
  policy.fitness = file.number<double>("/", "fitness");
  policy.best_step = file.number<std::int64_t>("/", "best_step");
  policy.steps = file.number<std::int64_t>("/", "steps");
  policy.controller = read_controller(file);
  policy.curve = read_curve(file);
  if (file.exists("/robots")) policy.robots = read_list_of_robots(file);
  if (file.has_attribute("/", "final_episodes"))
    policy.final_score = FinalScore{file.number<std::int32_t>("/", "final_episodes"),
                                    file.number<double>("/", "final_mean"),
                                    file.number<double>("/", "final_standard_error")};
  return policy;
}

TaskSpec policy_task(const PolicyFile& policy, const std::string& where) {
  if (policy.task_yaml.empty())
    throw error(Failure::data,
                "{}: the policy is of a program's own task, which no tool knows; that program "
                "can evaluate it",
                where);
  return parse_task(policy.task_yaml, where + ": task");
}

std::string read_policy_identity(const std::filesystem::path& path) {
  const hdf5::Reader file(path);
  check_format(file, format::policy, Head::required);
  return file.text("/", "identity");
}

// ---- checkpoints ----------------------------------------------------------------------

namespace {

// How the index of a checkpoint names the types of its arrays, in the order of
// Checkpoint::Array.
constexpr std::array<const char*, 4> array_types{"float64", "float32", "uint64", "uint8"};

Checkpoint::Array read_array(const hdf5::Reader& file, const std::string& type,
                             const std::string& path) {
  if (type == array_types[0]) return file.vector<double>(path);
  if (type == array_types[1]) return file.vector<float>(path);
  if (type == array_types[2]) return file.vector<std::uint64_t>(path);
  if (type == array_types[3]) return file.vector<std::uint8_t>(path);
  throw bad(file, "/index", fmt::format("unknown type '{}'", type));
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint,
                      const TrainingIdentity& training) {
  hdf5::Writer file(path);
  file.attribute("/", "format", format::checkpoint.name);
  file.attribute("/", "version", std::int64_t{format::checkpoint.version});
  file.attribute("/", "identity", training.lines);
  file.attribute("/", "settings_hash", training.hash());
  std::vector<std::string> index;
  for (const auto& [name, array] : checkpoint.arrays) {
    index.push_back(std::string(array_types[array.index()]) + " " + name);
    std::visit([&, &at = name](const auto& values) { file.vector("/arrays/" + at, values); },
               array);
  }
  file.strings("/index", index);
  file.commit();
}

std::string read_checkpoint_identity(const std::filesystem::path& path) {
  const hdf5::Reader file(path);
  check_format(file, format::checkpoint, Head::required);
  return file.text("/", "identity");
}

Checkpoint read_checkpoint(const std::filesystem::path& path, const TrainingIdentity& training) {
  const hdf5::Reader file(path);
  check_format(file, format::checkpoint, Head::required);
  const std::string there = file.text("/", "identity");
  if (there != training.lines)
    throw error(Failure::cannot_create,
                "{}: belongs to a training with other settings ({}); remove it to start afresh",
                file.name(), difference(there, training.lines));
  Checkpoint checkpoint;
  for (const std::string& line : file.strings("/index")) {
    const std::size_t space = line.find(' ');
    if (space == std::string::npos) throw bad(file, "/index", "a type and a name are expected");
    const std::string name = line.substr(space + 1);
    checkpoint.arrays[name] = read_array(file, line.substr(0, space), "/arrays/" + name);
  }
  return checkpoint;
}

}  // namespace evo
