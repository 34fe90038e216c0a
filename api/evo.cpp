#include "evo/evo.h"

#include <dlfcn.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <numeric>
#include <system_error>
#include <variant>

#include "api/created_by.h"
#include "api/session.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/training/policy.h"
#include "formats/training/training.h"
#include "libevo/base/error.h"
#include "libevo/control/trainer.h"

namespace libevo {
namespace {

namespace fs = std::filesystem;

// Runs `work`; what our own code throws leaves the library as its Error.
template <typename Work>
auto guarded(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const evo::Error& failure) {
    throw Error(static_cast<Error::Kind>(failure.kind()), failure.what());
  } catch (const std::bad_alloc&) {
    throw Error(Error::Kind::work, "out of memory");
  } catch (const fs::filesystem_error& failure) {
    throw Error(Error::Kind::io, failure.what());
  }
}

// As the tools find it; installed with this library, or in the checkout it was built in.
evo::DataFolders data_folders() {
  Dl_info self{};
  fs::path here;
  std::error_code failed;
  if (dladdr(reinterpret_cast<const void*>(&version), &self) != 0 && self.dli_fname != nullptr)
    here = fs::canonical(self.dli_fname, failed).parent_path();
  return evo::data_folders(
      evo::data_root({here / EVO_DATA_FROM_LIBRARY, here / EVO_CHECKOUT_FROM_LIBRARY}));
}

}  // namespace

const char* version() noexcept { return EVO_LIBRARY_VERSION; }

Error::~Error() = default;

// ---- tasks and robots -----------------------------------------------------------

struct Task::Impl {
  evo::TaskSpec spec;
};
struct Robot::Impl {
  evo::Robot robot;
};
struct Policy::Impl {
  evo::PolicyFile file;
};

struct Access {
  static const evo::TaskSpec& spec(const Task& task) { return task.impl_->spec; }
  static const evo::Robot& robot(const Robot& robot) { return robot.impl_->robot; }
  // A Task, Robot or Policy of what it consists of.
  template <typename Handle, typename Inside>
  static Handle make(Inside inside) {
    return Handle(
        std::make_unique<typename Handle::Impl>(typename Handle::Impl{std::move(inside)}));
  }
};

Task::Task(const std::string& name_or_file)
    : impl_(guarded([&] {
        return std::make_unique<Impl>(Impl{evo::load_task(name_or_file, data_folders())});
      })) {}
