// What the learners of proximal policy optimisation share, whatever their policy is made of:
// ppo.h's networks over an observation, modular_ppo.h's over the voxels of many bodies.
// Numbers in brackets as in ppo.cpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libevo/base/elementary.h"
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

// L = policy + c_1 value - c_2 entropy.
struct Objective {
  double clip = 0.1;
  bool clip_value_loss = true;
  double value_coefficient = 0.5;     // c_1
  double entropy_coefficient = 0.01;  // c_2
};

// Generalised advantage estimation (Schulman et al. 2016) over T steps of E
// environments, arrays [T*E] in the order t*E + e:
//   delta_t = r_t + gamma V(s_t+1) - V(s_t),  A^_t = delta_t + gamma lambda A^_t+1
// where an episode that ended at t leaves out what comes after. `last_values`
// [E] are V(s_T).
void estimate_advantages(std::span<const double> rewards, std::span<const std::uint8_t> ended,
                         std::span<const float> values, std::span<const float> last_values,
                         double gamma, double lambda, std::span<float> advantages);

// What an update did, averaged over its minibatches.
struct UpdateReport {
  Losses losses;
  double explained_variance = 0.0;  // 1 - Var(R - V) / Var(R)
  double learning_rate = 0.0;
};

namespace ppo {

inline constexpr double half_log_two_pi = 0.9189385332046727;
inline constexpr double initial_moment_count = 1e-4;  // weight of the prior mean 0, variance 1

inline float exp32(float x) { return static_cast<float>(math::exp(static_cast<double>(x))); }

inline std::span<const float> view(const Vector& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

bool all_finite(std::span<const double> x);

// [7] Advantages with mean 0 and deviation 1.
void standardize(Vector& advantages);

double explained_variance(const Vector& returns, const Vector& values, Vector& residual);

double scheduled(double value, Schedule schedule, std::int64_t update, std::int64_t horizon);

// Rate and objective of an update that is one of `updates`.
double learning_rate_of(const TrainingSettings& settings, std::int64_t update,
                        std::int64_t updates);
Objective objective_of(const TrainingSettings& settings, std::int64_t update, std::int64_t updates);

// [8] Clipped surrogate objective of a sample, added to `losses`; dL/d log pi, nothing where
// the clipped, constant branch is the smaller.
float add_policy_loss(float log_ratio, float advantage, float clip, float share, Losses& losses);
// [9] Value loss, clipped around the old value if so set, added to `losses`; dL/dV.
float add_value_loss(float value, float old_value, float wanted, const Objective& objective,
                     float share, Losses& losses);
// Sums over samples become means.
void divide(Losses& losses, double samples);
void add(Losses& sum, const Losses& losses);

// [22, 23] Rewards are divided by the deviation of the discounted sum of rewards, a rolling
// one without look-ahead, and clipped.
class RewardScale {
 public:
  explicit RewardScale(std::size_t environments);
  // Of environments `first` and following, into `scaled`; `ended` are episodes that are over.
  void scale(const TrainingSettings& settings, std::size_t first, std::span<const double> rewards,
             std::span<const std::uint8_t> ended, std::span<double> scaled);
  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

 private:
  Normalizer moments_;              // of the discounted returns so far
  std::vector<double> discounted_;  // [E]
};

// What a learner has beside its policy and what it sees.
struct Learner {
  // For so many parameters and environments. Random numbers come from streams named by seed
  // and `name`.
  Learner(std::size_t parameters, std::size_t environments, std::uint64_t seed,
          std::string_view name);

  Adam adam;
  Stream noise;
  Stream shuffle;
  std::int64_t updates = 0;
  RewardScale reward_scale;
  std::vector<double> colour;  // of all actuators: exploration, of unit variance

  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);  // of a learner as large
};

// Parameters, which `blocks` gives as runs of floats, in a checkpoint.
template <typename Blocks>
void save_parameters(Checkpoint& checkpoint, const std::string& name, const Blocks& blocks) {
  std::vector<float> parameters;
  for (std::size_t b = 0; b < blocks.size(); ++b)
    parameters.insert(parameters.end(), blocks[b].begin(), blocks[b].end());
  checkpoint.put(name, std::move(parameters));
}
template <typename Blocks>
void load_parameters(const Checkpoint& checkpoint, const std::string& name, const Blocks& blocks,
                     std::size_t count) {
  auto next = checkpoint.get<float>(name, count).begin();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::span<float> block = blocks[b];
    std::copy_n(next, block.size(), block.begin());
    next += static_cast<std::ptrdiff_t>(block.size());
  }
}

// A normaliser that has seen nothing, of `length` numbers.
Normalizer fresh_normalizer(const TrainingSettings& settings, int length);

void save_moments(Checkpoint& checkpoint, const std::string& name, const Normalizer& n);
void load_moments(const Checkpoint& checkpoint, const std::string& name, Normalizer& n);

// [6] Shuffled by Fisher and Yates.
void shuffle(std::span<std::uint32_t> order, Stream& stream);

}  // namespace ppo
}  // namespace evo
