// The order of ppo.cpp, whose comments say why.
#include "libevo/control/modular_ppo.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libevo/control/ppo_parts.h"

namespace evo {

using namespace ppo;  // NOLINT(google-build-using-namespace)

namespace {

// log(sigma sqrt(2 pi)) of one actuator.
float log_scale(const ModularPolicy& policy) {
  return static_cast<float>(static_cast<double>(policy.log_std[0]) + half_log_two_pi);
}

// log pi(a|s) of the actions of one sample.
float log_density(std::span<const float> actions, std::span<const float> means, float deviation,
                  float scale) {
  float sum = 0.0F;
  for (std::size_t i = 0; i < actions.size(); ++i) {
    const float z = (actions[i] - means[i]) / deviation;
    sum += z * z;
  }
  return -0.5F * sum - static_cast<float>(actions.size()) * scale;
}

std::size_t actions_of(const Bodies& bodies, int body) { return bodies[body].actuators().size(); }

}  // namespace

// ---- the objective ------------------------------------------------------------

Losses differentiate(const ModularPolicy& policy, const Bodies& bodies, const ModularSamples& batch,
                     const Objective& objective, ModularGradients& gradients,
                     ModularScratch& scratch) {
  const std::size_t samples = batch.states.bodies.size();
  const float share = 1.0F / static_cast<float>(samples);
  const auto clip = static_cast<float>(objective.clip);
  const auto value_share = static_cast<float>(objective.value_coefficient) * share;

  fixed_part(policy.actor, bodies, scratch.fixed);
  forward_actor(policy, bodies, scratch.fixed, batch.states, scratch.actor, scratch.means);
  fixed_part(policy.critic, bodies, scratch.fixed);
  forward_critic(policy, bodies, scratch.fixed, batch.states, scratch.critic, scratch.values);

  for (const std::span<float>& block : parameter_blocks(gradients))
    std::fill(block.begin(), block.end(), 0.0F);
  const float deviation = exp32(policy.log_std[0]);
  const float scale = log_scale(policy);
  scratch.mean_slopes.resize(scratch.means.size());
  scratch.value_slopes.resize(static_cast<Eigen::Index>(samples));
  Losses losses;
  double actuators = 0.0;
  float log_std_slope = 0.0F;
  std::size_t first = 0;
  for (std::size_t m = 0; m < samples; ++m) {
    const auto i = static_cast<Eigen::Index>(m);
    const std::size_t count = actions_of(bodies, batch.states.bodies[m]);
    const std::span actions = std::span(batch.actions).subspan(first, count);
    const std::span means = std::span<const float>(scratch.means).subspan(first, count);
    const float log_ratio = log_density(actions, means, deviation, scale) - batch.log_probs[i];
    const float g = add_policy_loss(log_ratio, batch.advantages[i], clip, share, losses);
    for (std::size_t j = 0; j < count; ++j) {
      const float z = (actions[j] - means[j]) / deviation;
      scratch.mean_slopes[first + j] = g * z / deviation;
      log_std_slope += g * (z * z - 1.0F);
    }
    scratch.value_slopes[i] = add_value_loss(scratch.values[i], batch.values[i], batch.returns[i],
                                             objective, value_share, losses);
    actuators += static_cast<double>(count);
    first += count;
  }
  const auto n = static_cast<double>(samples);
  divide(losses, n);
  losses.entropy = actuators / n * (0.5 + static_cast<double>(scale));
  gradients.log_std[0] =
      log_std_slope - static_cast<float>(objective.entropy_coefficient * actuators / n);

  backward_actor(policy, bodies, batch.states, scratch.mean_slopes, scratch.actor, gradients.actor);
  backward_critic(policy, bodies, batch.states, scratch.value_slopes, scratch.critic,
                  gradients.critic);
  return losses;
}

// ---- the learner --------------------------------------------------------------

ModularPolicy initial_modular_policy(const TrainingSettings& s, int task_length, double low,
                                     double high, Stream stream) {
  ModularPolicy policy;
  policy.exchange = s.exchange;
  policy.clock.assign(s.clock.begin(), s.clock.end());
  const int inputs = task_length + 2 * static_cast<int>(policy.clock.size());
  const double hidden_gain = std::sqrt(2.0);
  policy.actor =
      orthogonal_modular_network(inputs, s.hidden, s.exchange, hidden_gain, s.head_gain, stream);
  policy.critic =
      orthogonal_modular_network(inputs, s.hidden, Exchange::none, hidden_gain, 1.0, stream);
  policy.log_std = Vector::Constant(1, static_cast<float>(s.initial_log_std));
  policy.local = fresh_normalizer(s, VoxelViews::local_length);
  policy.task = fresh_normalizer(s, task_length);
  policy.action_map = s.action_map;
  policy.action_offset = s.action_offset;
  policy.low = low;
  policy.high = high;
  return policy;
}

ModularPpo::ModularPpo(const TrainingSettings& settings, ModularPolicy policy, const Bodies& bodies,
                       std::vector<int> body_of, std::uint64_t seed, std::string_view name)
    : settings_(settings),
      policy_(std::move(policy)),
      bodies_(&bodies),
      body_of_(std::move(body_of)),
      first_voxel_(1, 0),
      first_action_(1, 0),
      learner_(parameter_count(policy_), body_of_.size(), seed, name),
      gradients_(zero_gradients(policy_)) {
  for (const int body : body_of_) {
    first_voxel_.push_back(first_voxel_.back() + (*bodies_)[body].voxels());
    first_action_.push_back(first_action_.back() + actions_of(*bodies_, body));
  }
  const auto steps = static_cast<Eigen::Index>(settings_.rollout);
  const Eigen::Index samples = steps * std::ssize(body_of_);
  const auto inputs = policy_.actor.task.cols();
  state_.bodies = body_of_;
  local_.resize(static_cast<std::size_t>(first_voxel_.back() * VoxelViews::local_length));
  task_.resize(body_of_.size() * static_cast<std::size_t>(policy_.task_length()));
  learner_.colour.resize(first_action_.back());
  targets_.resize(first_action_.back());
  rollout_.states.local.resize(steps * first_voxel_.back(), VoxelViews::local_length);
  rollout_.states.task.resize(samples, inputs);
  rollout_.actions.resize(static_cast<std::size_t>(steps) * first_action_.back());
  for (Vector* v : {&rollout_.log_probs, &rollout_.values, &rollout_.advantages, &rollout_.returns})
    v->resize(samples);
  rewards_.resize(static_cast<std::size_t>(samples));
  ended_.resize(static_cast<std::size_t>(samples));
  parameters_changed();
}

void ModularPpo::parameters_changed() {
  fixed_part(policy_.actor, *bodies_, actor_fixed_);
  fixed_part(policy_.critic, *bodies_, critic_fixed_);
}

// Into local_ and task_.
void ModularPpo::look(const VecEnv& env, int environment) {
  const auto e = static_cast<std::size_t>(environment);
  const auto wide = static_cast<std::size_t>(VoxelViews::local_length);
  const auto task = static_cast<std::size_t>(policy_.task_length());
  const VoxelViews& views = (*bodies_)[body_of_[e]];
  views.look(env, environment,
             std::span(local_).subspan(static_cast<std::size_t>(first_voxel_[e]) * wide,
                                       static_cast<std::size_t>(views.voxels()) * wide),
             std::span(task_).subspan(e * task, task));
}

void ModularPpo::observe(const VecEnv& env, std::span<const int> steps) {
  for (int e = 0; e < env.environments(); ++e) look(env, e);
  if (!all_finite(local_) || !all_finite(task_))
    divergence_ = "an observation is not a finite number";
  if (settings_.normalize_observations) {
    update(policy_.local, local_);
    if (!task_.empty()) update(policy_.task, task_);
  }
  normalize(policy_.local, local_, state_.local);
  task_inputs(policy_, task_, steps, state_.task);
}

std::span<const double> ModularPpo::act() {
  forward_actor(policy_, *bodies_, actor_fixed_, state_, pass_, means_);
  forward_critic(policy_, *bodies_, critic_fixed_, state_, pass_, values_);
  const float deviation = exp32(policy_.log_std[0]);
  const float scale = log_scale(policy_);
  const double kept = settings_.noise_correlation;
  const double fresh = std::sqrt(1.0 - kept * kept);
  const std::span actions =
      std::span(rollout_.actions)
          .subspan(static_cast<std::size_t>(t_) * targets_.size(), targets_.size());
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    learner_.colour[i] = kept * learner_.colour[i] + fresh * learner_.noise.gaussian();
    actions[i] = means_[i] + deviation * static_cast<float>(learner_.colour[i]);
    targets_[i] = target_of(policy_, static_cast<double>(actions[i]));
  }
  const Eigen::Index environments = std::ssize(body_of_);
  rollout_.states.local.middleRows(t_ * first_voxel_.back(), first_voxel_.back()) = state_.local;
  rollout_.states.task.middleRows(t_ * environments, environments) = state_.task;
  rollout_.values.segment(t_ * environments, environments) = values_;
  for (std::size_t e = 0; e < body_of_.size(); ++e) {
    const std::size_t first = first_action_[e];
    const std::size_t count = first_action_[e + 1] - first;
    rollout_.log_probs[t_ * environments + static_cast<Eigen::Index>(e)] =
        log_density(actions.subspan(first, count),
                    std::span<const float>(means_).subspan(first, count), deviation, scale);
  }
  if (!all_finite(targets_)) divergence_ = "an action is not a finite number";
  return targets_;
}

