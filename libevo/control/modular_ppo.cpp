// The order of ppo.cpp, whose comments say why.
#include "libevo/control/modular_ppo.h"

#include <algorithm>
#include <cmath>
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

  prepare(policy.actor, bodies, scratch.prepared_actor);
  prepare(policy.critic, bodies, scratch.prepared_critic);
  for (const std::span<float>& block : parameter_blocks(gradients))
    std::fill(block.begin(), block.end(), 0.0F);
  begin_backward(policy.actor, bodies, scratch.actor);
  begin_backward(policy.critic, bodies, scratch.critic);
  const float deviation = exp32(policy.log_std[0]);
  const float scale = log_scale(policy);
  Losses losses;
  double actuators = 0.0;
  float log_std_slope = 0.0F;
  each_chunk(
      bodies, batch.states,
      [&](const VoxelSamples& chunk, std::size_t first_sample, std::size_t first_action) {
        scratch.values.resize(chunk.bodies.size());
        scratch.value_slopes.resize(chunk.bodies.size());
        std::size_t count_of_all = 0;
        for (const int body : chunk.bodies) count_of_all += actions_of(bodies, body);
        scratch.means.resize(count_of_all);
        scratch.mean_slopes.resize(count_of_all);
        forward_actor(policy, bodies, scratch.prepared_actor, chunk, scratch.actor, scratch.means);
        forward_critic(policy, bodies, scratch.prepared_critic, chunk, scratch.critic,
                       scratch.values);
        std::size_t first = 0;
        for (std::size_t m = 0; m < chunk.bodies.size(); ++m) {
          const auto i = static_cast<Eigen::Index>(first_sample + m);
          const std::size_t count = actions_of(bodies, chunk.bodies[m]);
          const std::span actions = std::span(batch.actions).subspan(first_action + first, count);
          const std::span means = std::span<const float>(scratch.means).subspan(first, count);
          const float log_ratio =
              log_density(actions, means, deviation, scale) - batch.log_probs[i];
          const float g = add_policy_loss(log_ratio, batch.advantages[i], clip, share, losses);
          for (std::size_t j = 0; j < count; ++j) {
            const float z = (actions[j] - means[j]) / deviation;
            scratch.mean_slopes[first + j] = g * z / deviation;
            log_std_slope += g * (z * z - 1.0F);
          }
          scratch.value_slopes[m] = add_value_loss(
              scratch.values[m], batch.values[i], batch.returns[i], objective, value_share, losses);
          actuators += static_cast<double>(count);
          first += count;
        }
        backward_actor(policy, bodies, scratch.prepared_actor, chunk, scratch.mean_slopes,
                       scratch.actor, gradients.actor);
        backward_critic(policy, scratch.prepared_critic, chunk, scratch.value_slopes,
                        scratch.critic, gradients.critic);
      });
  end_backward(bodies, scratch.actor, gradients.actor);
  end_backward(bodies, scratch.critic, gradients.critic);
  const auto n = static_cast<double>(samples);
  divide(losses, n);
  losses.entropy = actuators / n * (0.5 + static_cast<double>(scale));
  gradients.log_std[0] =
      log_std_slope - static_cast<float>(objective.entropy_coefficient * actuators / n);
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
  if (s.gating == Gating::fixed) {
    add_gates(policy.actor, s.hidden.size());
    add_gates(policy.critic, 1);
  }
  policy.log_std = Vector::Constant(1, static_cast<float>(s.initial_log_std));
  policy.local = fresh_normalizer(VoxelViews::local_length);
  policy.task = fresh_normalizer(task_length);
  policy.action_map = s.action_map;
  policy.action_offset = s.action_offset;
  policy.low = low;
  policy.high = high;
  return policy;
}

ModularPpo::ModularPpo(const TrainingSettings& settings, ModularPolicy policy,
                       std::span<const Group> groups, std::uint64_t seed, std::string_view name)
    : settings_(settings),
      policy_(std::move(policy)),
      turns_([&] {
        std::vector<Turn> turns;
        std::size_t environments = 0;
        std::size_t targets = 0;
        for (const Group& group : groups) {
          Turn turn{&group, environments, targets, {0}, {0}};
          for (const int body : group.body_of) {
            turn.first_voxel.push_back(turn.first_voxel.back() + group.bodies[body].voxels());
            turn.first_action.push_back(turn.first_action.back() + actions_of(group.bodies, body));
          }
          environments += group.body_of.size();
          targets += turn.first_action.back();
          turns.push_back(std::move(turn));
        }
        return turns;
      }()),
      targets_(turns_.back().first_target + turns_.back().first_action.back(), 1.0),
      learner_(parameter_count(policy_), turns_.back().first + turns_.back().body_of().size(), seed,
               name),
      gradients_(zero_gradients(policy_)) {
  begin_turn();
}

