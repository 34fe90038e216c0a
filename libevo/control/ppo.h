// Proximal policy optimisation (Schulman et al. 2017) in the notation of the
// paper: state s, action a, policy pi, advantage A^, value V, return R. The
// learner knows nothing of simulators: whoever runs environments tells it what
// was seen and earned, and asks it what to do.
//
// What it needs of a policy are its `Passes`: to look at states, to act, and to differentiate.
// policy_passes.h has those of a network for one body, modular_passes.h those of a network that
// all voxels of many bodies share.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/control/checkpoint.h"
#include "libevo/control/optimizer.h"
#include "libevo/control/policy.h"
#include "libevo/control/settings.h"

namespace evo {

struct Losses {
  double policy = 0.0;     // -E[min(r A^, clip(r, 1-eps, 1+eps) A^)], r = pi(a|s) / pi_old(a|s)
  double value = 0.0;      // E[(V - R)^2 / 2], clipped like the policy's where so set
  double entropy = 0.0;    // E[H(pi)]
  double approx_kl = 0.0;  // E[(r - 1) - log r] (Schulman 2020)
  double clipfrac = 0.0;   // share of samples with r out of [1-eps, 1+eps]
};

// Samples without their states, which belong to the passes.
struct Samples {
  std::vector<float> actions;  // a of every sample in turn, before the action map
  Vector log_probs;            // log pi_old(a|s) [M]
  Vector values;               // V_old(s)
  Vector advantages;           // A^
  Vector returns;              // R = A^ + V_old(s), before A^ is standardised

  void resize(Eigen::Index samples);  // but for the actions
};

// Independent Gaussians with deviations that do not depend on the state [17, 18]: one for each
// action of a sample, or one for all.
class Gaussians {
 public:
  void set(const Vector& log_std, std::size_t most_actions);

  std::span<const float> deviations() const { return deviations_; }
  // Where the log_std of an action stands.
  std::size_t place(std::size_t action) const { return shared_ ? 0 : action; }
  // sum log(sigma sqrt(2 pi)) over the actions of a sample.
  float log_scale(std::size_t actions) const {
    return shared_ ? static_cast<float>(actions) * log_scale_ : log_scale_;
  }

 private:
  std::vector<float> deviations_;
  float log_scale_ = 0.0F;
  bool shared_ = false;
};

// Some samples of a minibatch, one after the other, as a pass forward leaves them.
struct Chunk {
  std::size_t sample = 0;         // the first
  std::size_t action = 0;         // the first
  std::span<const float> means;   // mu(s) of every action
  std::span<const float> values;  // V(s)
  std::span<float> mean_slopes;   // dL/dmu and
  std::span<float> value_slopes;  // dL/dV, to be filled in
};

// What an update did, averaged over its minibatches.
struct UpdateReport {
  Losses losses;
  double explained_variance = 0.0;  // 1 - Var(R - V) / Var(R)
  double learning_rate = 0.0;
};

// Generalised advantage estimation (Schulman et al. 2016) over T steps of E
// environments, arrays [T*E] in the order t*E + e:
//   delta_t = r_t + gamma V(s_t+1) - V(s_t),  A^_t = delta_t + gamma lambda A^_t+1
// where an episode that ended at t leaves out what comes after. `last_values`
// [E] are V(s_T).
void estimate_advantages(std::span<const double> rewards, std::span<const std::uint8_t> ended,
                         std::span<const float> values, std::span<const float> last_values,
                         double gamma, double lambda, std::span<float> advantages);

// The parts of L = policy + c_1 value - c_2 entropy over the minibatch that the passes have
// gathered, and dL/d(parameters), which replaces their slopes. c_1 and c_2 are the settings'
// value_coefficient and entropy_coefficient. `pi` becomes that of the policy.
template <typename Passes>
Losses differentiate(Passes& passes, const Samples& batch, const TrainingSettings& settings,
                     Gaussians& pi);

// A normaliser of `length` numbers that has seen nothing.
Normalizer fresh_normalizer(int length);

// Passes are of some environments at a time, which step between two updates: those of a turn.
// They are numbered from 0; arrays that come from outside are of all environments, and these are
// the `environments()` from `first()` on.
template <typename Passes>
class Ppo {
 public:
  using Policy = typename Passes::Policy;
  using Seen = typename Passes::Seen;  // where states are read

  // `settings.environments` are all of them. Random numbers come from streams named by seed and
  // `name`.
  Ppo(const TrainingSettings& settings, Passes passes, std::uint64_t seed, std::string_view name);

  // The environments that step until the next update.
  std::size_t first_environment() const { return passes_.first(); }
  std::size_t environments() const { return passes_.environments(); }
  std::int64_t updates() const { return updates_; }
  std::int64_t updates_in_all() const;

  // s_t and the steps of the episodes: after the first reset, and after every step once ended
  // episodes have been reset.
  void observe(Seen seen, std::span<const int> steps);
  // Samples a_t ~ pi(.|s_t); targets of all actuators.
  std::span<const double> act();
  // What a_t earned and how it ended; `reached` are the states after `steps`, before any reset.
  void reward(std::span<const double> rewards, std::span<const std::uint8_t> terminated,
              std::span<const std::uint8_t> truncated, Seen reached, std::span<const int> steps);
  // After settings.rollout rounds of act, reward, observe: one update. Throws Error(work) where
  // the loss or its gradient is no longer a finite number.
  UpdateReport learn();

  const Policy& policy() const { return passes_.policy(); }

  void serialize(const Archive& archive);  // loads that of a Ppo made with the same arguments

 private:
  void begin_rollout();
  void scale(std::span<const double> rewards);
  UpdateReport weigh_rollout();
  void gather(std::span<const std::uint32_t> samples);

  TrainingSettings settings_;
  Passes passes_;
  Adam adam_;
  Stream noise_;
  Stream shuffle_;
  std::int64_t updates_ = 0;
  Normalizer return_moments_;       // of the discounted sums of rewards so far
  std::vector<double> discounted_;  // [E] these sums
  std::vector<double> targets_;     // of all actuators

  // The rollout being collected, of T steps of E environments: samples t*E + e.
  int t_ = 0;
  Samples rollout_;
  std::vector<double> rewards_;      // [T*E], scaled
  std::vector<std::uint8_t> ended_;  // [T*E]

  // Kept between calls, so that nothing is allocated once all have their sizes.
  Gaussians pi_;
  std::vector<float> z_;
  Samples minibatch_;
  std::vector<std::uint32_t> order_;  // of the samples, in an epoch
  Vector residual_;                   // [T*E]
};

void serialize(const Archive& archive, Normalizer& normalizer);

}  // namespace evo