void ModularPpo::reward(std::span<const double> rewards, std::span<const std::uint8_t> terminated,
                        std::span<const std::uint8_t> truncated, const VecEnv& reached,
                        std::span<const int> steps) {
  if (!all_finite(rewards)) divergence_ = "a reward is not a finite number";
  const std::size_t first = static_cast<std::size_t>(t_) * rewards.size();
  for (std::size_t e = 0; e < rewards.size(); ++e)
    ended_[first + e] = terminated[e] != 0 || truncated[e] != 0 ? 1 : 0;
  learner_.reward_scale.scale(settings_, rewards, {ended_.data() + first, rewards.size()},
                              {rewards_.data() + first, rewards.size()});
  if (settings_.time_limit == TimeLimit::bootstrap)
    bootstrap_truncated(terminated, truncated, reached, steps);
  ++t_;
}

void ModularPpo::bootstrap_truncated(std::span<const std::uint8_t> terminated,
                                     std::span<const std::uint8_t> truncated, const VecEnv& reached,
                                     std::span<const int> steps) {
  const auto wide = static_cast<std::size_t>(VoxelViews::local_length);
  const auto task = static_cast<std::size_t>(policy_.task_length());
  for (std::size_t e = 0; e < truncated.size(); ++e) {
    if (truncated[e] == 0 || terminated[e] != 0) continue;
    look(reached, static_cast<int>(e));
    const auto begin = static_cast<std::size_t>(first_voxel_[e]) * wide;
    const auto end = static_cast<std::size_t>(first_voxel_[e + 1]) * wide;
    bootstrapped_.bodies.assign(1, body_of_[e]);
    normalize(policy_.local, std::span(local_).subspan(begin, end - begin), bootstrapped_.local);
    task_inputs(policy_, std::span(task_).subspan(e * task, task), steps.subspan(e, 1),
                bootstrapped_.task);
    forward_critic(policy_, *bodies_, critic_fixed_, bootstrapped_, pass_, values_);
    rewards_[static_cast<std::size_t>(t_) * truncated.size() + e] +=
        settings_.gamma * static_cast<double>(values_[0]);
  }
}

