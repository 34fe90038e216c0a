#include "libevo/control/ppo_training.h"

#include <utility>

#include "libevo/base/error.h"
#include "libevo/control/transfer.h"

namespace evo {
namespace {

// On a base where one is inherited.
Policy first_policy(const TrainingJob& job) {
  if (job.settings.keep_sequence && !job.inheritance)
    throw error(Failure::usage,
                "training: keep_sequence needs a controller to start from (--init)");
  Policy fresh = initial_policy(job, inherited_base(job));
  if (!job.inheritance) return fresh;
  const Inheritance& old = *job.inheritance;
  const Anatomy to = anatomy(job.arena.robot(), job.arena.layout());
  const auto* policy = std::get_if<Policy>(&old.controller);
  if (policy == nullptr) return fresh;
  fresh.log_std.setConstant(static_cast<float>(job.settings.inherited_log_std));
  return transferred(*policy, old.anatomy, fresh, to);
}

// What is inherited, on this job's robot.
Controller inherited_controller(const TrainingJob& job) {
  const Inheritance& old = *job.inheritance;
  if (std::holds_alternative<Policy>(old.controller)) return first_policy(job);
  if (const auto* sequence = std::get_if<ReplayController>(&old.controller))
    return transferred(*sequence, old.anatomy, anatomy(job.arena.robot(), job.arena.layout()));
  return *inherited_gait(job);
}

// One episode of the inherited controller from the exact start; of one that becomes unstable
// what was before.
Demonstration inherited_demonstration(const TrainingJob& job) {
  EvaluationSettings episode;
  episode.seed = job.seed;
  Demonstration demonstration{"the inherited controller",
                              start_of(job.arena, episode, 0),
                              {{}, job.arena.action_length()},
                              {}};
  const auto keep = [&](const EpisodeMoment& now) {
    if (now.targets.empty()) return;
    std::vector<double>& actions = demonstration.actions.actions;
    actions.insert(actions.end(), now.targets.begin(), now.targets.end());
    demonstration.rewards.push_back(now.env.rewards()[static_cast<std::size_t>(now.lane)]);
  };
  try {
    evaluate(job.arena, inherited_controller(job), episode, keep);
  } catch (const Error& failure) {
    if (failure.kind() != Failure::work) throw;
  }
  return demonstration;
}

std::vector<Demonstration> demonstrations_of(const TrainingJob& job) {
  if (job.settings.moment_share == 0.0) {
    if (job.demonstrations.empty()) return {};
    throw error(Failure::usage,
                "training: no episode begins at a moment while moment_share is 0; the profile "
                "'moments' has 0.7");
  }
  if (!job.demonstrations.empty()) return job.demonstrations;
  if (!job.inheritance)
    throw error(Failure::usage,
                "training: moment_share is {}; moments need a controller to start from (--init), "
                "or recorded episodes (--moments)",
                job.settings.moment_share);
  return {inherited_demonstration(job)};
}

}  // namespace

void PpoTraining::check(const TrainingSettings& s) {
  if (s.updates() < 1)
    throw error(Failure::usage, "training: {} steps are less than one rollout of {} x {}", s.steps,
                s.environments, s.rollout);
}

PpoTraining::PpoTraining(const TrainingJob& job)
    : episodes_(VecEnv(job.arena, job.settings.environments), job.seed),
      ppo_(job.settings, first_policy(job), job.seed, job.robot_id) {
  for (const Demonstration& demonstration : demonstrations_of(job))
    add_moments(job.arena, demonstration);
  for (int e = 0; e < job.settings.environments; ++e) start_episode(job, e);
  observe();
}

bool PpoTraining::done(const TrainingJob& job, const Findings&) const {
  return ppo_.updates() >= job.settings.updates();
}

void PpoTraining::advance(const TrainingJob& job, Findings& findings, Metrics& metrics) {
  // What was inherited counts as it is, before it has seen anything.
  if (job.inheritance && findings.curve.empty()) evaluate(job, first_policy(job), findings);

  std::vector<double> returns;
  for (int t = 0; t < job.settings.rollout; ++t) {
    step(job, returns);
    findings.steps += job.settings.environments;
    require_finite();
  }
  const UpdateReport update = ppo_.learn();
  require_finite();

  metrics = update_metrics(update, returns);
  if (ppo_.updates() % job.settings.evaluation_interval == 0 || done(job, findings)) {
    evaluate(job, ppo_.policy(), findings);
    report_evaluation(findings, metrics);
  }
}

void PpoTraining::save(Checkpoint& checkpoint) const {
  ppo_.save(checkpoint);
  episodes_.save(checkpoint);
}

void PpoTraining::load(const Checkpoint& checkpoint) {
  ppo_.load(checkpoint);
  episodes_.load(checkpoint);
}

// Every state of the episode but its last.
void PpoTraining::add_moments(const Arena& arena, const Demonstration& demonstration) {
  const auto& [name, start, replay, rewards] = demonstration;
  const auto actuators = static_cast<std::size_t>(arena.action_length());
  if (replay.actions.size() != rewards.size() * actuators)
    throw error(Failure::data, "{}: has {} actions in {} steps; this robot has {} actuators", name,
                replay.actions.size(), rewards.size(), actuators);
  if (!ppo::all_finite(replay.actions))
    throw error(Failure::data, "{}: an action is not a finite number", name);
  VecEnv env(arena, 1);
  env.reset(0, start);
  double sum = 0.0;
  for (std::size_t t = 0; t < rewards.size(); ++t) {
    moments_.push_back({env.save(0), sum});
    env.step(std::span(replay.actions).subspan(t * actuators, actuators));
    require_stable(env);
    if (env.rewards()[0] != rewards[t])
      throw error(Failure::data,
                  "{}: step {} earned {}, and earns {} here; was it recorded with another robot, "
                  "task or physics?",
                  name, t, rewards[t], env.rewards()[0]);
    sum += rewards[t];
    if (env.terminated()[0] != 0 || env.truncated()[0] != 0) return;
  }
}

void PpoTraining::start_episode(const TrainingJob& job, int environment) {
  const EpisodeSeeds seeds = episodes_.next(environment);
  Stream random(seeds.stream, "moment", seeds.episode);
  if (!moments_.empty() && random.uniform() < job.settings.moment_share) {
    const Moment& moment = moments_[random.below(static_cast<std::uint32_t>(moments_.size()))];
    episodes_.env.load(environment, moment.state);
    episodes_.env.perturb(environment, job.settings.moment_jitter, seeds.jitter);
    episodes_.returns[static_cast<std::size_t>(environment)] = moment.return_so_far;
    return;
  }
  episodes_.reset(environment, seeds, job.settings.start_jitter);
}

void PpoTraining::step(const TrainingJob& job, std::vector<double>& returns) {
  const std::span<const double> targets = ppo_.act();
  require_finite();
  VecEnv& env = episodes_.env;
  env.step(targets);
  require_stable(env);
  ppo_.reward(learned_rewards(job.settings.failure_weight), env.terminated(), env.truncated(),
              env.observations(), episodes_.steps());
  for (int e = 0; e < env.environments(); ++e) {
    const auto i = static_cast<std::size_t>(e);
    episodes_.returns[i] += env.rewards()[i];
    if (env.terminated()[i] == 0 && env.truncated()[i] == 0) continue;
    returns.push_back(episodes_.returns[i]);
    start_episode(job, e);
  }
  observe();
}

// Rewards, but for bad ends, which count as much as the settings say.
std::span<const double> PpoTraining::learned_rewards(double failure_weight) {
  const VecEnv& env = episodes_.env;
  learned_rewards_.assign(env.rewards().begin(), env.rewards().end());
  for (std::size_t e = 0; e < learned_rewards_.size(); ++e)
    if (env.terminated()[e] != 0 && learned_rewards_[e] < 0.0)
      learned_rewards_[e] *= failure_weight;
  return learned_rewards_;
}

void PpoTraining::observe() { ppo_.observe(episodes_.env.observations(), episodes_.steps()); }

void PpoTraining::require_finite() const {
  if (ppo_.divergence()) throw Error(Failure::work, *ppo_.divergence());
}

}  // namespace evo
