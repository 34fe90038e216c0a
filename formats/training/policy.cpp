#include "formats/training/policy.h"

#include <array>
#include <utility>
#include <variant>

#include "formats/io/format.h"
#include "formats/io/hdf5.h"
#include "formats/io/learners.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/training/controller_fields.h"
#include "formats/training/policy_json.h"
#include "formats/training/training.h"
#include "libevo/base/alternatives.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

Error bad(const hdf5::Reader& file, const std::string& path, const std::string& problem) {
  return error(Failure::data, "{}: {}: {}", file.name(), path, problem);
}

// ---- controllers ------------------------------------------------------------------

template <typename Dense>
auto values_of(const Dense& x) {
  return std::vector<typename Dense::Scalar>(x.data(), x.data() + x.size());
}

// Where the fields of a controller stand (controller_fields.h): numbers and words are attributes
// of a group, everything else is a dataset in it.
struct Place {
  std::string group;   // "" is the file's own
  std::string prefix;  // of attributes

  std::string owner() const { return group.empty() ? "/" : group; }
  std::string attribute(const char* name) const { return prefix + name; }
  std::string dataset(const char* name) const { return fmt::format("{}/{}", group, name); }
  Place part(const std::string& name) const { return {fmt::format("{}/{}", group, name), ""}; }
  Place layer(const char* name, std::size_t l) const {
    return part(fmt::format("{}/layer_{}", name, l));
  }
  Place choices(const char* name) const { return {group, fmt::format("{}_", name)}; }
};

class FieldWriter {
 public:
  FieldWriter(hdf5::Writer& file, Place at) : file_(file), at_(std::move(at)) {}

  void number(const char* name, double value) {
    file_.attribute(at_.owner(), at_.attribute(name), value);
  }
  void bounds(const char* name, const std::vector<double>& values) {
    file_.attribute(at_.owner(), at_.attribute(name), values);
  }
  template <Worded E>
  void word(const char* name, E value) {
    file_.attribute(at_.owner(), at_.attribute(name), evo::word(value));
  }
  void numbers(const char* name, const std::vector<double>& values) {
    file_.vector(at_.dataset(name), values);
  }
  template <typename Dense>
  void vector(const char* name, const Dense& values) {
    file_.vector(at_.dataset(name), values_of(values));
  }
  void matrix(const char* name, const Matrix& values) {
    const auto size = [](Eigen::Index n) { return static_cast<std::size_t>(n); };
    file_.array(at_.dataset(name), {size(values.rows()), size(values.cols())}, values_of(values));
  }
  void rows(const char* name, const std::vector<double>& values, int width) {
    const auto columns = static_cast<std::size_t>(width);
    file_.array(at_.dataset(name), {width > 0 ? values.size() / columns : 0, columns}, values);
  }
  template <typename T>
  void parts(const char* name, std::vector<T>& list) {
    for (std::size_t l = 0; l < list.size(); ++l) {
      FieldWriter part(file_, at_.layer(name, l));
      describe(part, list[l]);
    }
  }
  template <typename Fields>
  void part(const char* name, const Fields& fields) {
    FieldWriter deeper(file_, at_.part(name));
    fields(deeper);
  }
  template <typename Fields>
  void choices(const char* name, const Fields& fields) {
    FieldWriter named(file_, at_.choices(name));
    fields(named);
  }
  template <typename Fields>
  void optional(const char* /*name*/, bool present, const Fields& fields) {
    if (present) fields();
  }

 private:
  hdf5::Writer& file_;
  Place at_;
};

class FieldReader {
 public:
  FieldReader(const hdf5::Reader& file, Place at) : file_(file), at_(std::move(at)) {}