UpdateReport ModularPpo::learn() {
  t_ = 0;
  forward_critic(policy_, *bodies_, critic_fixed_, state_, pass_, values_);
  estimate_advantages(
      rewards_, ended_, view(rollout_.values), view(values_), settings_.gamma, settings_.lambda,
      {rollout_.advantages.data(), static_cast<std::size_t>(rollout_.advantages.size())});
  rollout_.returns = rollout_.advantages + rollout_.values;
  if (settings_.standardize_advantages == Standardize::batch) standardize(rollout_.advantages);

  UpdateReport report;
  report.learning_rate = learning_rate_of(settings_, learner_.updates, settings_.updates());
  const Objective objective = objective_of(settings_, learner_.updates, settings_.updates());
  report.explained_variance = explained_variance(rollout_.returns, rollout_.values, residual_);

  order_.resize(static_cast<std::size_t>(settings_.batch()));
  std::iota(order_.begin(), order_.end(), 0U);
  const std::size_t size = order_.size() / static_cast<std::size_t>(settings_.minibatches);
  for (int epoch = 0; epoch < settings_.epochs; ++epoch) {
    shuffle(order_, learner_.shuffle);
    for (int m = 0; m < settings_.minibatches; ++m) {
      const std::span<const std::uint32_t> samples{
          order_.data() + static_cast<std::size_t>(m) * size, size};
      if (!learn_minibatch(samples, report.learning_rate, objective, report.losses)) return report;
    }
  }
  divide(report.losses, settings_.epochs * settings_.minibatches);
  parameters_changed();
  ++learner_.updates;
  return report;
}