Task::Task(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Task::Task(const Task& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
Task::Task(Task&&) noexcept = default;
Task& Task::operator=(const Task& other) { return *this = Task(other); }
Task& Task::operator=(Task&&) noexcept = default;
Task::~Task() = default;

std::string Task::name() const { return impl_->spec.name; }
int Task::episode_steps() const { return impl_->spec.episode_steps; }
double Task::action_low() const { return impl_->spec.physics.min_target; }
double Task::action_high() const { return impl_->spec.physics.max_target; }

void Task::set_physics(const std::string& profile_or_file) {
  guarded(
      [&] { evo::set_physics(impl_->spec, evo::load_physics(profile_or_file, data_folders())); });
}

void Task::set(const std::string& assignment) {
  guarded([&] {
    evo::Physics physics = impl_->spec.physics;
    evo::apply_override(physics, assignment);
    evo::set_physics(impl_->spec, physics);
  });
}

std::vector<std::string> task_names() {
  return guarded([] { return evo::task_names(data_folders()); });
}

Robot::Robot(const std::vector<std::string>& rows)
    : impl_(guarded([&] {
        const evo::Json document{{"format", "evo/robot"}, {"version", 1}, {"body", rows}};
        return std::make_unique<Impl>(Impl{evo::robot_from_json(document, "robot")});
      })) {}
Robot::Robot(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Robot::Robot(const Robot& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
Robot::Robot(Robot&&) noexcept = default;
Robot& Robot::operator=(const Robot& other) { return *this = Robot(other); }
Robot& Robot::operator=(Robot&&) noexcept = default;
Robot::~Robot() = default;

std::string Robot::id() const { return impl_->robot.id; }
std::vector<std::string> Robot::rows() const { return impl_->robot.body.to_rows(); }
std::string Robot::json() const { return evo::robot_to_line(impl_->robot); }

namespace {

std::vector<Robot> robots_of(std::vector<evo::Robot> read) {
  std::vector<Robot> robots;
  robots.reserve(read.size());
  for (evo::Robot& robot : read) robots.push_back(Access::make<Robot>(std::move(robot)));
  return robots;
}

}  // namespace

std::vector<Robot> parse_robots(const std::string& text) {
  return guarded([&] { return robots_of(evo::parse_robots(text, "robots")); });
}
std::vector<Robot> read_robots(const std::string& file) {
  return guarded([&] { return robots_of(evo::read_robots(file)); });
}

// ---- environments ---------------------------------------------------------------

struct VectorEnv::Impl {
  evo::Session session;
  // What Session is asked one environment at a time.
  std::vector<double> rewards;
  std::vector<Status> status;
  std::vector<int> steps;

  const evo::VecEnv& checked(int environment) const {
    guarded([&] { session.check_environment(environment); });
    return session.envs();
  }

  void refresh() {
    for (std::size_t i = 0; i < rewards.size(); ++i) {
      const auto e = static_cast<int>(i);
      rewards[i] = session.reward(e);
      status[i] = static_cast<Status>(session.status(e));
      steps[i] = session.envs().steps(e);
    }
  }

  void reset(std::vector<int> environments, const Start& start) {
    guarded([&] {
      session.reset(
          {std::move(environments), start.seed, start.episode, std::nullopt, start.jitter});
    });
    refresh();
  }
};

VectorEnv::VectorEnv(const Task& task, const std::vector<Robot>& robots, int per_robot, int threads)
    : impl_(guarded([&] {
        if (robots.empty())
          throw evo::error(evo::Failure::usage, "environments need a robot; none is given");
        if (threads < 1)
          throw evo::error(evo::Failure::usage, "environments need 1 thread or more, not {}",
                           threads);
        std::vector<evo::Robot> own;
        own.reserve(robots.size());
        for (const Robot& robot : robots) own.push_back(Access::robot(robot));
        // A session does not move, and make_unique knows no braces.
        return std::unique_ptr<Impl>(  // NOLINT(modernize-make-unique)
            new Impl{{Access::spec(task), std::move(own), per_robot, 0, threads}, {}, {}, {}});
      })) {
  const auto count = static_cast<std::size_t>(num_envs());
  impl_->rewards.resize(count);
  impl_->status.resize(count);
  impl_->steps.resize(count);
  impl_->refresh();
}
VectorEnv::VectorEnv(VectorEnv&&) noexcept = default;
VectorEnv& VectorEnv::operator=(VectorEnv&&) noexcept = default;
VectorEnv::~VectorEnv() = default;

int VectorEnv::num_envs() const { return impl_->session.environments(); }
int VectorEnv::observation_length(int environment) const {
  return impl_->checked(environment).arena(environment).observation_length();
}
int VectorEnv::action_length(int environment) const {
  return impl_->checked(environment).arena(environment).action_length();
}
std::size_t VectorEnv::observation_values() const { return observations().size(); }
std::size_t VectorEnv::action_values() const { return impl_->session.action_values(); }
std::size_t VectorEnv::observation_offset(int environment) const {
  return impl_->checked(environment).observation_offset(environment);
}
std::size_t VectorEnv::action_offset(int environment) const {
  return impl_->checked(environment).action_offset(environment);
}

void VectorEnv::reset(const Start& start) {
  std::vector<int> all(static_cast<std::size_t>(num_envs()));
  std::iota(all.begin(), all.end(), 0);
  impl_->reset(std::move(all), start);
}
void VectorEnv::reset(int environment, const Start& start) { impl_->reset({environment}, start); }

void VectorEnv::step(std::span<const double> actions, std::span<const std::uint8_t> active) {
  guarded([&] {
    if (actions.size() != action_values())
      throw evo::error(evo::Failure::usage, "{} actions are expected, not {}", action_values(),
                       actions.size());
    if (!active.empty() && active.size() != impl_->rewards.size())
      throw evo::error(evo::Failure::usage, "`active` has {} values for {} environments",
                       active.size(), impl_->rewards.size());
    impl_->session.step(actions, active);
  });
  impl_->refresh();
}

std::vector<std::uint8_t> VectorEnv::save(int environment) const {
  return guarded([&] { return impl_->session.save(environment); });
}
void VectorEnv::restore(int environment, std::span<const std::uint8_t> state) {
  guarded([&] {
    const evo::Session::Restored one{environment, state};
    impl_->session.restore({&one, 1});
  });
  impl_->refresh();
}

std::span<const double> VectorEnv::observations() const {
  return impl_->session.envs().observations();
}
std::span<const double> VectorEnv::observation(int environment) const {
  impl_->checked(environment);
  return impl_->session.observation(environment);
}
std::span<const double> VectorEnv::rewards() const { return impl_->rewards; }
std::span<const std::uint8_t> VectorEnv::terminated() const {
  return impl_->session.envs().terminated();
}
std::span<const std::uint8_t> VectorEnv::truncated() const {
  return impl_->session.envs().truncated();
}
std::span<const Status> VectorEnv::status() const { return impl_->status; }
std::span<const int> VectorEnv::steps() const { return impl_->steps; }

namespace {

std::vector<Point> points(std::span<const evo::Vec2> of) {
  std::vector<Point> result;
  for (const evo::Vec2& p : of) result.push_back({p.x, p.y});
  return result;
}

}  // namespace

std::vector<Point> VectorEnv::positions(int environment) const {
  return points(impl_->checked(environment).positions(environment));
}
std::vector<Point> VectorEnv::velocities(int environment) const {
  return points(impl_->checked(environment).velocities(environment));
}
std::vector<Object> VectorEnv::objects(int environment) const {
  std::vector<Object> result;
  for (const evo::ModelObject& object : impl_->checked(environment).model(environment).objects())
    result.push_back({object.name, static_cast<std::size_t>(object.first_point),
                      static_cast<std::size_t>(object.points)});
  return result;
}

// ---- controllers ----------------------------------------------------------------

Policy::Policy(const std::string& file)
    : impl_(guarded([&] { return std::make_unique<Impl>(Impl{evo::read_policy(file)}); })) {}
Policy::Policy(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Policy::Policy(const Policy& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
Policy::Policy(Policy&&) noexcept = default;
Policy& Policy::operator=(const Policy& other) { return *this = Policy(other); }
Policy& Policy::operator=(Policy&&) noexcept = default;
Policy::~Policy() = default;

Robot Policy::robot() const { return Access::make<Robot>(impl_->file.robot); }
Task Policy::task() const {
  return guarded([&] {
    return Access::make<Task>(evo::parse_task(impl_->file.task_yaml, "the policy's task"));
  });
}
double Policy::fitness() const { return impl_->file.fitness; }
std::vector<CurvePoint> Policy::curve() const {
  std::vector<CurvePoint> result;
  for (const evo::CurvePoint& p : impl_->file.curve)
    result.push_back({p.step, p.evaluation, p.best});
  return result;
}

int Policy::observation_length() const {
  int length = 0;
  for (const evo::ObservationSlice& slice : impl_->file.layout) length += slice.length;
  return length;
}

int Policy::action_length() const {
  const evo::TrainedController& controller = impl_->file.controller;
  if (const auto* network = std::get_if<evo::Policy>(&controller)) return network->action_length();
  if (const auto* sequence = std::get_if<evo::ReplayController>(&controller))
    return sequence->actuators;
  return static_cast<int>(std::get<evo::SineController>(controller).amplitude.size());
}

void Policy::act(std::span<const double> observations, std::span<const int> steps,
                 std::span<double> actions) const {
  guarded([&] {
    const auto wide = static_cast<std::size_t>(observation_length());
    const auto targets = static_cast<std::size_t>(action_length());
    if (observations.size() != steps.size() * wide || actions.size() != steps.size() * targets)
      throw evo::error(evo::Failure::usage,
                       "for {} steps, {} observations of {} values and {} actions of {} are "
                       "expected, not {} and {} values in all",
                       steps.size(), steps.size(), wide, steps.size(), targets, observations.size(),
                       actions.size());
    const evo::TrainedController& controller = impl_->file.controller;
    if (const auto* network = std::get_if<evo::Policy>(&controller)) {
      evo::act(*network, observations, steps, actions);
    } else if (const auto* sequence = std::get_if<evo::ReplayController>(&controller)) {
      for (std::size_t i = 0; i < steps.size(); ++i)
        evo::act(*sequence, steps[i], actions.subspan(i * targets, targets));
    } else {
      for (std::size_t i = 0; i < steps.size(); ++i)
        evo::act(std::get<evo::SineController>(controller), steps[i],
                 actions.subspan(i * targets, targets));
    }
  });
}

void Policy::save(const std::string& file) const {
  guarded([&] { evo::write_policy(file, impl_->file); });
}

Policy train(const Task& task, const Robot& robot, const TrainingOptions& options) {
  return guarded([&] {
    evo::TrainingSettings settings = evo::load_training(options.profile, data_folders());
    for (const std::string& assignment : options.set) evo::apply_override(settings, assignment);
    if (options.steps) evo::apply_override(settings, "steps=" + std::to_string(*options.steps));
    evo::check(settings);
    const evo::Robot& subject = Access::robot(robot);
    const evo::Arena arena(Access::spec(task), subject.body);
    evo::Trainer trainer(arena, settings, options.seed, subject.id);
    const evo::TrainResult result =
        evo::train(trainer, [&](const evo::Trainer&, const evo::TrainingReport& report) {
          return !options.go_on || options.go_on(report.step);
        });
    if (result.failure)
      throw evo::error(evo::Failure::work, "robot {}: {}", subject.id, result.failure->why);
    if (!result.complete)
      throw evo::error(evo::Failure::work, "robot {}: the training was ended after {} steps",
                       subject.id, result.steps);
    return Access::make<Policy>(
        evo::make_policy_file(subject, arena, settings, options.seed, result, evo::created_by()));
  });
}

}  // namespace libevo
