// Read from top to bottom: the objective and its gradient, then the learner that uses
// them; ppo_parts.cpp has the pieces. Implementation details carry the numbers of "The 37
// Implementation Details of Proximal Policy Optimization" (Huang et al. 2022) in brackets.
#include "libevo/control/ppo.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libevo/base/elementary.h"

namespace evo {

using namespace ppo;  // NOLINT(google-build-using-namespace)

namespace {

void set_deviations(const Policy& policy, Vector& deviation) {
  deviation = policy.log_std.unaryExpr(&exp32);
}

// log pi(a|s) of a diagonal Gaussian, without the constant `log_scale` below.
// `z` receives (a - mu) / sigma.
template <typename Action, typename Mean>
float log_density(const Action& action, const Mean& mean, const Vector& deviation, Vector& z) {
  float sum = 0.0F;
  for (Eigen::Index i = 0; i < deviation.size(); ++i) {
    z[i] = (action[i] - mean[i]) / deviation[i];
    sum += z[i] * z[i];
  }
  return -0.5F * sum;
}

// sum_i log(sigma_i sqrt(2 pi)): what log_density leaves out.
float log_scale(const Policy& policy) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < policy.log_std.size(); ++i)
    sum += static_cast<double>(policy.log_std[i]) + half_log_two_pi;
  return static_cast<float>(sum);
}

}  // namespace

// ---- the objective ------------------------------------------------------------

Losses differentiate(const Policy& policy, const Samples& batch, const Objective& objective,
                     Gradients& gradients, LossScratch& scratch) {
  const Eigen::Index samples = batch.states.rows();
  const Eigen::Index actions = batch.actions.cols();
  const float share = 1.0F / static_cast<float>(samples);
  const auto clip = static_cast<float>(objective.clip);
  const auto value_share = static_cast<float>(objective.value_coefficient) * share;

  forward(policy.actor, batch.states, scratch.actor);
  forward(policy.critic, batch.states, scratch.critic);
  const Matrix& mean = scratch.actor.back();    // mu(s) [M x A]
  const Matrix& value = scratch.critic.back();  // V(s) [M x 1]

  set_deviations(policy, scratch.deviation);
  const Vector& deviation = scratch.deviation;
  const float scale = log_scale(policy);
  scratch.actor_slopes.resize(policy.actor.layers.size());
  scratch.critic_slopes.resize(policy.critic.layers.size());
  Matrix& mean_gradient = scratch.actor_slopes.back();    // dL/dmu
  Matrix& value_gradient = scratch.critic_slopes.back();  // dL/dV
  mean_gradient.resize(samples, actions);
  value_gradient.resize(samples, 1);
  Vector& z = scratch.z;
  z.resize(actions);
  const ParameterBlocks blocks(gradients);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    std::fill(blocks[b].begin(), blocks[b].end(), 0.0F);
  Vector& log_std_gradient = gradients.log_std;
  Losses losses;

  for (Eigen::Index i = 0; i < samples; ++i) {
    const float log_ratio =
        log_density(batch.actions.row(i), mean.row(i), deviation, z) - scale - batch.log_probs[i];
    const float g = add_policy_loss(log_ratio, batch.advantages[i], clip, share, losses);
    for (Eigen::Index j = 0; j < actions; ++j) {
      mean_gradient(i, j) = g * z[j] / deviation[j];
      log_std_gradient[j] += g * (z[j] * z[j] - 1.0F);
    }
    value_gradient(i, 0) = add_value_loss(value(i, 0), batch.values[i], batch.returns[i], objective,
                                          value_share, losses);
  }
  divide(losses, static_cast<double>(samples));

  // [10] Entropy of the Gaussian: sum_j (1/2 + log(sigma_j sqrt(2 pi))).
  losses.entropy = 0.5 * static_cast<double>(actions) + static_cast<double>(scale);
  log_std_gradient.array() -= static_cast<float>(objective.entropy_coefficient);

  backward(policy.actor, batch.states, scratch.actor, scratch.actor_slopes, gradients.actor);
  backward(policy.critic, batch.states, scratch.critic, scratch.critic_slopes, gradients.critic);
  return losses;
}

