#include "libevo/control/ppo_training.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "libevo/base/error.h"
#include "libevo/control/transfer.h"

namespace evo {
namespace {

// One body learns as much from 1 024 samples an update as from 4 096, and sooner
// (benchmarks/modular): where robots are fewer than an update is meant for, its rollout is
// longer, but not longer than this.
constexpr std::int64_t longest_rollout = 128;

int robots_of(const TrainingJob& job) { return static_cast<int>(job.robots.size()); }

// How many groups of robots take turns.
int groups_in(const TrainingJob& job) {
  const int most = job.settings.robots_per_update;
  return most > 0 ? (robots_of(job) + most - 1) / most : 1;
}

// ---- the first policy -------------------------------------------------------------------

// On a base where one is inherited.
Policy first_policy(const TrainingJob& job) {
  if (job.settings.keep_sequence && !job.inheritance)
    throw error(Failure::usage,
                "training: keep_sequence needs a controller to start from (--init)");
  const Arena& arena = job.arena();
  const Physics& physics = arena.task().physics;
  Policy fresh = initial_policy(job.settings, arena.observation_length(), arena.action_length(),
                                physics.min_target, physics.max_target, inherited_base(job),
                                Stream(job.seed, "train/initial", job.robot_id));
  if (!job.inheritance) return fresh;
  const Inheritance& old = *job.inheritance;
  const auto* policy = std::get_if<Policy>(&old.controller);
  if (policy == nullptr) return fresh;
  fresh.log_std.setConstant(static_cast<float>(job.settings.inherited_log_std));
  return transferred(*policy, old.anatomy, fresh, anatomy(arena));
}

void require(bool same, const std::string& what) {
  if (!same)
    throw error(Failure::data,
                "the controller to start from has other {} than the settings ask for", what);
}

bool same_shape(const ModularNetwork& a, const ModularNetwork& b) {
  if (a.bias.size() != b.bias.size() || a.rest.layers.size() != b.rest.layers.size()) return false;
  for (std::size_t l = 0; l < a.rest.layers.size(); ++l)
    if (a.rest.layers[l].weight.cols() != b.rest.layers[l].weight.cols() ||
        a.rest.layers[l].weight.rows() != b.rest.layers[l].weight.rows())
      return false;
  return true;
}

// What is inherited is for any body as it is.
ModularPolicy first_modular_policy(const TrainingJob& job) {
  const Physics& physics = job.arena().task().physics;
  ModularPolicy fresh = initial_modular_policy(job.settings, VoxelViews(job.arena()).task_length(),
                                               physics.min_target, physics.max_target,
                                               Stream(job.seed, "train/initial", job.robot_id));
  if (!job.inheritance) return fresh;
  const auto* old = std::get_if<ModularPolicy>(&job.inheritance->controller);
  if (old == nullptr)
    throw error(Failure::usage, "training: {} can start from a modular policy only",
                word(Algorithm::modular));
  require(old->task_length() == fresh.task_length(), "inputs of the task");
  require(same_shape(old->actor, fresh.actor) && same_shape(old->critic, fresh.critic),
          "hidden layers");
  require(old->clock == fresh.clock, "clocks");
  require(old->action_map == fresh.action_map && old->action_offset == fresh.action_offset,
          "actions (action_map, action_offset)");
  ModularPolicy policy = *old;
  policy.log_std.setConstant(static_cast<float>(job.settings.inherited_log_std));
  policy.local.count = std::min(policy.local.count, 10.0 * memory_of_another_body);  // of voxels
  policy.task.count = std::min(policy.task.count, memory_of_another_body);
  return policy;
}

// ---- what differs with the policy -------------------------------------------------------

template <typename Passes>
struct Kind;

template <>
struct Kind<PolicyPasses> {
  static TrainingSettings settings_for(const TrainingJob& job) { return job.settings; }
  static Policy first(const TrainingJob& job) { return first_policy(job); }
  static PolicyPasses passes(const TrainingJob& job) {
    return {first_policy(job), job.settings.environments};
  }
};

template <>
struct Kind<ModularPasses> {
  static TrainingSettings settings_for(const TrainingJob& job) {
    TrainingSettings settings = job.settings;
    const int robots = robots_of(job);
    settings.environments *= robots;
    const std::int64_t as_many =
        std::int64_t{settings.rollout} * (settings.robots_per_update / robots);
    const std::int64_t most = std::min(longest_rollout, settings.steps / settings.environments);
    settings.rollout = std::max(settings.rollout, static_cast<int>(std::min(as_many, most)));
    TrainingSettings of_smallest = settings;
    of_smallest.environments = job.settings.environments * (robots / groups_in(job));
    evo::check(of_smallest);
    if (settings.updates() < 1)
      throw error(Failure::usage, "training: {} steps are less than one rollout of {} x {}",
                  settings.steps, settings.environments, settings.rollout);
    return settings;
  }
  static ModularPolicy first(const TrainingJob& job) { return first_modular_policy(job); }
  static ModularPasses passes(const TrainingJob& job) {
    return {first_modular_policy(job), job.robots, job.settings.environments, groups_in(job)};
  }
};

// Each robot's environments lie side by side: the simulator takes them together.
std::vector<const Arena*> arenas_of(const TrainingJob& job) {
  std::vector<const Arena*> arenas;
  for (const Arena* robot : job.robots)
    arenas.insert(arenas.end(), static_cast<std::size_t>(job.settings.environments), robot);
  return arenas;
}

}  // namespace

TrainedController inherited_controller(const TrainingJob& job) {
  const Inheritance& old = *job.inheritance;
  if (std::holds_alternative<Policy>(old.controller)) return first_policy(job);
  if (const auto* sequence = std::get_if<ReplayController>(&old.controller))
    return transferred(*sequence, old.anatomy, anatomy(job.arena()));
  return *inherited_gait(job);
}

template <typename Passes>
void PpoTraining<Passes>::check(const TrainingSettings& s) {
  if (for_any && s.hidden.size() < 2)
    throw error(Failure::usage, "training: {} needs two layers in hidden at least",
                word(algorithm));
  if (for_any && s.moment_share > 0.0)
    throw error(Failure::usage, "training: moment_share is {}; {} has no moments to start from",
                s.moment_share, word(algorithm));
  if (s.updates() < 1)
    throw error(Failure::usage, "training: {} steps are less than one rollout of {} x {}", s.steps,
                s.environments, s.rollout);
}

template <typename Passes>
PpoTraining<Passes>::PpoTraining(const TrainingJob& job)
    : settings_(Kind<Passes>::settings_for(job)),
      seed_(job.seed),
      env_(arenas_of(job)),
      begun_(static_cast<std::size_t>(env_.environments()), 0),
      returns_(begun_.size(), 0.0),
      ppo_(settings_, Kind<Passes>::passes(job), job.seed, job.robot_id) {
  if (settings_.moment_share > 0.0) add_moments(job);
  for (int e = 0; e < settings_.environments; ++e) start_episode(e);
  observe();
}

template <typename Passes>
bool PpoTraining<Passes>::done(const TrainingJob&, const TrainResult&) const {
  return ppo_.updates() >= ppo_.updates_in_all();
}

template <typename Passes>
void PpoTraining<Passes>::advance(const TrainingJob& job, TrainResult& result, Metrics& metrics) {
  // What was inherited counts as it is, before it has seen anything.
  if (job.inheritance && result.curve.empty()) evaluate(job, Kind<Passes>::first(job), result);

  std::vector<double> returns;
  const std::size_t first = ppo_.first_environment();
  const std::size_t count = ppo_.environments();
  active_.assign(returns_.size(), 0);
  std::fill_n(active_.begin() + static_cast<std::ptrdiff_t>(first), count, std::uint8_t{1});
  if (for_any && ppo_.updates() > 0) observe();  // others have stepped meanwhile
  for (int t = 0; t < settings_.rollout; ++t) {
    step(job, returns);
    result.steps += static_cast<std::int64_t>(count);
  }
  const UpdateReport update = ppo_.learn();

  metrics = {{"charts/learning_rate", update.learning_rate},
             {"losses/policy_loss", update.losses.policy},
             {"losses/value_loss", update.losses.value},
             {"losses/entropy", update.losses.entropy},
             {"losses/approx_kl", update.losses.approx_kl},
             {"losses/clipfrac", update.losses.clipfrac},
             {"losses/explained_variance", update.explained_variance}};
  if (!returns.empty()) metrics.push_back({"charts/episodic_return", mean(returns)});
  if (ppo_.updates() % settings_.evaluation_interval == 0 || done(job, result)) {
    evaluate(job, ppo_.policy(), result);
    report_evaluation(result, metrics);
  }
}

template <typename Passes>
void PpoTraining<Passes>::serialize(const Archive& archive) {
  ppo_.serialize(archive.part("learner"));
  std::vector<std::uint8_t> state = env_.save();
  archive.array("environments/state", state);
  if (archive.loads()) env_.load(state);
  archive.row<std::uint64_t>("environments/next_episode", begun_);
  archive.row<double>("environments/episode_return", returns_);
}

// Every state but the last of one episode of the inherited controller from the exact start; of
// one that becomes unstable what was before.
template <typename Passes>
void PpoTraining<Passes>::add_moments(const TrainingJob& job) {
  if (!job.inheritance)
    throw error(Failure::usage,
                "training: moment_share is {}; moments need a controller to start from (--init)",
                settings_.moment_share);
  EvaluationSettings episode;
  episode.seed = job.seed;
  double sum = 0.0;
  const auto keep = [&](const EpisodeMoment& now) {
    if (!now.targets.empty()) sum += now.env.rewards()[static_cast<std::size_t>(now.lane)];
    moments_.push_back({now.env.save(now.lane), sum});
  };
  try {
    evaluate(job.arena(), inherited_controller(job), episode, keep);
  } catch (const Error& failure) {
    if (failure.kind() != Failure::work) throw;
  }
  moments_.pop_back();
}

template <typename Passes>
void PpoTraining<Passes>::start_episode(int environment) {
  const auto e = static_cast<std::size_t>(environment);
  const std::uint64_t episode = begun_[e]++;
  const std::uint64_t seed = derive_seed(seed_, "train", e);
  const std::uint64_t jitter_seed = derive_seed(seed, "jitter", episode);
  Stream random(seed, "moment", episode);
  if (!moments_.empty() && random.uniform() < settings_.moment_share) {
    const Moment& moment = moments_[random.below(static_cast<std::uint32_t>(moments_.size()))];
    env_.load(environment, moment.state);
    env_.perturb(environment, settings_.moment_jitter, jitter_seed);
    returns_[e] = moment.return_so_far;
    return;
  }
  env_.reset(environment,
             {env_.arena(environment).draw(seed, episode), settings_.start_jitter, jitter_seed});
  returns_[e] = 0.0;
}

template <typename Passes>
const std::vector<int>& PpoTraining<Passes>::steps() {
  steps_.clear();
  for (int e = 0; e < env_.environments(); ++e) steps_.push_back(env_.steps(e));
  return steps_;
}

template <typename Passes>
void PpoTraining<Passes>::step(const TrainingJob& job, std::vector<double>& returns) {
  env_.step(ppo_.act(), active_);
  if (job.robots.size() == 1) require_stable(env_);
  rewards_.assign(env_.rewards().begin(), env_.rewards().end());
  terminated_.assign(env_.terminated().begin(), env_.terminated().end());
  truncated_.assign(env_.truncated().begin(), env_.truncated().end());
  for (std::size_t e = 0; e < rewards_.size(); ++e) {
    if (active_[e] == 0) continue;
    const int environment = static_cast<int>(e);
    // One body that flies apart ends its episode, not the training of all others.
    if (env_.status(environment) == LaneStatus::unstable) {
      rewards_[e] = 0.0;
      terminated_[e] = 1;
    }
    returns_[e] += rewards_[e];
    rewards_[e] = learned_reward(rewards_[e], terminated_[e] != 0, settings_);
    if (for_any && begun_[e] == 1 && env_.steps(environment) >= first_length(environment))
      truncated_[e] = 1;
  }
  ppo_.reward(rewards_, terminated_, truncated_, Passes::seen(env_), steps());
  for (std::size_t e = 0; e < rewards_.size(); ++e) {
    if (active_[e] == 0 || (terminated_[e] == 0 && truncated_[e] == 0)) continue;
    if (!for_any || begun_[e] > 1) returns.push_back(returns_[e]);
    start_episode(static_cast<int>(e));
  }
  observe();
}

// First episodes of many robots are cut short, in steps, each after another share of the time,
// so that a rollout sees all parts of an episode and not the same one of all robots.
template <typename Passes>
int PpoTraining<Passes>::first_length(int environment) const {
  // Multiples of the golden ratio are spread evenly however many there are.
  const double share = std::fmod((environment + 1) / std::numbers::phi, 1.0);
  return 1 + static_cast<int>(share * env_.arena(environment).task().episode_steps);
}

template class PpoTraining<PolicyPasses>;
template class PpoTraining<ModularPasses>;

}  // namespace evo
