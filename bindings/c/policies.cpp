// Controllers of evo/evo.h.
#include <cmath>
#include <variant>

#include "bindings/c/handles.h"
#include "formats/training/training.h"
#include "libevo/control/trainer.h"

using namespace evo::c;  // NOLINT(google-build-using-namespace)
using evo::Failure;

namespace {

std::size_t observation_length(const evo::PolicyFile& file) {
  if (std::holds_alternative<evo::ModularPolicy>(file.controller)) return 0;
  int length = 0;
  for (const evo::ObservationSlice& slice : file.layout) length += slice.length;
  return static_cast<std::size_t>(length);
}

std::size_t action_length(const evo::TrainedController& controller) {
  if (const auto* network = std::get_if<evo::Policy>(&controller))
    return static_cast<std::size_t>(network->action_length());
  if (const auto* sequence = std::get_if<evo::ReplayController>(&controller))
    return static_cast<std::size_t>(sequence->actuators);
  if (const auto* sine = std::get_if<evo::SineController>(&controller))
    return sine->amplitude.size();
  return 0;
}

}  // namespace

namespace evo::c {

std::unique_ptr<evo_policy> policy_of(evo::PolicyFile file) {
  std::vector<evo_curve_point> curve;
  for (const evo::CurvePoint& p : file.curve) curve.push_back({p.step, p.evaluation, p.best});
  return std::unique_ptr<evo_policy>(
      new evo_policy{std::make_shared<evo::PolicyFile>(std::move(file)), std::move(curve), {}});
}

evo::TrainingSettings settings_of(const evo_training& training) {
  evo::TrainingSettings settings = evo::training_profiles().load(
      training.profile == nullptr ? "default" : training.profile, data_folders());
  for (const std::string& setting : texts_of(training.set, training.set_count, "set"))
    evo::training_profiles().assign(settings, setting);
  if (training.steps != 0)
    evo::training_profiles().assign(settings, "steps=" + std::to_string(training.steps));
  evo::check(settings);
  return settings;
}

}  // namespace evo::c

int evo_policy_read(const char* file, evo_policy** policy) {
  return open(policy, [&] { return policy_of(evo::read_policy(text_of(file, "file"))); });
}

int evo_policy_write(const evo_policy* policy, const char* file) {
  return guarded([&] { evo::write_policy(text_of(file, "file"), *object_of(policy).file); });
}

void evo_policy_free(evo_policy* policy) { close(policy); }

int evo_policy_set_final(evo_policy* policy, int32_t episodes, double mean, double standard_error) {
  return change(policy, [&](evo_policy& own) {
    if (episodes < 1 || !std::isfinite(mean) || !(standard_error >= 0.0))
      throw evo::error(Failure::usage, "{} episodes, a mean of {} +- {} are no final score",
                       episodes, mean, standard_error);
    own.file->final_score = evo::FinalScore{episodes, mean, standard_error};
  });
}

int evo_policy_describe(const evo_policy* policy, evo_policy_facts* facts, size_t size) {
  return guarded([&] {
    const evo_policy& described = object_of(policy);
    hand_over({observation_length(*described.file), action_length(described.file->controller),
               described.file->fitness, described.curve.size(), described.curve.data(),
               described.file->seed},
              facts, size);
  });
}

int evo_policy_task(const evo_policy* policy, evo_task** task) {
  return open(task,
              [&] { return task_of(evo::policy_task(*object_of(policy).file, "the policy")); });
}

int evo_policy_act(const evo_policy* policy, const double* observations, const int32_t* steps,
                   size_t count, double* actions, size_t action_values) {
  return guarded([&] {
    const evo::PolicyFile& file = *object_of(policy).file;
    if (std::holds_alternative<evo::ModularPolicy>(file.controller))
      throw evo::Error(
          Failure::usage,
          "a modular policy acts on voxels, not on an observation: evo_envs_act lets it "
          "act in environments");
    const std::size_t wide = observation_length(file);
    const std::size_t targets = action_length(file.controller);
    if (action_values != count * targets)
      throw evo::error(Failure::usage, "for {} steps, {} actions of {} are expected, not {} values",
                       count, count, targets, action_values);
    if (count == 0) return;
    target(observations, "observations");
    target(steps, "steps");
    target(actions, "actions");
    const std::span out(actions, action_values);
    const evo::TrainedController& controller = file.controller;
    if (const auto* network = std::get_if<evo::Policy>(&controller)) {
      evo::act(*network, {observations, count * wide}, {steps, count}, out);
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = out.subspan(i * targets, targets);
      if (const auto* sequence = std::get_if<evo::ReplayController>(&controller))
        evo::act(*sequence, steps[i], row);
      else
        evo::act(std::get<evo::SineController>(controller), steps[i], row);
    }
  });
}

int evo_train(const evo_task* task, const evo_robots* robots, size_t index,
              const evo_training* training, size_t size, evo_policy** policy) {
  return open(policy, [&] {
    const evo_training wanted = taken(training, size);
    const evo::TaskSpec& spec = object_of(task).spec;
    const evo::Robot& robot = robot_at(object_of(robots), index);
    const evo::TrainingSettings settings = settings_of(wanted);
    const evo::Arena arena(spec, robot.body);
    evo::Trainer trainer(arena, settings, wanted.seed, robot.id);
    const evo::TrainResult result =
        evo::train(trainer, [&](const evo::Trainer&, const evo::TrainingReport& report) {
          return wanted.go_on == nullptr || wanted.go_on(report.step, wanted.user) != 0;
        });
    if (result.failure)
      throw evo::error(Failure::work, "robot {}: {}", robot.id, result.failure->why);
    if (!trainer.done())
      throw evo::error(Failure::work, "robot {}: the training was ended after {} steps", robot.id,
                       result.steps);
    return policy_of(
        evo::make_policy_file(robot, arena, settings, wanted.seed, result, evo::created_by()));
  });
}