// ---- the learner --------------------------------------------------------------

namespace {

void resize(Samples& batch, Eigen::Index samples, int observation_length, int action_length) {
  batch.resize(samples);
  batch.states.resize(samples, observation_length);
  batch.actions.resize(samples, action_length);
}

void gather(const Samples& from, std::span<const std::uint32_t> samples, Samples& to) {
  for (Eigen::Index i = 0; i < to.states.rows(); ++i) {
    const Eigen::Index k = samples[static_cast<std::size_t>(i)];
    to.states.row(i) = from.states.row(k);
    to.actions.row(i) = from.actions.row(k);
    to.take(i, from, k);
  }
}

}  // namespace

// [2, 3] Orthogonal initialisation, separate networks for actor and critic.
Policy initial_policy(const TrainingSettings& s, int observation_length, int action_length,
                      double low, double high, std::optional<OpenLoop> base, Stream stream) {
  Policy policy;
  policy.clock.assign(s.clock.begin(), s.clock.end());
  if (base)
    if (const auto* gait = std::get_if<SineController>(&*base))
      policy.clock.push_back(gait->period);
  policy.base = std::move(base);
  const int inputs = observation_length + 2 * static_cast<int>(policy.clock.size());
  const double hidden_gain = std::sqrt(2.0);
  policy.actor =
      orthogonal_network(inputs, s.hidden, action_length, hidden_gain, s.head_gain, stream);
  policy.critic = orthogonal_network(inputs, s.hidden, 1, hidden_gain, 1.0, stream);
  policy.log_std = Vector::Constant(
      action_length, static_cast<float>(policy.base ? s.gait_log_std : s.initial_log_std));
  policy.normalizer = fresh_normalizer(observation_length);
  policy.action_map = s.action_map;
  policy.action_offset = s.action_offset;
  policy.low = low;
  policy.high = high;
  return policy;
}

Ppo::Ppo(const TrainingSettings& settings, Policy policy, std::uint64_t seed,
         std::string_view robot_id)
    : settings_(settings),
      policy_(std::move(policy)),
      learner_(parameter_count(policy_), static_cast<std::size_t>(settings.environments), seed,
               robot_id),
      gradients_(zero_gradients(policy_)) {
  const auto environments = static_cast<std::size_t>(settings.environments);
  const int actions = policy_.action_length();
  const auto inputs = static_cast<int>(policy_.actor.layers.front().weight.cols());
  resize(rollout_, settings.batch(), inputs, actions);
  resize(minibatch_, settings.batch() / settings.minibatches, inputs, actions);
  learner_.begin_rollout(static_cast<std::size_t>(settings.batch()));
  targets_.resize(environments * static_cast<std::size_t>(actions));
}

// [20, 21] Observations are normalised by running moments and clipped.
void Ppo::observe(std::span<const double> observations, std::span<const int> steps) {
  if (!all_finite(observations)) learner_.divergence = "an observation is not a finite number";
  update(policy_.normalizer, observations);
  network_inputs(policy_, observations, steps, state_);
  steps_.assign(steps.begin(), steps.end());
}

