// A learner for environments of a caller's own, of evo/evo.h.
#include "bindings/c/handles.h"
#include "formats/training/training.h"
#include "libevo/control/methods.h"

using namespace evo::c;  // NOLINT(google-build-using-namespace)
using evo::Failure;

struct evo_learner {
  static constexpr const char* kind = "evo_learner";

  evo_learner(const evo::TrainingSettings& chosen, std::uint64_t from, const std::string& name,
              int observed, int acted, double low, double high)
      : settings(chosen),
        seed(from),
        observations(static_cast<std::size_t>(observed)),
        actions(static_cast<std::size_t>(acted)),
        ppo(settings,
            {evo::initial_policy(settings, observed, acted, low, high, std::nullopt,
                                 evo::Stream(seed, "train/initial", name)),
             settings.environments},
            seed, name) {}

  // What a rollout consists of, in this order; learn() comes where act() would begin it anew.
  static constexpr std::string_view observe = "evo_learner_observe";
  static constexpr std::string_view act = "evo_learner_act";
  static constexpr std::string_view reward = "evo_learner_reward";
  static constexpr std::string_view learn = "evo_learner_learn";
  std::size_t environments() const { return static_cast<std::size_t>(settings.environments); }
  void expect(std::string_view call) const {
    if (call != next) throw evo::error(Failure::usage, "{} is out of turn: {} is next", call, next);
  }

  evo::TrainingSettings settings;
  std::uint64_t seed;
  std::size_t observations;  // of an environment
  std::size_t actions;
  evo::Ppo<evo::PolicyPasses> ppo;
  std::optional<evo::Error> failure;  // its numbers have left the finite ones
  std::string_view next = observe;
  int rounds = 0;  // of the rollout
  std::vector<double> learned;
  std::mutex busy;
};

namespace {

// Changes a learner; nothing may follow once its numbers have left the finite ones.
template <typename Work>
int teach(evo_learner* learner, const Work& work) {
  return change(learner, [&](evo_learner& own) {
    if (own.failure) throw *own.failure;
    try {
      work(own);
    } catch (const evo::Error& e) {
      if (e.kind() == Failure::work) own.failure = e.at("the training");
      throw own.failure.value_or(e);
    }
  });
}

void require_finite(std::span<const double> values, const char* what) {
  for (const double value : values)
    if (!std::isfinite(value)) throw evo::error(Failure::work, "{} is not a finite number", what);
}

// As the suite counts bad ends: by the share that the settings say.
std::span<const double> learned_rewards(evo_learner& own, const double* rewards,
                                        const std::uint8_t* terminated) {
  own.learned.assign(rewards, rewards + own.environments());
  require_finite(own.learned, "a reward");
  for (std::size_t e = 0; e < own.learned.size(); ++e)
    own.learned[e] = evo::learned_reward(own.learned[e], terminated[e] != 0, own.settings);
  return own.learned;
}

}  // namespace

int evo_learner_open(const evo_training* training, size_t size, int32_t observation_length,
                     int32_t action_length, double low, double high, const char* name,
                     evo_learner** learner) {
  return open(learner, [&] {
    const evo_training wanted = taken(training, size);
    const evo::TrainingSettings settings = settings_of(wanted);
    if (!evo::abilities(settings.algorithm).own_tasks)
      throw evo::error(Failure::usage, "a learner is of {}; algorithm {} needs a task of the suite",
                       evo::algorithm_that(&evo::Abilities::own_tasks), word(settings.algorithm));
    if (settings.updates() < 1)
      throw evo::error(Failure::usage, "{} steps are less than one rollout of {} x {}",
                       settings.steps, settings.environments, settings.rollout);
    if (settings.moment_share != 0.0)
      throw evo::Error(Failure::usage, "moment_share needs a task of the suite");
    constexpr int most = 1 << 20;
    if (observation_length < 1 || action_length < 1 || observation_length > most ||
        action_length > most)
      throw evo::error(Failure::usage, "{} observations and {} actions: 1 or more are expected",
                       observation_length, action_length);
    if (!(low < high) || !(high - low < 1e300))
      throw evo::error(Failure::usage, "actions from {} to {} make no range", low, high);
    return std::make_unique<evo_learner>(settings, wanted.seed, text_of(name, "name"),
                                         observation_length, action_length, low, high);
  });
}

