// The library of evo in C++20: a thin layer over evo/evo.h, which says what everything means.
//
//   libevo::Task task("Walker-v0");
//   libevo::VectorEnv envs(task, {libevo::Robot({"HV", "VH"})}, 16);
//   std::vector<double> actions(envs.action_values(), 1.2);
//   envs.reset();
//   envs.step(actions);
//   double first = envs.rewards()[0];
//
// Errors are of one type, Error, and leave their object as it was; what a function of
// yours throws passes through. Objects own what they hold, and keep nothing of their
// arguments. Of one that was moved from, nothing but assignment and destruction is allowed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "evo/evo.h"

namespace libevo {

inline const char* version() noexcept { return evo_version(); }

// What went wrong, where, and what to do, in one line.
class Error : public std::runtime_error {
 public:
  // The values are the exit statuses of the tools.
  enum class Kind : int {
    work = EVO_WORK,
    usage = EVO_USAGE,
    data = EVO_DATA,
    no_input = EVO_NO_INPUT,
    cannot_create = EVO_CANNOT_CREATE,
    io = EVO_IO,
  };

  Error(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  Kind kind() const noexcept { return kind_; }

 private:
  Kind kind_;
};

namespace detail {

inline void check(int result) {
  if (result != EVO_OK) throw Error(static_cast<Error::Kind>(result), evo_error());
}

template <auto free_handle>
struct Free {
  template <typename Handle>
  void operator()(Handle* handle) const {
    free_handle(handle);
  }
};
using TaskHandle = std::unique_ptr<evo_task, Free<evo_task_free>>;
using RobotsHandle = std::unique_ptr<evo_robots, Free<evo_robots_free>>;
using EnvsHandle = std::unique_ptr<evo_envs, Free<evo_envs_free>>;
using PolicyHandle = std::unique_ptr<evo_policy, Free<evo_policy_free>>;
using Given = std::unique_ptr<void, Free<evo_free>>;

// The handle that `open` makes, which is given the place for it.
template <typename Owner, typename Open>
Owner opened(const Open& open) {
  typename Owner::pointer handle = nullptr;
  check(open(&handle));
  return Owner(handle);
}

// The facts that `describe` fills in.
template <typename Facts, typename Describe>
Facts described(const Describe& describe) {
  Facts facts{};
  check(describe(&facts, sizeof facts));
  return facts;
}

inline std::string json_string(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

}  // namespace detail

// ---- tasks and robots ---------------------------------------------------------

// A world, what is observed in it and rewarded, and when an episode ends.
class Task {
 public:
  // A benchmark task by name, or a YAML file.
  explicit Task(const std::string& name_or_file)
      : handle_(detail::opened<detail::TaskHandle>(
            [&](evo_task** at) { return evo_task_open(name_or_file.c_str(), at); })) {}
  explicit Task(detail::TaskHandle handle) : handle_(std::move(handle)) {}
  Task(const Task& other)
      : handle_(detail::opened<detail::TaskHandle>(
            [&](evo_task** at) { return evo_task_copy(other.handle(), at); })) {}
  Task(Task&&) noexcept = default;
  Task& operator=(const Task& other) { return *this = Task(other); }
  Task& operator=(Task&&) noexcept = default;
  ~Task() = default;

  std::string name() const { return facts().name; }
  int episode_steps() const { return facts().episode_steps; }  // time limit, control steps
  // The range of actions: an actuator's target length as a share of its rest length.
  double action_low() const { return facts().action_low; }
  double action_high() const { return facts().action_high; }

  // As --physics and --set of the tools: "paper", a file; "gravity=50".
  void set_physics(const std::string& profile_or_file) {
    detail::check(evo_task_set_physics(handle_.get(), profile_or_file.c_str()));
  }
  void set(const std::string& assignment) {
    detail::check(evo_task_set(handle_.get(), assignment.c_str()));
  }

  const evo_task* handle() const { return handle_.get(); }

 private:
  evo_task_facts facts() const {
    return detail::described<evo_task_facts>([&](evo_task_facts* facts, std::size_t size) {
      return evo_task_describe(handle(), facts, size);
    });
  }

