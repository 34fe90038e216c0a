#include "libevo/control/modular_training.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "libevo/base/error.h"

namespace evo {
namespace {

// No more observations stand behind inherited moments than these, so that they adapt.
constexpr double memory = 10000.0;  // of environments
constexpr double voxel_memory = 10.0 * memory;

// One body learns as much from 1 024 samples an update as from 4 096, and sooner
// (benchmarks/modular): where robots are fewer than an update is meant for, its rollout is
// longer, but not longer than this.
constexpr std::int64_t longest_rollout = 128;

int robots_of(const TrainingJob& job) { return 1 + static_cast<int>(job.others.size()); }

// How many take turns.
int groups_in(const TrainingJob& job) {
  const int most = job.settings.robots_per_update;
  return most > 0 ? (robots_of(job) + most - 1) / most : 1;
}

TrainingSettings settings_for(const TrainingJob& job) {
  TrainingSettings settings = job.settings;
  const int robots = robots_of(job);
  settings.environments *= robots;
  const std::int64_t as_many =
      std::int64_t{settings.rollout} * (settings.robots_per_update / robots);
  const std::int64_t most = std::min(longest_rollout, settings.steps / settings.environments);
  settings.rollout = std::max(settings.rollout, static_cast<int>(std::min(as_many, most)));
  TrainingSettings of_smallest = settings;
  of_smallest.environments = job.settings.environments * (robots / groups_in(job));
  check(of_smallest);
  if (settings.updates() < 1)
    throw error(Failure::usage, "training: {} steps are less than one rollout of {} x {}",
                settings.steps, settings.environments, settings.rollout);
  return settings;
}

// Each robot's environments lie side by side: the simulator takes them together.
std::vector<const Arena*> arenas_of(const TrainingJob& job) {
  std::vector<const Arena*> arenas;
  for (const Arena* robot : job.arenas())
    arenas.insert(arenas.end(), static_cast<std::size_t>(job.settings.environments), robot);
  return arenas;
}

// The robots in their order, as evenly as can be in groups of `robots_per_update`.
std::vector<Group> groups_of(const TrainingJob& job) {
  const std::vector<const Arena*> robots = job.arenas();
  const auto count = static_cast<std::size_t>(groups_in(job));
  std::vector<Group> groups;
  for (std::size_t g = 0; g < count; ++g) {
    const std::size_t begin = g * robots.size() / count;
    const std::size_t end = (g + 1) * robots.size() / count;
    std::vector<int> body_of;
    for (std::size_t robot = begin; robot < end; ++robot)
      body_of.insert(body_of.end(), static_cast<std::size_t>(job.settings.environments),
                     static_cast<int>(robot - begin));
    groups.push_back({Bodies(std::span(robots).subspan(begin, end - begin)), std::move(body_of)});
  }
  return groups;
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
ModularPolicy first_policy(const TrainingJob& job) {
  ModularPolicy fresh = initial_modular_policy(job);
  if (!job.inheritance) return fresh;
  const auto* old = std::get_if<ModularPolicy>(&job.inheritance->controller);
  if (old == nullptr)
    throw error(Failure::usage, "training: {} can start from a modular policy only",
                ModularTraining::name);
  require(old->task_length() == fresh.task_length(), "inputs of the task");
  require(old->exchange == fresh.exchange, "exchange between voxels");
  require(old->gating() == fresh.gating(), fmt::format("gates (gating={})", word(old->gating())));
  require(same_shape(old->actor, fresh.actor) && same_shape(old->critic, fresh.critic),
          "hidden layers");
  require(old->clock == fresh.clock, "clocks");
  require(old->action_map == fresh.action_map && old->action_offset == fresh.action_offset,
          "actions (action_map, action_offset)");
  ModularPolicy policy = *old;
  policy.log_std.setConstant(static_cast<float>(job.settings.inherited_log_std));
  policy.local.count = std::min(policy.local.count, voxel_memory);
  policy.task.count = std::min(policy.task.count, memory);
  return policy;
}

}  // namespace

ModularPolicy initial_modular_policy(const TrainingJob& job) {
  const Physics& physics = job.arena.task().physics;
  return initial_modular_policy(job.settings, VoxelViews(job.arena).task_length(),
                                physics.min_target, physics.max_target,
                                Stream(job.seed, "train/initial", job.robot_id));
}

void ModularTraining::check(const TrainingSettings& s) {
  if (s.hidden.empty())
    throw error(Failure::usage, "training: hidden is []; {} needs one layer at least", name);
  if (s.moment_share > 0.0)
    throw error(Failure::usage, "training: moment_share is {}; {} has no moments to start from",
                s.moment_share, name);
}

ModularTraining::ModularTraining(const TrainingJob& job)
    : settings_(settings_for(job)),
      groups_(groups_of(job)),
      episodes_(VecEnv(arenas_of(job)), job.seed),
      ppo_(settings_, first_policy(job), groups_, job.seed, job.robot_id) {
  for (int e = 0; e < settings_.environments; ++e) start_episode(e);
}

bool ModularTraining::done(const TrainingJob&, const Findings&) const {
  return ppo_.updates() >= ppo_.updates_in_all();
}

void ModularTraining::advance(const TrainingJob& job, Findings& findings, Metrics& metrics) {
  if (job.inheritance && findings.curve.empty()) evaluate(job, first_policy(job), findings);

  std::vector<double> returns;
  const std::size_t first = ppo_.first_environment();
  const std::size_t last = ppo_.last_environment();
  active_.assign(episodes_.returns.size(), 0);
  std::fill(active_.begin() + static_cast<std::ptrdiff_t>(first),
            active_.begin() + static_cast<std::ptrdiff_t>(last), std::uint8_t{1});
  ppo_.observe(episodes_.env, episodes_.steps());
  for (int t = 0; t < settings_.rollout; ++t) {
    step(job, returns);
    findings.steps += static_cast<std::int64_t>(last - first);
    require_finite();
  }
  const UpdateReport update = ppo_.learn();
  require_finite();

  metrics = update_metrics(update, returns);
  if (ppo_.updates() % settings_.evaluation_interval == 0 || done(job, findings)) {
    evaluate(job, ppo_.policy(), findings);
    report_evaluation(findings, metrics);
  }
}

void ModularTraining::save(Checkpoint& checkpoint) const {
  ppo_.save(checkpoint);
  episodes_.save(checkpoint);
}

void ModularTraining::load(const Checkpoint& checkpoint) {
  ppo_.load(checkpoint);
  episodes_.load(checkpoint);
}

void ModularTraining::start_episode(int environment) {
  episodes_.reset(environment, episodes_.next(environment), settings_.start_jitter);
}

void ModularTraining::step(const TrainingJob& job, std::vector<double>& returns) {
  const std::span<const double> targets = ppo_.act();
  require_finite();
  VecEnv& env = episodes_.env;
  env.step(targets, active_);
  if (job.others.empty()) require_stable(env);
  rewards_.assign(env.rewards().begin(), env.rewards().end());
  terminated_.assign(env.terminated().begin(), env.terminated().end());
  truncated_.assign(env.truncated().begin(), env.truncated().end());
  for (std::size_t e = 0; e < rewards_.size(); ++e) {
    if (active_[e] == 0) continue;
    // One body that flies apart ends its episode, not the training of all others.
    if (env.status(static_cast<int>(e)) == LaneStatus::unstable) {
      rewards_[e] = 0.0;
      terminated_[e] = 1;
    }
    episodes_.returns[e] += rewards_[e];
    if (terminated_[e] != 0 && rewards_[e] < 0.0) rewards_[e] *= settings_.failure_weight;
    const int environment = static_cast<int>(e);
    if (episodes_.begun[e] == 1 && env.steps(environment) >= first_length(environment))
      truncated_[e] = 1;
  }
  ppo_.reward(rewards_, terminated_, truncated_, env, episodes_.steps());
  for (std::size_t e = 0; e < rewards_.size(); ++e) {
    if (active_[e] == 0 || (terminated_[e] == 0 && truncated_[e] == 0)) continue;
    if (episodes_.begun[e] > 1) returns.push_back(episodes_.returns[e]);
    start_episode(static_cast<int>(e));
  }
  ppo_.observe(env, episodes_.steps());
}

int ModularTraining::first_length(int environment) const {
  // Multiples of the golden ratio are spread evenly however many there are.
  const double share = std::fmod((environment + 1) / std::numbers::phi, 1.0);
  return 1 + static_cast<int>(share * episodes_.env.arena(environment).task().episode_steps);
}

void ModularTraining::require_finite() const {
  if (ppo_.divergence()) throw Error(Failure::work, *ppo_.divergence());
}

}  // namespace evo