void evo_learner_free(evo_learner* learner) { close(learner); }

int evo_learner_describe(const evo_learner* learner, evo_learner_facts* facts, size_t size) {
  return guarded([&] {
    const evo_learner& own = object_of(learner);
    hand_over({own.settings.environments, own.settings.rollout, own.settings.updates(),
               own.settings.evaluation_interval, own.settings.evaluation_episodes,
               own.settings.evaluation_jitter, own.settings.start_jitter, own.settings.final_jitter,
               own.settings.final_episodes, 0},
              facts, size);
  });
}

int evo_learner_observe(evo_learner* learner, const double* observations, size_t values,
                        const int32_t* steps, size_t environments) {
  return teach(learner, [&](evo_learner& own) {
    own.expect(evo_learner::observe);
    check_count(environments, own.environments(), "environments");
    check_count(values, own.environments() * own.observations, "observations");
    target(observations, "observations");
    target(steps, "steps");
    require_finite({observations, values}, "an observation");
    own.ppo.observe({observations, values}, {steps, environments});
    own.next = own.rounds == own.settings.rollout ? evo_learner::learn : evo_learner::act;
  });
}

int evo_learner_act(evo_learner* learner, double* actions, size_t values) {
  return teach(learner, [&](evo_learner& own) {
    own.expect(evo_learner::act);
    check_count(values, own.environments() * own.actions, "actions");
    target(actions, "actions");
    const std::span<const double> chosen = own.ppo.act();
    require_finite(chosen, "an action");
    std::ranges::copy(chosen, actions);
    own.next = evo_learner::reward;
  });
}

int evo_learner_reward(evo_learner* learner, const double* rewards, const uint8_t* terminated,
                       const uint8_t* truncated, const double* reached, size_t values,
                       const int32_t* steps, size_t environments) {
  return teach(learner, [&](evo_learner& own) {
    own.expect(evo_learner::reward);
    check_count(environments, own.environments(), "environments");
    check_count(values, own.environments() * own.observations, "observations");
    target(rewards, "rewards");
    target(terminated, "terminated");
    target(truncated, "truncated");
    target(reached, "reached");
    target(steps, "steps");
    own.ppo.reward(learned_rewards(own, rewards, terminated), {terminated, environments},
                   {truncated, environments}, {reached, values}, {steps, environments});
    ++own.rounds;
    own.next = evo_learner::observe;
  });
}

int evo_learner_learn(evo_learner* learner) {
  return teach(learner, [](evo_learner& own) {
    if (own.next != evo_learner::learn)
      throw evo::error(Failure::usage,
                       "the rollout has {} of its {} rounds of act, reward, observe", own.rounds,
                       own.settings.rollout);
    own.ppo.learn();
    own.rounds = 0;
    own.next = evo_learner::act;
  });
}

int evo_learner_policy(const evo_learner* learner, const evo_robots* robots, size_t index,
                       const char* task, const evo_curve_point* curve, size_t points,
                       evo_policy** policy) {
  return open(policy, [&] {
    const evo_learner& own = object_of(learner);
    if (curve == nullptr && points > 0) throw evo::Error(Failure::usage, "`curve` is NULL");
    evo::PolicyFile file;
    file.robot = robot_at(object_of(robots), index);
    file.task = text_of(task, "task");  // without task_yaml and physics_yaml: see policy_task
    file.training_yaml = evo::training_profiles().to_yaml(own.settings);
    file.layout = {{"own", 0, static_cast<int>(own.observations)}};
    file.seed = own.seed;
    file.created_by = evo::created_by();
    file.controller = own.ppo.policy();
    file.steps = own.ppo.updates() * own.settings.batch();
    for (std::size_t i = 0; i < points; ++i) {
      file.curve.push_back({curve[i].step, curve[i].evaluation, curve[i].best});
      file.fitness = curve[i].best;
      file.best_step = curve[i].step;
    }
    return policy_of(std::move(file));
  });
}