  detail::TaskHandle handle_;
};

// The names of all tasks that Task() finds.
inline std::vector<std::string> task_names() {
  char* lines = nullptr;
  detail::check(evo_task_names(&lines));
  const detail::Given owner(lines);
  std::vector<std::string> names{""};
  for (const char* c = lines; *c != '\0'; ++c) {
    if (*c == '\n')
      names.emplace_back();
    else
      names.back() += *c;
  }
  return names;
}

// A body of voxels, and what is known of it.
class Robot {
 public:
  // Rows of letters, from the top: . empty, R rigid, S soft, H and V actuators that
  // stretch horizontally and vertically. Connected, with an actuator.
  explicit Robot(const std::vector<std::string>& rows) : Robot(parse(rows)) {}
  // Robot `index` of a list.
  Robot(const evo_robots* list, std::size_t index)
      : handle_(detail::opened<detail::RobotsHandle>(evo_robots_new)) {
    detail::check(evo_robots_append(handle_.get(), list, index));
  }
  Robot(const Robot& other) : Robot(other.handle(), 0) {}
  Robot(Robot&&) noexcept = default;
  Robot& operator=(const Robot& other) { return *this = Robot(other); }
  Robot& operator=(Robot&&) noexcept = default;
  ~Robot() = default;

  std::string id() const { return facts().id; }      // follows from the body alone
  std::string json() const { return facts().json; }  // the whole document, without newline
  std::vector<std::string> rows() const {
    const evo_robot_facts body = facts();
    std::vector<std::string> rows;
    for (int row = 0; row < body.rows; ++row) {
      rows.emplace_back();
      for (int column = 0; column < body.columns; ++column)
        rows.back() += ".RSHV#"[body.voxels[row * body.columns + column]];
    }
    return rows;
  }

  const evo_robots* handle() const { return handle_.get(); }  // a list of this one

 private:
  explicit Robot(detail::RobotsHandle handle) : handle_(std::move(handle)) {}

  static detail::RobotsHandle parse(const std::vector<std::string>& rows) {
    std::string document = R"({"format":"evo/robot","version":1,"body":[)";
    for (std::size_t i = 0; i < rows.size(); ++i)
      document += (i > 0 ? "," : "") + detail::json_string(rows[i]);
    document += "]}";
    return detail::opened<detail::RobotsHandle>(
        [&](evo_robots** at) { return evo_robots_parse(document.c_str(), at); });
  }

  evo_robot_facts facts() const {
    return detail::described<evo_robot_facts>([&](evo_robot_facts* facts, std::size_t size) {
      return evo_robots_describe(handle(), 0, facts, size);
    });
  }

  detail::RobotsHandle handle_;
};

namespace detail {

template <typename Open>
std::vector<Robot> robots(const Open& open) {
  const auto list = opened<RobotsHandle>(open);
  std::size_t count = 0;
  check(evo_robots_count(list.get(), &count));
  std::vector<Robot> robots;
  for (std::size_t i = 0; i < count; ++i) robots.emplace_back(list.get(), i);
  return robots;
}

}  // namespace detail

// All robots of a text or file: JSON, JSON Lines, YAML, letters or numbers; a policy or
// rollout file stands for its robot.
inline std::vector<Robot> parse_robots(const std::string& text) {
  return detail::robots([&](evo_robots** at) { return evo_robots_parse(text.c_str(), at); });
}
inline std::vector<Robot> read_robots(const std::string& file) {
  return detail::robots([&](evo_robots** at) { return evo_robots_read(file.c_str(), at); });
}

// ---- environments -------------------------------------------------------------

// How episodes begin; see evo_start.
struct Start {
  std::optional<std::uint64_t> seed = {};
  std::optional<std::uint64_t> episode = {};
  double jitter = 0.0;  // every start coordinate is moved by up to this, voxels
};

enum class Status : std::uint8_t {
  ok = EVO_ENV_OK,
  unreset = EVO_ENV_UNRESET,    // before its first reset; a step of it is an error
  unstable = EVO_ENV_UNSTABLE,  // the simulation failed; left out of steps until its next reset
};

// A place or a velocity in the plane.
struct Point {
  double x = 0.0;
  double y = 0.0;  // upwards
};

// Which points of a world are an object's; the robot's is named "robot".
struct Object {
  std::string name;
  std::size_t first_point = 0;
  std::size_t points = 0;
};

class Policy;

// E environments, stepped side by side in the processor's vector lanes. As
// Gymnasium's VectorEnv with autoreset disabled: what has ended shows it, and may be
// stepped on until it is reset. Arrays are environment-major and stay where they are;
// reset() and step() write them. Not copied, but moved.
class VectorEnv {
 public:
  // `per_robot` environments for each robot, one robot after the other; robots may
  // differ in size. `threads` share the work of a step.
  VectorEnv(const Task& task, const std::vector<Robot>& robots, int per_robot = 1,
            int threads = 1) {
    const auto list = detail::opened<detail::RobotsHandle>(evo_robots_new);
    for (const Robot& robot : robots)
      detail::check(evo_robots_append(list.get(), robot.handle(), 0));
    handle_ = detail::opened<detail::EnvsHandle>([&](evo_envs** at) {
      return evo_envs_open(task.handle(), list.get(), per_robot, threads, at);
    });
    detail::check(evo_envs_arrays(handle_.get(), &arrays_, sizeof arrays_));
  }

