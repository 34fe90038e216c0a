#include "libevo/control/modular_passes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace evo {

ModularPolicy initial_modular_policy(const TrainingSettings& s, int task_length, double low,
                                     double high, Stream stream) {
  ModularPolicy policy;
  policy.clock.assign(s.clock.begin(), s.clock.end());
  const int inputs = task_length + 2 * static_cast<int>(policy.clock.size());
  const double hidden_gain = std::sqrt(2.0);
  policy.actor = orthogonal_actor(inputs, s.hidden, hidden_gain, s.head_gain, stream);
  policy.critic = orthogonal_critic(inputs, s.hidden, hidden_gain, 1.0, stream);
  policy.log_std = Vector::Constant(1, static_cast<float>(s.initial_log_std));
  policy.local = fresh_normalizer(VoxelViews::local_length);
  policy.task = fresh_normalizer(task_length);
  policy.action_map = s.action_map;
  policy.action_offset = s.action_offset;
  policy.low = low;
  policy.high = high;
  return policy;
}

ModularPasses::ModularPasses(ModularPolicy policy, std::span<const Arena* const> robots,
                             int environments, int groups)
    : policy_(std::move(policy)), gradients_(zero_gradients(policy_)) {
  const auto count = static_cast<std::size_t>(groups);
  std::size_t first = 0;
  std::size_t targets = 0;
  for (std::size_t g = 0; g < count; ++g) {
    const std::size_t begin = g * robots.size() / count;
    const std::size_t end = (g + 1) * robots.size() / count;
    Turn turn{Bodies(robots.subspan(begin, end - begin)), {}, first, targets, {0}, {0}};
    for (int e = 0; e < environments * turn.bodies.size(); ++e) {
      turn.body_of.push_back(e / environments);
      const VoxelViews& views = turn.bodies[turn.body_of.back()];
      turn.first_voxel.push_back(turn.first_voxel.back() + views.voxels());
      turn.first_action.push_back(turn.first_action.back() + views.actuators().size());
      most_actions_ = std::max(most_actions_, views.actuators().size());
    }
    first += turn.body_of.size();
    targets += turn.first_action.back();
    turns_.push_back(std::move(turn));
  }
}

// Buffers for the environments whose turn it is, and what the parameters make of their bodies.
void ModularPasses::begin_turn(std::int64_t update, int rollout) {
  turn_ = &turns_[static_cast<std::size_t>(update) % turns_.size()];
  const auto steps = static_cast<Eigen::Index>(rollout);
  state_.bodies = body_of();
  local_.resize(static_cast<std::size_t>(turn_->first_voxel.back() * VoxelViews::local_length));
  task_.resize(environments() * static_cast<std::size_t>(policy_.task_length()));
  rollout_.local.resize(steps * turn_->first_voxel.back(), VoxelViews::local_length);
  rollout_.task.resize(steps * std::ssize(body_of()), policy_.actor.task.cols());
  prepare(policy_.actor, bodies(), actor_);
  prepare(policy_.critic, bodies(), critic_);
}

// Into local_ and task_.
void ModularPasses::look_at(const VecEnv& env, std::size_t environment) {
  const auto wide = static_cast<std::size_t>(VoxelViews::local_length);
  const auto task = static_cast<std::size_t>(policy_.task_length());
  const VoxelViews& views = bodies()[body_of()[environment]];
  views.look(
      env, static_cast<int>(turn_->first + environment),
      std::span(local_).subspan(static_cast<std::size_t>(turn_->first_voxel[environment]) * wide,
                                static_cast<std::size_t>(views.voxels()) * wide),
      std::span(task_).subspan(environment * task, task));
}

void ModularPasses::look(const VecEnv& env, std::span<const int> steps) {
  for (std::size_t e = 0; e < environments(); ++e) look_at(env, e);
  update(policy_.local, local_);
  if (!task_.empty()) update(policy_.task, task_);
  normalize(policy_.local, local_, state_.local);
  network_inputs(policy_.task, policy_.clock, task_, steps.subspan(first(), environments()),
                 state_.task);
}

void ModularPasses::act() {
  forward_actor(policy_, bodies(), actor_, state_, pass_, means_);
  evaluate();
}

void ModularPasses::evaluate() {
  forward_critic(policy_, bodies(), critic_, state_, pass_, values_);
}

void ModularPasses::rest(std::size_t /*environment*/, std::span<double> targets) const {
  std::fill(targets.begin(), targets.end(), policy_.action_offset);
}

