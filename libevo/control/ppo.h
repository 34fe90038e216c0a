// Proximal policy optimisation (Schulman et al. 2017) in the notation of the
// paper: state s, action a, policy pi, advantage A^, value V, return R. The
// learner knows nothing of simulators: whoever runs environments tells it what
// was seen and earned, and asks it what to do.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libevo/control/checkpoint.h"
#include "libevo/control/optimizer.h"
#include "libevo/control/policy.h"
#include "libevo/control/ppo_parts.h"
#include "libevo/control/settings.h"

namespace evo {

// Samples of a rollout, one a row.
struct Samples : SampleNumbers {
  Matrix states;   // s [M x I], as networks see it
  Matrix actions;  // a [M x A], before the action map
};

// What lies between a batch and its gradients, kept from call to call.
struct LossScratch {
  Activations actor;
  Activations critic;
  std::vector<Matrix> actor_slopes;
  std::vector<Matrix> critic_slopes;
  Vector deviation;  // [A]
  Vector z;          // [A]
};

// The parts of L over a batch, and dL/d(parameters), which replaces `gradients`.
Losses differentiate(const Policy& policy, const Samples& batch, const Objective& objective,
                     Gradients& gradients, LossScratch& scratch);

// A policy's numbers in a checkpoint, under `name`; loading needs a policy of
// the same shape.
void save_policy(Checkpoint& checkpoint, const std::string& name, const Policy& policy);
void load_policy(const Checkpoint& checkpoint, const std::string& name, Policy& policy);

// An untrained policy for observations of D numbers and A actuators with targets in
// [low, high], on a base where one is given.
Policy initial_policy(const TrainingSettings& settings, int observation_length, int action_length,
                      double low, double high, std::optional<OpenLoop> base, Stream stream);

class Ppo {
 public:
  // Starts from `policy`. Random numbers come from streams named by seed and robot id.
  Ppo(const TrainingSettings& settings, Policy policy, std::uint64_t seed,
      std::string_view robot_id);

  // s_t of every environment [E x D] and the steps of its episode [E]: after the
  // first reset, and after every step once ended episodes have been reset.
  void observe(std::span<const double> observations, std::span<const int> steps);
  // Samples a_t ~ pi(.|s_t); targets [E x A].
  std::span<const double> act();
  // What a_t earned and how it ended [E]; `reached` [E x D] are the states
  // reached after `steps` [E], before any reset.
  void reward(std::span<const double> rewards, std::span<const std::uint8_t> terminated,
              std::span<const std::uint8_t> truncated, std::span<const double> reached,
              std::span<const int> steps);
  // After settings.rollout rounds of act, reward, observe: one update.
  UpdateReport learn();

  const Policy& policy() const { return policy_; }
  std::int64_t updates() const { return learner_.updates; }
  // Set once something is no longer a finite number; says what. From then on
  // nothing else may be called but policy().
  const std::optional<std::string>& divergence() const { return learner_.divergence; }

  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);  // of a Ppo made with the same arguments

 private:
  TrainingSettings settings_;
  Policy policy_;
  ppo::Learner learner_;

  std::vector<int> steps_;       // [E] of the episodes
  Matrix state_;                 // s_t, what networks see of it [E x I]
  Samples rollout_;              // being collected, rows t*E + e
  std::vector<double> targets_;  // [E x A]

  // Kept between calls, so that nothing is allocated once all have their sizes.
  Activations actor_out_;
  Activations critic_out_;
  Vector deviation_;             // [A]
  Vector z_;                     // [A]
  NetworkScratch bootstrapped_;  // of the critic
  Samples minibatch_;
  Gradients gradients_;
  LossScratch loss_scratch_;
};

}  // namespace evo