  void number(const char* name, double& value) {
    value = file_.number<double>(at_.owner(), at_.attribute(name));
  }
  void bounds(const char* name, std::vector<double>& values) {
    values = file_.numbers<double>(at_.owner(), at_.attribute(name));
    if (values.size() != 2)
      throw bad(file_, "/@" + at_.attribute(name),
                "two numbers, the lower one first, are expected");
  }
  template <Worded E>
  void word(const char* name, E& value) {
    const std::string found = file_.text(at_.owner(), at_.attribute(name));
    const auto known = from_word<E>(found);
    if (!known)
      throw bad(file_, "/@" + at_.attribute(name), unknown_name(name, found, words_of<E>()));
    value = *known;
  }
  void numbers(const char* name, std::vector<double>& values) {
    values = file_.vector<double>(at_.dataset(name));
  }
  template <typename Dense>
  void vector(const char* name, Dense& values) {
    const auto found = file_.vector<typename Dense::Scalar>(at_.dataset(name));
    values = Eigen::Map<const Dense>(found.data(), static_cast<Eigen::Index>(found.size()));
  }
  void matrix(const char* name, Matrix& values) {
    const auto found = file_.array<float>(at_.dataset(name), {hdf5::any, hdf5::any});
    values =
        Eigen::Map<const Matrix>(found.values.data(), static_cast<Eigen::Index>(found.shape[0]),
                                 static_cast<Eigen::Index>(found.shape[1]));
  }
  void rows(const char* name, std::vector<double>& values, int& width) {
    auto found = file_.array<double>(at_.dataset(name), {hdf5::any, hdf5::any});
    width = static_cast<int>(found.shape[1]);
    values = std::move(found.values);
  }
  template <typename T>
  void parts(const char* name, std::vector<T>& list) {
    for (std::size_t l = 0; file_.exists(at_.layer(name, l).group); ++l) {
      FieldReader part(file_, at_.layer(name, l));
      describe(part, list.emplace_back());
    }
  }
  template <typename Fields>
  void part(const char* name, const Fields& fields) {
    FieldReader deeper(file_, at_.part(name));
    fields(deeper);
  }
  template <typename Fields>
  void choices(const char* name, const Fields& fields) {
    FieldReader named(file_, at_.choices(name));
    fields(named);
  }
  template <typename Fields>
  void optional(const char* name, bool /*present*/, const Fields& fields) {
    if (file_.exists(at_.dataset(name))) fields();
  }

 private:
  const hdf5::Reader& file_;
  Place at_;
};

// In the group `at`; "" is the file's own.
void write_controller(hdf5::Writer& file, const std::string& at,
                      const TrainedController& controller) {
  std::visit(
      [&]<typename T>(T copy) {
        const Place place{at, ""};
        file.attribute(place.owner(), "kind", kind_of<T>);
        FieldWriter fields(file, place);
        describe_controller(fields, copy);
      },
      controller);
}

TrainedController read_controller(const hdf5::Reader& file, const std::string& at) {
  const Place place{at, ""};
  const std::string kind = file.text(place.owner(), "kind");
  std::optional<TrainedController> controller;
  std::vector<std::string> kinds;
  for_each_alternative<TrainedController>([&]<typename T>(std::type_identity<T>) {
    kinds.emplace_back(kind_of<T>);
    if (kind != kind_of<T>) return;
    FieldReader fields(file, place);
    T read;
    describe_controller(fields, read);
    controller = std::move(read);
  });
  if (!controller) throw bad(file, at + "/@kind", unknown_name("kind of policy", kind, kinds));
  if (const auto problem = misfit(*controller)) throw bad(file, place.owner(), *problem);
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
  file.physics_yaml = physics_profiles().to_yaml(arena.task().physics);
  file.training_yaml = training_profiles().to_yaml(settings);
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
  file.attribute("/", "observation_layout", layout_to_json(policy.layout).dump());
  file.attribute("/", "seed", policy.seed);
  file.attribute("/", "isa", policy.isa);
  file.attribute("/", "created_by", policy.created_by);
  file.attribute("/", "identity", policy.identity);
  file.attribute("/", "settings_hash", policy.settings_hash);
  file.attribute("/", "fitness", policy.fitness);
  file.attribute("/", "best_step", policy.best_step);
  file.attribute("/", "steps", policy.steps);
  write_controller(file, "", policy.controller);
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
  policy.controller = read_controller(file, "");
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
                "{}: the policy is of {}, a task in Python or of another program, which no tool "
                "knows; `python3 -m evo_robots FILE.py:CLASS --rollout POLICY FILE` plays it",
                where, policy.task);
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
  if (checkpoint.best) {
    file.group("/best");
    write_controller(file, "/best", *checkpoint.best);
  }
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
  if (file.exists("/best")) checkpoint.best = read_controller(file, "/best");
  return checkpoint;
}

}  // namespace evo