std::int64_t ModularPpo::updates_in_all() const {
  return settings_.steps * std::ssize(turns_) / settings_.batch();
}

// Buffers for the environments whose turn it is, and what the parameters make of their bodies.
void ModularPpo::begin_turn() {
  const std::vector<int>& body_of = turn().body_of();
  const auto steps = static_cast<Eigen::Index>(settings_.rollout);
  const Eigen::Index samples = steps * std::ssize(body_of);
  state_.bodies = body_of;
  local_.resize(static_cast<std::size_t>(turn().first_voxel.back() * VoxelViews::local_length));
  task_.resize(body_of.size() * static_cast<std::size_t>(policy_.task_length()));
  rollout_.states.local.resize(steps * turn().first_voxel.back(), VoxelViews::local_length);
  rollout_.states.task.resize(samples, policy_.actor.task.cols());
  rollout_.actions.resize(static_cast<std::size_t>(steps) * turn().first_action.back());
  rollout_.resize(samples);
  learner_.begin_rollout(static_cast<std::size_t>(samples));
  prepare(policy_.actor, turn().bodies(), actor_);
  prepare(policy_.critic, turn().bodies(), critic_);
}

// Into local_ and task_.
void ModularPpo::look(const VecEnv& env, std::size_t environment) {
  const auto wide = static_cast<std::size_t>(VoxelViews::local_length);
  const auto task = static_cast<std::size_t>(policy_.task_length());
  const VoxelViews& views = turn().bodies()[turn().body_of()[environment]];
  views.look(
      env, static_cast<int>(turn().first + environment),
      std::span(local_).subspan(static_cast<std::size_t>(turn().first_voxel[environment]) * wide,
                                static_cast<std::size_t>(views.voxels()) * wide),
      std::span(task_).subspan(environment * task, task));
}

void ModularPpo::observe(const VecEnv& env, std::span<const int> steps) {
  const std::size_t environments = turn().body_of().size();
  for (std::size_t e = 0; e < environments; ++e) look(env, e);
  if (!all_finite(local_) || !all_finite(task_))
    learner_.divergence = "an observation is not a finite number";
  update(policy_.local, local_);
  if (!task_.empty()) update(policy_.task, task_);
  normalize(policy_.local, local_, state_.local);
  task_inputs(policy_, task_, steps.subspan(turn().first, environments), state_.task);
}

std::span<const double> ModularPpo::act() {
  const Bodies& bodies = turn().bodies();
  forward_actor(policy_, bodies, actor_, state_, pass_, means_);
  forward_critic(policy_, bodies, critic_, state_, pass_, values_);
  const float deviation = exp32(policy_.log_std[0]);
  const float scale = log_scale(policy_);
  const std::size_t count = means_.size();
  const std::span targets = std::span(targets_).subspan(turn().first_target, count);
  const std::span actions =
      std::span(rollout_.actions).subspan(static_cast<std::size_t>(learner_.t) * count, count);
  for (std::size_t i = 0; i < count; ++i) {
    actions[i] = means_[i] + deviation * static_cast<float>(learner_.noise.gaussian());
    targets[i] = target_of(policy_, static_cast<double>(actions[i]));
  }
  const Eigen::Index environments = std::ssize(state_.bodies);
  rollout_.states.local.middleRows(learner_.t * state_.local.rows(), state_.local.rows()) =
      state_.local;
  rollout_.states.task.middleRows(learner_.t * environments, environments) = state_.task;
  rollout_.values.segment(learner_.t * environments, environments) = values_;
  for (std::size_t e = 0; e < state_.bodies.size(); ++e) {
    const std::size_t first = turn().first_action[e];
    const std::size_t own = turn().first_action[e + 1] - first;
    rollout_.log_probs[learner_.t * environments + static_cast<Eigen::Index>(e)] =
        log_density(actions.subspan(first, own), std::span<const float>(means_).subspan(first, own),
                    deviation, scale);
  }
  if (!all_finite(targets)) learner_.divergence = "an action is not a finite number";
  return targets_;
}

