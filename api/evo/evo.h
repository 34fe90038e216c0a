// The library of evo, in C++20 and with nothing but the standard library in its
// header: load a task and robots, step environments, train controllers.
//
//   libevo::Task task("Walker-v0");
//   libevo::VectorEnv envs(task, {libevo::Robot({"HV", "VH"})}, 16);
//   std::vector<double> actions(envs.action_values(), 1.2);
//   envs.reset();
//   envs.step(actions);
//   double first = envs.rewards()[0];
//
// The same seeds give the same bits as the tools do, for any number of threads and
// on any processor.
//
// Errors are of one type, Error, and leave their object as it was; what a function of
// yours throws passes through. Different objects may be used by different threads at
// once, and the const members of one object too. Objects own what they hold, and keep
// nothing of their arguments. Of one that was moved from, nothing but assignment and
// destruction is allowed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#define LIBEVO_API __attribute__((visibility("default")))

namespace libevo {

LIBEVO_API const char* version() noexcept;  // of the library in use: "0.1.0"

struct Access;  // the library's own way in

// What went wrong, where, and what to do, in one line.
class LIBEVO_API Error : public std::runtime_error {
 public:
  // The values are the exit statuses of the tools.
  enum class Kind : int {
    work = 1,            // the work itself failed
    usage = 2,           // an argument makes no sense, or names what does not exist
    data = 65,           // a file or document makes no sense
    no_input = 66,       // a file is missing
    cannot_create = 73,  // a file cannot be created
    io = 74,             // reading or writing failed halfway
  };

  Error(Kind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  Error(const Error&) = default;
  Error& operator=(const Error&) = default;
  ~Error() override;

  Kind kind() const noexcept { return kind_; }

 private:
  Kind kind_;
};

// ---- tasks and robots ---------------------------------------------------------

// A world, what is observed in it and rewarded, and when an episode ends.
class LIBEVO_API Task {
 public:
  // A benchmark task by name, or a YAML file. Names are looked for in the folders of
  // $EVO_TASKS, then in $EVO_DATA, else where the library was installed.
  explicit Task(const std::string& name_or_file);
  Task(const Task&);
  Task(Task&&) noexcept;
  Task& operator=(const Task&);
  Task& operator=(Task&&) noexcept;
  ~Task();

  std::string name() const;
  int episode_steps() const;  // time limit, control steps
  // The range of actions: an actuator's target length as a share of its rest length.
  double action_low() const;
  double action_high() const;

  // As --physics and --set of the tools: "fast", a file; "gravity=50".
  void set_physics(const std::string& profile_or_file);
  void set(const std::string& assignment);