  int num_envs() const { return static_cast<int>(arrays_.environments); }
  int observation_length(int environment) const {
    return length(arrays_.observation_offsets, environment);
  }
  int action_length(int environment) const { return length(arrays_.action_offsets, environment); }
  std::size_t observation_values() const { return arrays_.observation_values; }  // of all
  std::size_t action_values() const { return arrays_.action_values; }
  // Where the values of an environment begin in observations() and actions.
  std::size_t observation_offset(int environment) const {
    return arrays_.observation_offsets[checked(environment)];
  }
  std::size_t action_offset(int environment) const {
    return arrays_.action_offsets[checked(environment)];
  }

  // Begins an episode in every environment, or in one. Throws Error(usage).
  void reset(const Start& start = {}) { reset(nullptr, 0, start); }
  void reset(int environment, const Start& start = {}) {
    const std::int32_t one = environment;
    reset(&one, 1, start);
  }

  // One control step. `actions`: [action_values()], clipped to the task's range.
  // `active`: [E], not 0 for those that take part (all, if empty); the others stay as
  // they are. Throws Error(usage), with nothing stepped, for wrong lengths, actions that
  // are not finite, and environments that were never reset.
  void step(std::span<const double> actions, std::span<const std::uint8_t> active = {}) {
    detail::check(evo_envs_step(handle_.get(), actions.data(), actions.size(),
                                active.empty() ? nullptr : active.data(), active.size()));
  }

  // The state of an episode in progress; see evo_envs_save.
  std::vector<std::uint8_t> save(int environment) const {
    void* bytes = nullptr;
    std::size_t count = 0;
    detail::check(evo_envs_save(handle_.get(), environment, &bytes, &count));
    const detail::Given owner(bytes);
    const auto* const first = static_cast<const std::uint8_t*>(bytes);
    return {first, first + count};
  }
  void restore(int environment, std::span<const std::uint8_t> state) {
    // Nothing is no state, and not a pointer to one.
    static constexpr std::uint8_t nothing = 0;
    detail::check(evo_envs_restore(handle_.get(), environment,
                                   state.empty() ? &nothing : state.data(), state.size()));
  }
  // Moves every point by up to `jitter` voxels in each coordinate; velocities stay.
  void perturb(int environment, double jitter, std::uint64_t seed) {
    detail::check(evo_envs_perturb(handle_.get(), environment, jitter, seed));
  }

  // After reset, step and restore; zeros before the first reset of an environment.
  std::span<const double> observations() const {
    return {arrays_.observations, arrays_.observation_values};
  }
  std::span<const double> observation(int environment) const {
    return observations().subspan(observation_offset(environment),
                                  static_cast<std::size_t>(observation_length(environment)));
  }
  std::span<const double> rewards() const { return each(arrays_.rewards); }  // [E], last step
  std::span<const std::uint8_t> terminated() const { return each(arrays_.terminated); }  // [E]
  std::span<const std::uint8_t> truncated() const { return each(arrays_.truncated); }    // [E]
  Status status(int environment) const {
    return static_cast<Status>(arrays_.status[checked(environment)]);
  }
  std::span<const std::int32_t> steps() const { return each(arrays_.steps); }  // [E] taken

