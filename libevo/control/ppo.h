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
#include "libevo/control/policy.h"
#include "libevo/control/settings.h"

namespace evo {

// Samples of a rollout, one a row.
struct Samples {
  Matrix states;      // s [M x I], as networks see it
  Matrix actions;     // a [M x A], before the action map
  Vector log_probs;   // log pi_old(a|s)
  Vector values;      // V_old(s)
  Vector advantages;  // A^
  Vector returns;     // R = A^ + V_old(s), before A^ is standardised
};

struct Losses {
  double policy = 0.0;     // -E[min(r A^, clip(r, 1-eps, 1+eps) A^)], r = pi(a|s) / pi_old(a|s)
  double value = 0.0;      // E[(V - R)^2 / 2], clipped like the policy's where so set
  double entropy = 0.0;    // E[H(pi)]
  double approx_kl = 0.0;  // E[(r - 1) - log r] (Schulman 2020)
  double clipfrac = 0.0;   // share of samples with r out of [1-eps, 1+eps]
};

// L = policy + c_1 value - c_2 entropy.
struct Objective {
  double clip = 0.1;
  bool clip_value_loss = true;
  double value_coefficient = 0.5;     // c_1
  double entropy_coefficient = 0.01;  // c_2
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

// Generalised advantage estimation (Schulman et al. 2016) over T steps of E
// environments, arrays [T*E] in the order t*E + e:
//   delta_t = r_t + gamma V(s_t+1) - V(s_t),  A^_t = delta_t + gamma lambda A^_t+1
// where an episode that ended at t leaves out what comes after. `last_values`
// [E] are V(s_T).
void estimate_advantages(std::span<const double> rewards, std::span<const std::uint8_t> ended,
                         std::span<const float> values, std::span<const float> last_values,
                         double gamma, double lambda, std::span<float> advantages);

// Adam (Kingma and Ba 2015), beta 0.9 and 0.999.
struct Adam {
  std::vector<float> first;   // m, in the order of ParameterBlocks
  std::vector<float> second;  // v
  double first_power = 1.0;   // beta_1^t
  double second_power = 1.0;  // beta_2^t

  explicit Adam(std::size_t parameters = 0) : first(parameters), second(parameters) {}
  void step(Policy& policy, Gradients& gradients, double learning_rate, double epsilon);
};

// Scales the gradients so that their norm is at most `limit` (0: none); returns
// the norm they had.
double clip_norm(Gradients& gradients, double limit);

// A policy's numbers in a checkpoint, under `name`; loading needs a policy of
// the same shape.
void save_policy(Checkpoint& checkpoint, const std::string& name, const Policy& policy);
void load_policy(const Checkpoint& checkpoint, const std::string& name, Policy& policy);

// What an update did, averaged over its minibatches.
struct UpdateReport {
  Losses losses;
  double explained_variance = 0.0;  // 1 - Var(R - V) / Var(R)
  double learning_rate = 0.0;
};

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
  std::int64_t updates() const { return updates_; }
  // Set once something is no longer a finite number; says what. From then on
  // nothing else may be called but policy().
  const std::optional<std::string>& divergence() const { return divergence_; }

  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);  // of a Ppo made with the same arguments

 private:
  void scale_rewards(std::span<const double> rewards, std::span<const std::uint8_t> ended);
  void bootstrap_truncated(std::span<const std::uint8_t> terminated,
                           std::span<const std::uint8_t> truncated, std::span<const double> reached,
                           std::span<const int> steps);
  bool learn_minibatch(std::span<const std::uint32_t> samples, double learning_rate,
                       const Objective& objective, Losses& sum);

  TrainingSettings settings_;
  Policy policy_;
  Adam adam_;
  Stream noise_;
  Stream shuffle_;
  std::int64_t updates_ = 0;
  std::optional<std::string> divergence_;

  // Reward scaling: running moments of the discounted returns so far.
  Normalizer return_moments_;
  std::vector<double> discounted_returns_;  // [E]

  // The rollout being collected, rows t*E + e.
  int t_ = 0;
  std::vector<int> steps_;      // [E] of the episodes
  Matrix state_;                // s_t, what networks see of it [E x I]
  std::vector<double> colour_;  // [E x A] exploration, of unit variance
  Samples rollout_;
  std::vector<double> rewards_;      // [T*E], scaled
  std::vector<std::uint8_t> ended_;  // [T*E]
  std::vector<double> targets_;      // [E x A]

  // Kept between calls, so that nothing is allocated once all have their sizes.
  Activations actor_out_;
  Activations critic_out_;
  Vector deviation_;             // [A]
  Vector z_;                     // [A]
  NetworkScratch bootstrapped_;  // of the critic
  Samples minibatch_;
  std::vector<std::uint32_t> order_;  // of the samples, in an epoch
  Vector residual_;                   // [T*E]
  Gradients gradients_;
  LossScratch loss_scratch_;
};

}  // namespace evo