 private:
  friend struct Access;
  struct Impl;
  explicit Task(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// The names of all tasks that Task() finds.
LIBEVO_API std::vector<std::string> task_names();

// A body of voxels, and what is known of it.
class LIBEVO_API Robot {
 public:
  // Rows of letters, from the top: . empty, R rigid, S soft, H and V actuators that
  // stretch horizontally and vertically. Connected, with an actuator.
  explicit Robot(const std::vector<std::string>& rows);
  Robot(const Robot&);
  Robot(Robot&&) noexcept;
  Robot& operator=(const Robot&);
  Robot& operator=(Robot&&) noexcept;
  ~Robot();

  std::string id() const;  // follows from the body alone
  std::vector<std::string> rows() const;
  std::string json() const;  // the whole document, one line without its newline

 private:
  friend struct Access;
  struct Impl;
  explicit Robot(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// All robots of a text or file: JSON, JSON Lines, YAML or letters; a policy or
// rollout file stands for its robot.
LIBEVO_API std::vector<Robot> parse_robots(const std::string& text);
LIBEVO_API std::vector<Robot> read_robots(const std::string& file);

// ---- environments -------------------------------------------------------------

// How episodes begin.
struct Start {
  // Stays in force until another is given; 0 at first.
  std::optional<std::uint64_t> seed = {};
  // Of the seed: what a task draws follows from both, as in the tools. By itself
  // environment i of N of a robot plays the episodes i, i + N, i + 2 N, .. of its seed,
  // one at each reset; a seed begins this count anew.
  std::optional<std::uint64_t> episode = {};
  double jitter = 0.0;  // every start coordinate is moved by up to this, voxels
};

enum class Status : std::uint8_t {
  ok = 0,
  unreset = 1,   // before its first reset; a step of it is an error
  unstable = 2,  // the simulation failed; left out of steps until its next reset
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

// E environments, stepped side by side in the processor's vector lanes. As
// Gymnasium's VectorEnv with autoreset disabled: what has ended shows it, and may be
// stepped on until it is reset. Arrays are environment-major and stay where they are;
// reset() and step() write them. Not copied, but moved.
class LIBEVO_API VectorEnv {
 public:
  // `per_robot` environments for each robot, one robot after the other; robots may
  // differ in size. `threads` share the work of a step.
  VectorEnv(const Task& task, const std::vector<Robot>& robots, int per_robot = 1, int threads = 1);
  VectorEnv(VectorEnv&&) noexcept;
  VectorEnv& operator=(VectorEnv&&) noexcept;
  ~VectorEnv();

  int num_envs() const;
  int observation_length(int environment) const;
  int action_length(int environment) const;
  std::size_t observation_values() const;  // of all environments
  std::size_t action_values() const;
  // Where the values of an environment begin in observations() and actions.
  std::size_t observation_offset(int environment) const;
  std::size_t action_offset(int environment) const;

  // Begins an episode in every environment, or in one. Throws Error(usage).
  void reset(const Start& start = {});
  void reset(int environment, const Start& start = {});

  // One control step. `actions`: [action_values()], clipped to the task's range.
  // `active`: [E], not 0 for those that take part (all, if empty); the others stay as
  // they are. Throws Error(usage), with nothing stepped, for wrong lengths, actions that
  // are not finite, and environments that were never reset.
  void step(std::span<const double> actions, std::span<const std::uint8_t> active = {});

  // The state of an episode in progress: it goes on from there as often as it is restored,
  // in any environment of the same robot and task, to the same bits. The bytes are opaque and
  // for this version of the library. Throws Error(usage) for an environment whose status is
  // not ok; Error(data) for bytes saved elsewhere or damaged, with nothing restored.
  std::vector<std::uint8_t> save(int environment) const;
  void restore(int environment, std::span<const std::uint8_t> state);

  // After reset, step and restore; zeros before the first reset of an environment.
  std::span<const double> observations() const;  // [observation_values()]
  std::span<const double> observation(int environment) const;
  std::span<const double> rewards() const;           // [E] of the last step
  std::span<const std::uint8_t> terminated() const;  // [E] ended by a rule of the task
  std::span<const std::uint8_t> truncated() const;   // [E] ended by the time limit
  std::span<const Status> status() const;            // [E]
  std::span<const int> steps() const;                // [E] taken in this episode

  // All point masses of an environment's world, in the benchmark's raw units: a voxel
  // is 0.1 wide, a control step takes 0.003 of the time in velocities.
  std::vector<Point> positions(int environment) const;
  std::vector<Point> velocities(int environment) const;
  std::vector<Object> objects(int environment) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
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

// An evaluation in the course of a training, and the best until then.
struct CurvePoint {
  std::int64_t step = 0;  // environment steps
  double evaluation = 0.0;
  double best = 0.0;
};

// A trained controller with what it belongs to.
class LIBEVO_API Policy {
 public:
  explicit Policy(const std::string& file);
  Policy(const Policy&);
  Policy(Policy&&) noexcept;
  Policy& operator=(const Policy&);
  Policy& operator=(Policy&&) noexcept;
  ~Policy();

  Robot robot() const;
  Task task() const;       // with its physics
  double fitness() const;  // the best evaluation
  std::vector<CurvePoint> curve() const;
  int observation_length() const;  // D
  int action_length() const;       // A

  // The deterministic controller: observations [N x D] at steps [N] of their episodes
  // in, actions [N x A] out. Throws Error(usage) for wrong lengths.
  void act(std::span<const double> observations, std::span<const int> steps,
           std::span<double> actions) const;

  // A file for evo-eval, evo-render, evo-convert; appears whole or not at all.
  void save(const std::string& file) const;

 private:
  friend struct Access;
  struct Impl;
  explicit Policy(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// As evo-train, to the same bytes, in the calling thread. Throws Error(work) where the
// training failed or `go_on` ended it.
LIBEVO_API Policy train(const Task& task, const Robot& robot, const TrainingOptions& options = {});

}  // namespace libevo