  // All point masses of an environment's world, in the benchmark's raw units: a voxel
  // is 0.1 wide, a control step takes 0.003 of the time in velocities.
  std::vector<Point> positions(int environment) const {
    return points(arrays_.positions, environment);
  }
  std::vector<Point> velocities(int environment) const {
    return points(arrays_.velocities, environment);
  }
  std::vector<Object> objects(int environment) const {
    std::size_t count = 0;
    detail::check(evo_envs_object_count(handle_.get(), environment, &count));
    std::vector<Object> objects;
    for (std::size_t i = 0; i < count; ++i) {
      const auto found = detail::described<evo_object>([&](evo_object* object, std::size_t size) {
        return evo_envs_object(handle_.get(), environment, i, object, size);
      });
      objects.push_back({found.name, found.first_point, found.points});
    }
    return objects;
  }

  // What voxels see, for controllers of any body; see evo_voxels.
  evo_voxels voxels(int environment) const {
    return detail::described<evo_voxels>([&](evo_voxels* voxels, std::size_t size) {
      return evo_envs_voxels(handle_.get(), environment, voxels, size);
    });
  }
  // As all environments are now: local [V x L] of each in turn, task [E x T].
  void look(std::span<double> local, std::span<double> task) const {
    detail::check(
        evo_envs_look(handle_.get(), local.data(), local.size(), task.data(), task.size()));
  }
  // The deterministic controller in all environments, as step() takes it; a modular policy acts
  // on any robot of its task.
  void act(const Policy& policy, std::span<double> actions) const;

  const evo_arrays& arrays() const { return arrays_; }  // all of them, as evo/evo.h has them

 private:
  std::size_t checked(int environment) const {
    if (environment < 0 || environment >= num_envs())
      throw Error(Error::Kind::usage, "there is no environment " + std::to_string(environment) +
                                          ": they are 0 to " + std::to_string(num_envs() - 1));
    return static_cast<std::size_t>(environment);
  }
  int length(const std::size_t* offsets, int environment) const {
    const std::size_t e = checked(environment);
    return static_cast<int>(offsets[e + 1] - offsets[e]);
  }
  template <typename T>
  std::span<const T> each(const T* values) const {
    return {values, arrays_.environments};
  }
  std::vector<Point> points(const double* values, int environment) const {
    const std::size_t e = checked(environment);
    std::vector<Point> result;
    for (std::size_t i = arrays_.point_offsets[e]; i < arrays_.point_offsets[e + 1]; ++i)
      result.push_back({values[2 * i], values[2 * i + 1]});
    return result;
  }
  void reset(const std::int32_t* environments, std::size_t count, const Start& start) {
    const evo_start how{start.seed.has_value(), start.episode.has_value(),
                        start.seed.value_or(0), start.episode.value_or(0),
                        start.jitter,           nullptr};
    detail::check(evo_envs_reset(handle_.get(), environments, count, &how));
  }

  detail::EnvsHandle handle_;
  evo_arrays arrays_{};
};

// ---- controllers --------------------------------------------------------------

struct TrainingOptions {
  std::string profile = "default";         // a training profile, by name or file
  std::vector<std::string> set = {};       // settings of it: "gamma=0.995"
  std::optional<std::int64_t> steps = {};  // environment steps; else the profile's
  std::uint64_t seed = 0;
  // Called after every update with the environment steps so far; false ends the
  // training, as does an exception, which then is the one that train() throws.
  std::function<bool(std::int64_t step)> go_on = {};
};

using CurvePoint = evo_curve_point;  // an evaluation in a training, and the best until then

// A trained controller with what it belongs to.
class Policy {
 public:
  explicit Policy(const std::string& file)
      : handle_(detail::opened<detail::PolicyHandle>(
            [&](evo_policy** at) { return evo_policy_read(file.c_str(), at); })) {}
  explicit Policy(detail::PolicyHandle handle) : handle_(std::move(handle)) {}
  Policy(const Policy& other)
      : handle_(detail::opened<detail::PolicyHandle>(
            [&](evo_policy** at) { return evo_policy_copy(other.handle_.get(), at); })) {}
  Policy(Policy&&) noexcept = default;
  Policy& operator=(const Policy& other) { return *this = Policy(other); }
  Policy& operator=(Policy&&) noexcept = default;
  ~Policy() = default;