double ModularPasses::target(double /*rest*/, double action) const {
  return target_of(policy_, action);
}

float ModularPasses::value(const VecEnv& reached, std::span<const int> steps,
                           std::size_t environment) {
  const auto wide = static_cast<std::size_t>(VoxelViews::local_length);
  const auto task = static_cast<std::size_t>(policy_.task_length());
  look_at(reached, environment);
  const auto begin = static_cast<std::size_t>(turn_->first_voxel[environment]) * wide;
  const auto end = static_cast<std::size_t>(turn_->first_voxel[environment + 1]) * wide;
  reached_.bodies.assign(1, body_of()[environment]);
  normalize(policy_.local, std::span(local_).subspan(begin, end - begin), reached_.local);
  network_inputs(policy_.task, policy_.clock, std::span(task_).subspan(environment * task, task),
                 steps.subspan(first() + environment, 1), reached_.task);
  forward_critic(policy_, bodies(), critic_, reached_, pass_, values_);
  return values_[0];
}

void ModularPasses::keep(int t) {
  rollout_.local.middleRows(t * state_.local.rows(), state_.local.rows()) = state_.local;
  rollout_.task.middleRows(t * state_.task.rows(), state_.task.rows()) = state_.task;
}

void ModularPasses::gather(std::span<const std::uint32_t> samples) {
  const std::vector<Eigen::Index>& first_voxel = turn_->first_voxel;
  const auto voxels_of = [&](std::size_t e) { return first_voxel[e + 1] - first_voxel[e]; };
  Eigen::Index rows = 0;
  for (const std::uint32_t k : samples) rows += voxels_of(k % environments());
  minibatch_.bodies.clear();
  minibatch_.local.resize(rows, VoxelViews::local_length);
  minibatch_.task.resize(std::ssize(samples), rollout_.task.cols());
  rows = 0;
  for (std::size_t m = 0; m < samples.size(); ++m) {
    const std::size_t e = samples[m] % environments();
    const auto t = static_cast<Eigen::Index>(samples[m] / environments());
    const Eigen::Index voxels = voxels_of(e);
    minibatch_.bodies.push_back(state_.bodies[e]);
    minibatch_.local.middleRows(rows, voxels) =
        rollout_.local.middleRows(t * first_voxel.back() + first_voxel[e], voxels);
    minibatch_.task.row(static_cast<Eigen::Index>(m)) = rollout_.task.row(samples[m]);
    rows += voxels;
  }
}

Vector& ModularPasses::begin_backward() {
  prepare(policy_.actor, bodies(), changing_actor_);
  prepare(policy_.critic, bodies(), changing_critic_);
  for (const std::span<float>& block : parameter_blocks(gradients_))
    std::fill(block.begin(), block.end(), 0.0F);
  evo::begin_backward(policy_.actor, bodies(), actor_pass_);
  evo::begin_backward(policy_.critic, bodies(), critic_pass_);
  return gradients_.log_std;
}

void ModularPasses::forward_chunk(const VoxelSamples& samples, std::size_t first_sample) {
  std::size_t actions = 0;
  for (std::size_t m = 0; m < samples.bodies.size(); ++m)
    actions += actions_of_sample(first_sample + m);
  for (std::vector<float>* of_action : {&chunk_means_, &mean_slopes_}) of_action->resize(actions);
  for (std::vector<float>* of_sample : {&chunk_values_, &value_slopes_})
    of_sample->resize(samples.bodies.size());
  forward_actor(policy_, bodies(), changing_actor_, samples, actor_pass_, chunk_means_);
  forward_critic(policy_, bodies(), changing_critic_, samples, critic_pass_, chunk_values_);
}

void ModularPasses::backward_chunk(const VoxelSamples& samples) {
  backward_actor(policy_, changing_actor_, samples, mean_slopes_, actor_pass_, gradients_.actor);
  backward_critic(policy_, changing_critic_, samples, value_slopes_, critic_pass_,
                  gradients_.critic);
}

void ModularPasses::end_backward() {
  evo::end_backward(bodies(), actor_pass_, gradients_.actor);
  evo::end_backward(bodies(), critic_pass_, gradients_.critic);
}

// ---- checkpoints ----------------------------------------------------------------

// Of the policy alone: what is seen is looked at anew.
void ModularPasses::serialize(const Archive& archive) {
  archive.blocks("policy/parameters", parameters());
  evo::serialize(archive.part("policy/local"), policy_.local);
  evo::serialize(archive.part("policy/task"), policy_.task);
}

}  // namespace evo
