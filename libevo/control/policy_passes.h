// What PPO (ppo.h) needs of a policy for one body (policy.h): to look at states, to act, and to
// differentiate.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libevo/control/policy.h"
#include "libevo/control/ppo.h"
#include "libevo/task/env.h"

namespace evo {

class PolicyPasses {
 public:
  using Policy = evo::Policy;
  using Seen = std::span<const double>;  // observations [E x D]
  static Seen seen(const VecEnv& env) { return env.observations(); }

  PolicyPasses(Policy policy, int environments);

  const Policy& policy() const { return policy_; }
  ParameterBlocks<Policy> parameters() { return ParameterBlocks(policy_); }
  ParameterBlocks<Gradients> slopes() { return ParameterBlocks(gradients_); }

  // All environments step in every turn.
  std::int64_t turns() const { return 1; }
  void begin_turn(std::int64_t update, int rollout);
  std::size_t first() const { return 0; }
  std::size_t environments() const { return static_cast<std::size_t>(environments_); }
  std::size_t first_target() const { return 0; }
  std::size_t targets() const { return first_action(environments()); }
  std::size_t first_action(std::size_t environment) const { return environment * most_actions(); }
  std::size_t most_actions() const { return static_cast<std::size_t>(policy_.action_length()); }
  std::size_t actions_of_sample(std::size_t /*sample*/) const { return most_actions(); }

  // The states at `steps` [E] of the episodes, also into the normaliser.
  void look(Seen seen, std::span<const int> steps);
  // means() and values() of them; evaluate(): values() alone.
  void act();
  void evaluate() { forward(policy_.critic, state_, critic_); }
  std::span<const float> means() const { return all_of(actor_.back()); }
  std::span<const float> values() const { return all_of(critic_.back()); }
  // What the actions of an environment are added to, and what becomes of one.
  void rest(std::size_t environment, std::span<double> targets) const {
    rest_targets(policy_, steps_[environment], targets);
  }
  double target(double rest, double action) const { return target_of(policy_, rest, action); }
  // V of the state that an environment has reached.
  float value(Seen reached, std::span<const int> steps, std::size_t environment);

  // The states of step t of the rollout; the minibatch of samples of it.
  void keep(int t) { rollout_.middleRows(t * state_.rows(), state_.rows()) = state_; }
  void gather(std::span<const std::uint32_t> samples);
  Matrix& minibatch() { return minibatch_; }

  // Between begin_backward(), which returns the slope of log_std, all zero, and end_backward().
  Vector& begin_backward();
  template <typename Use>
  void each_chunk(Use use) {
    forward(policy_.actor, minibatch_, batch_actor_);
    forward(policy_.critic, minibatch_, batch_critic_);
    Matrix& means = actor_slopes_.back();
    Matrix& values = critic_slopes_.back();
    means.resize(minibatch_.rows(), policy_.action_length());
    values.resize(minibatch_.rows(), 1);
    use(Chunk{0, 0, all_of(batch_actor_.back()), all_of(batch_critic_.back()), all_of(means),
              all_of(values)});
  }
  void end_backward();

  void serialize(const Archive& archive);

 private:
  static std::span<float> all_of(Matrix& x) {
    return {x.data(), static_cast<std::size_t>(x.size())};
  }
  static std::span<const float> all_of(const Matrix& x) {
    return {x.data(), static_cast<std::size_t>(x.size())};
  }

  Policy policy_;
  int environments_;
  Gradients gradients_;
  std::vector<int> steps_;  // [E] of the episodes
  Matrix state_;            // s_t, what networks see of it [E x I]
  Matrix rollout_;          // rows t*E + e
  Matrix minibatch_;
  Activations actor_;  // of the environments
  Activations critic_;
  Activations batch_actor_;  // of the minibatch, apart: neither changes its size
  Activations batch_critic_;
  std::vector<Matrix> actor_slopes_;
  std::vector<Matrix> critic_slopes_;
  NetworkScratch reached_;  // of the critic
};

// An untrained policy for observations of D numbers and A actuators with targets in
// [low, high], on a base where one is given.
Policy initial_policy(const TrainingSettings& settings, int observation_length, int action_length,
                      double low, double high, std::optional<OpenLoop> base, Stream stream);

}  // namespace evo