  Robot robot() const {
    const auto list = detail::opened<detail::RobotsHandle>(
        [&](evo_robots** at) { return evo_policy_robot(handle_.get(), at); });
    return Robot(list.get(), 0);
  }
  Task task() const {  // with its physics
    return Task(detail::opened<detail::TaskHandle>(
        [&](evo_task** at) { return evo_policy_task(handle_.get(), at); }));
  }
  double fitness() const { return facts().fitness; }  // the best evaluation
  std::vector<CurvePoint> curve() const {
    const evo_policy_facts known = facts();
    return {known.curve, known.curve + known.curve_points};
  }
  int observation_length() const { return static_cast<int>(facts().observation_length); }  // D
  int action_length() const { return static_cast<int>(facts().action_length); }            // A

  // The deterministic controller: observations [N x D] at steps [N] of their episodes
  // in, actions [N x A] out. Throws Error(usage) for wrong lengths.
  void act(std::span<const double> observations, std::span<const std::int32_t> steps,
           std::span<double> actions) const {
    if (observations.size() != steps.size() * facts().observation_length)
      throw Error(Error::Kind::usage,
                  "for " + std::to_string(steps.size()) + " steps, observations of " +
                      std::to_string(facts().observation_length) + " values are expected, not " +
                      std::to_string(observations.size()) + " values in all");
    detail::check(evo_policy_act(handle_.get(), observations.data(), steps.data(), steps.size(),
                                 actions.data(), actions.size()));
  }

  const evo_policy* handle() const { return handle_.get(); }

  // A file for evo-eval, evo-render, evo-convert; appears whole or not at all.
  void save(const std::string& file) const {
    detail::check(evo_policy_write(handle_.get(), file.c_str()));
  }

 private:
  evo_policy_facts facts() const {
    return detail::described<evo_policy_facts>([&](evo_policy_facts* facts, std::size_t size) {
      return evo_policy_describe(handle_.get(), facts, size);
    });
  }

  detail::PolicyHandle handle_;
};

inline void VectorEnv::act(const Policy& policy, std::span<double> actions) const {
  detail::check(evo_envs_act(handle_.get(), policy.handle(), actions.data(), actions.size()));
}

// As evo-train, to the same bytes, in the calling thread. Throws Error(work) where the
// training failed or `go_on` ended it.
inline Policy train(const Task& task, const Robot& robot, const TrainingOptions& options = {}) {
  std::vector<std::string> settings = options.set;
  if (options.steps) settings.push_back("steps=" + std::to_string(*options.steps));
  std::vector<const char*> set;
  for (const std::string& setting : settings) set.push_back(setting.c_str());
  struct Caller {
    const std::function<bool(std::int64_t)>& go_on;
    std::exception_ptr thrown;
  } caller{options.go_on, nullptr};
  evo_training training{
      options.profile.c_str(), set.data(), set.size(), 0, options.seed, nullptr, &caller};
  if (options.go_on)
    training.go_on = [](std::int64_t step, void* user) {
      auto& at = *static_cast<Caller*>(user);
      try {
        return static_cast<int>(at.go_on(step));
      } catch (...) {
        at.thrown = std::current_exception();
        return 0;
      }
    };
  evo_policy* policy = nullptr;
  const int result =
      evo_train(task.handle(), robot.handle(), 0, &training, sizeof training, &policy);
  if (caller.thrown) std::rethrow_exception(caller.thrown);
  detail::check(result);
  return Policy(detail::PolicyHandle(policy));
}

}  // namespace libevo
