#include "libevo/control/policy_passes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace evo {

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

PolicyPasses::PolicyPasses(Policy policy, int environments)
    : policy_(std::move(policy)),
      environments_(environments),
      gradients_(zero_gradients(policy_)),
      actor_slopes_(policy_.actor.layers.size()),
      critic_slopes_(policy_.critic.layers.size()) {}

void PolicyPasses::begin_turn(std::int64_t /*update*/, int rollout) {
  rollout_.resize(static_cast<Eigen::Index>(rollout) * environments_,
                  policy_.actor.layers.front().weight.cols());
}

void PolicyPasses::look(Seen seen, std::span<const int> steps) {
  update(policy_.normalizer, seen);
  network_inputs(policy_.normalizer, policy_.clock, seen, steps, state_);
  steps_.assign(steps.begin(), steps.end());
}

void PolicyPasses::act() {
  forward(policy_.actor, state_, actor_);
  forward(policy_.critic, state_, critic_);
}

float PolicyPasses::value(Seen reached, std::span<const int> steps, std::size_t environment) {
  const auto length = static_cast<std::size_t>(policy_.observation_length());
  network_inputs(policy_.normalizer, policy_.clock, reached.subspan(environment * length, length),
                 steps.subspan(environment, 1), reached_.inputs);
  forward(policy_.critic, reached_.inputs, reached_.activations);
  return reached_.activations.back()(0, 0);
}

void PolicyPasses::gather(std::span<const std::uint32_t> samples) {
  minibatch_.resize(std::ssize(samples), rollout_.cols());
  for (Eigen::Index i = 0; i < minibatch_.rows(); ++i)
    minibatch_.row(i) = rollout_.row(samples[static_cast<std::size_t>(i)]);
}

Vector& PolicyPasses::begin_backward() {
  const ParameterBlocks blocks(gradients_);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    std::fill(blocks[b].begin(), blocks[b].end(), 0.0F);
  return gradients_.log_std;
}

void PolicyPasses::end_backward() {
  backward(policy_.actor, minibatch_, batch_actor_, actor_slopes_, gradients_.actor);
  backward(policy_.critic, minibatch_, batch_critic_, critic_slopes_, gradients_.critic);
}

// ---- checkpoints ----------------------------------------------------------------

void PolicyPasses::serialize(const Archive& archive) {
  archive.blocks("policy/parameters", parameters());
  evo::serialize(archive.part("policy/normalizer"), policy_.normalizer);
  if (archive.loads()) {
    state_.resize(environments_, policy_.actor.layers.front().weight.cols());
    steps_.resize(environments());
  }
  archive.row<float>("state", all_of(state_));
  archive.row<std::uint64_t>("steps", steps_);
}

}  // namespace evo