// [17-19] Independent Gaussians with a deviation that does not depend on the
// state; the log-probability is that of the action before it is clipped.
std::span<const double> Ppo::act() {
  forward(policy_.actor, state_, actor_out_);
  forward(policy_.critic, state_, critic_out_);
  const Matrix& mean = actor_out_.back();
  set_deviations(policy_, deviation_);
  const Vector& deviation = deviation_;
  const float scale = log_scale(policy_);
  z_.resize(deviation.size());
  for (Eigen::Index e = 0; e < state_.rows(); ++e) {
    const auto first = static_cast<std::size_t>(e * deviation.size());
    const std::span<double> targets{targets_.data() + first,
                                    static_cast<std::size_t>(deviation.size())};
    rest_targets(policy_, steps_[static_cast<std::size_t>(e)], targets);
    const Eigen::Index row = learner_.t * state_.rows() + e;
    rollout_.states.row(row) = state_.row(e);
    for (Eigen::Index j = 0; j < deviation.size(); ++j) {
      const auto k = static_cast<std::size_t>(j);
      const float a = mean(e, j) + deviation[j] * static_cast<float>(learner_.noise.gaussian());
      rollout_.actions(row, j) = a;
      targets[k] = target_of(policy_, targets[k], static_cast<double>(a));
    }
    rollout_.log_probs[row] =
        log_density(rollout_.actions.row(row), mean.row(e), deviation, z_) - scale;
    rollout_.values[row] = critic_out_.back()(e, 0);
  }
  if (!all_finite(targets_)) learner_.divergence = "an action is not a finite number";
  return targets_;
}

void Ppo::reward(std::span<const double> rewards, std::span<const std::uint8_t> terminated,
                 std::span<const std::uint8_t> truncated, std::span<const double> reached,
                 std::span<const int> steps) {
  const std::size_t length = reached.size() / rewards.size();
  learner_.reward(settings_, 0, rewards, terminated, truncated, [&](std::size_t e) {
    network_inputs(policy_, reached.subspan(e * length, length), steps.subspan(e, 1),
                   bootstrapped_.inputs);
    forward(policy_.critic, bootstrapped_.inputs, bootstrapped_.activations);
    return bootstrapped_.activations.back()(0, 0);
  });
}

UpdateReport Ppo::learn() {
  forward(policy_.critic, state_, critic_out_);
  const Matrix& last_values = critic_out_.back();  // V(s_T)
  const UpdateReport report = learner_.learn(
      settings_, settings_.updates(), rollout_,
      {last_values.data(), static_cast<std::size_t>(last_values.size())}, ParameterBlocks(policy_),
      ParameterBlocks(gradients_),
      [&](std::span<const std::uint32_t> samples) { gather(rollout_, samples, minibatch_); },
      [&](const Objective& objective) {
        return differentiate(policy_, minibatch_, objective, gradients_, loss_scratch_);
      });
  learner_.begin_rollout(static_cast<std::size_t>(settings_.batch()));
  return report;
}

// ---- checkpoints ----------------------------------------------------------------

void save_policy(Checkpoint& checkpoint, const std::string& name, const Policy& policy) {
  save_parameters(checkpoint, name + "/parameters", ParameterBlocks(policy));
  save_moments(checkpoint, name + "/normalizer", policy.normalizer);
}

void load_policy(const Checkpoint& checkpoint, const std::string& name, Policy& policy) {
  load_parameters(checkpoint, name + "/parameters", ParameterBlocks(policy),
                  parameter_count(policy));
  load_moments(checkpoint, name + "/normalizer", policy.normalizer);
}

void Ppo::save(Checkpoint& checkpoint) const {
  save_policy(checkpoint, "learner/policy", policy_);
  learner_.save(checkpoint);
  checkpoint.put<float>("learner/state", {state_.data(), state_.data() + state_.size()});
  checkpoint.put<std::uint64_t>("learner/steps", {steps_.begin(), steps_.end()});
}

void Ppo::load(const Checkpoint& checkpoint) {
  load_policy(checkpoint, "learner/policy", policy_);
  learner_.load(checkpoint);
  state_.resize(settings_.environments, policy_.actor.layers.front().weight.cols());
  const auto& state =
      checkpoint.get<float>("learner/state", static_cast<std::size_t>(state_.size()));
  std::copy(state.begin(), state.end(), state_.data());
  steps_.assign(static_cast<std::size_t>(settings_.environments), 0);
  const auto& steps = checkpoint.get<std::uint64_t>("learner/steps", steps_.size());
  for (std::size_t e = 0; e < steps.size(); ++e) steps_[e] = static_cast<int>(steps[e]);
}

}  // namespace evo