void ModularPpo::reward(std::span<const double> rewards, std::span<const std::uint8_t> terminated,
                        std::span<const std::uint8_t> truncated, const VecEnv& reached,
                        std::span<const int> steps) {
  const std::size_t first = turn().first;
  const std::size_t count = turn().body_of().size();
  const auto wide = static_cast<std::size_t>(VoxelViews::local_length);
  const auto task = static_cast<std::size_t>(policy_.task_length());
  learner_.reward(settings_, first, rewards.subspan(first, count), terminated.subspan(first, count),
                  truncated.subspan(first, count), [&](std::size_t e) {
                    look(reached, e);
                    const auto begin = static_cast<std::size_t>(turn().first_voxel[e]) * wide;
                    const auto end = static_cast<std::size_t>(turn().first_voxel[e + 1]) * wide;
                    bootstrapped_.bodies.assign(1, turn().body_of()[e]);
                    normalize(policy_.local, std::span(local_).subspan(begin, end - begin),
                              bootstrapped_.local);
                    task_inputs(policy_, std::span(task_).subspan(e * task, task),
                                steps.subspan(first + e, 1), bootstrapped_.task);
                    forward_critic(policy_, turn().bodies(), critic_, bootstrapped_, pass_,
                                   values_);
                    return values_[0];
                  });
}

UpdateReport ModularPpo::learn() {
  forward_critic(policy_, turn().bodies(), critic_, state_, pass_, values_);
  const UpdateReport report = learner_.learn(
      settings_, updates_in_all(), rollout_, view(values_), parameter_blocks(policy_),
      parameter_blocks(gradients_),
      [&](std::span<const std::uint32_t> samples) { gather(samples); },
      [&](const Objective& objective) {
        return differentiate(policy_, turn().bodies(), minibatch_, objective, gradients_, scratch_);
      });
  begin_turn();
  return report;
}

// Into minibatch_.
void ModularPpo::gather(std::span<const std::uint32_t> samples) {
  const std::vector<Eigen::Index>& first_voxel = turn().first_voxel;
  const std::vector<std::size_t>& first_action = turn().first_action;
  const std::size_t environments = state_.bodies.size();
  const auto voxels_of = [&](std::size_t e) { return first_voxel[e + 1] - first_voxel[e]; };
  Eigen::Index rows = 0;
  for (const std::uint32_t k : samples) rows += voxels_of(k % environments);
  minibatch_.states.bodies.clear();
  minibatch_.states.local.resize(rows, VoxelViews::local_length);
  minibatch_.states.task.resize(std::ssize(samples), rollout_.states.task.cols());
  minibatch_.actions.clear();
  minibatch_.resize(std::ssize(samples));
  rows = 0;
  for (std::size_t m = 0; m < samples.size(); ++m) {
    const std::size_t k = samples[m];
    const std::size_t e = k % environments;
    const std::size_t t = k / environments;
    const auto from = static_cast<Eigen::Index>(k);
    const auto to = static_cast<Eigen::Index>(m);
    const Eigen::Index voxels = voxels_of(e);
    minibatch_.states.bodies.push_back(state_.bodies[e]);
    minibatch_.states.local.middleRows(rows, voxels) = rollout_.states.local.middleRows(
        static_cast<Eigen::Index>(t) * first_voxel.back() + first_voxel[e], voxels);
    minibatch_.states.task.row(to) = rollout_.states.task.row(from);
    const auto actions =
        rollout_.actions.begin() + static_cast<std::ptrdiff_t>(t * first_action.back());
    minibatch_.actions.insert(minibatch_.actions.end(),
                              actions + static_cast<std::ptrdiff_t>(first_action[e]),
                              actions + static_cast<std::ptrdiff_t>(first_action[e + 1]));
    minibatch_.take(to, rollout_, from);
    rows += voxels;
  }
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
}

void ModularPpo::load(const Checkpoint& checkpoint) {
  load_policy(checkpoint, "learner/policy", policy_);
  learner_.load(checkpoint);
  begin_turn();
}

}  // namespace evo