// Into minibatch_.
void ModularPpo::gather(std::span<const std::uint32_t> samples) {
  const std::size_t environments = body_of_.size();
  Eigen::Index rows = 0;
  for (const std::uint32_t k : samples) rows += (*bodies_)[body_of_[k % environments]].voxels();
  minibatch_.states.bodies.clear();
  minibatch_.states.local.resize(rows, VoxelViews::local_length);
  minibatch_.states.task.resize(std::ssize(samples), rollout_.states.task.cols());
  minibatch_.actions.clear();
  for (Vector* v :
       {&minibatch_.log_probs, &minibatch_.values, &minibatch_.advantages, &minibatch_.returns})
    v->resize(std::ssize(samples));
  rows = 0;
  for (std::size_t m = 0; m < samples.size(); ++m) {
    const std::size_t k = samples[m];
    const std::size_t e = k % environments;
    const std::size_t t = k / environments;
    const auto from = static_cast<Eigen::Index>(k);
    const auto to = static_cast<Eigen::Index>(m);
    const Eigen::Index voxels = first_voxel_[e + 1] - first_voxel_[e];
    minibatch_.states.bodies.push_back(body_of_[e]);
    minibatch_.states.local.middleRows(rows, voxels) = rollout_.states.local.middleRows(
        static_cast<Eigen::Index>(t) * first_voxel_.back() + first_voxel_[e], voxels);
    minibatch_.states.task.row(to) = rollout_.states.task.row(from);
    const auto actions =
        rollout_.actions.begin() + static_cast<std::ptrdiff_t>(t * first_action_.back());
    minibatch_.actions.insert(minibatch_.actions.end(),
                              actions + static_cast<std::ptrdiff_t>(first_action_[e]),
                              actions + static_cast<std::ptrdiff_t>(first_action_[e + 1]));
    minibatch_.log_probs[to] = rollout_.log_probs[from];
    minibatch_.values[to] = rollout_.values[from];
    minibatch_.advantages[to] = rollout_.advantages[from];
    minibatch_.returns[to] = rollout_.returns[from];
    rows += voxels;
  }
}

bool ModularPpo::learn_minibatch(std::span<const std::uint32_t> samples, double learning_rate,
                                 const Objective& objective, Losses& sum) {
  gather(samples);
  if (settings_.standardize_advantages == Standardize::minibatch)
    standardize(minibatch_.advantages);
  const Losses losses =
      differentiate(policy_, *bodies_, minibatch_, objective, gradients_, scratch_);
  const std::vector<std::span<float>> slopes = parameter_blocks(gradients_);
  const double norm = clip_norm(slopes, settings_.max_gradient_norm);
  if (!std::isfinite(norm) || !std::isfinite(losses.policy + losses.value + losses.entropy)) {
    divergence_ = "the loss or its gradient is not a finite number";
    return false;
  }
  learner_.adam.step(parameter_blocks(policy_), slopes, learning_rate, settings_.adam_epsilon);
  add(sum, losses);
  return true;
}

// ---- checkpoints ----------------------------------------------------------------

void save_policy(Checkpoint& checkpoint, const std::string& name, const ModularPolicy& policy) {
  save_parameters(checkpoint, name + "/parameters", parameter_blocks(policy));
  save_moments(checkpoint, name + "/local", policy.local);
  save_moments(checkpoint, name + "/task", policy.task);
}

void load_policy(const Checkpoint& checkpoint, const std::string& name, ModularPolicy& policy) {
  load_parameters(checkpoint, name + "/parameters", parameter_blocks(policy),
                  parameter_count(policy));
  load_moments(checkpoint, name + "/local", policy.local);
  load_moments(checkpoint, name + "/task", policy.task);
}

void ModularPpo::save(Checkpoint& checkpoint) const {
  save_policy(checkpoint, "learner/policy", policy_);
  learner_.save(checkpoint);
  checkpoint.put<float>("learner/local",
                        {state_.local.data(), state_.local.data() + state_.local.size()});
  checkpoint.put<float>("learner/task",
                        {state_.task.data(), state_.task.data() + state_.task.size()});
}

void ModularPpo::load(const Checkpoint& checkpoint) {
  load_policy(checkpoint, "learner/policy", policy_);
  learner_.load(checkpoint);
  const auto restore = [&](const char* name, Matrix& matrix, Eigen::Index rows, Eigen::Index cols) {
    matrix.resize(rows, cols);
    const auto& values = checkpoint.get<float>(name, static_cast<std::size_t>(matrix.size()));
    std::copy(values.begin(), values.end(), matrix.data());
  };
  restore("learner/local", state_.local, first_voxel_.back(), VoxelViews::local_length);
  restore("learner/task", state_.task, std::ssize(body_of_), policy_.actor.task.cols());
  parameters_changed();
}

}  // namespace evo
