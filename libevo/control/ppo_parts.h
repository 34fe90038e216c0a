// What the learners of proximal policy optimisation share, whatever their policy is made of:
// ppo.h's networks over an observation, modular_ppo.h's over the voxels of many bodies.
// Numbers in brackets as in ppo.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
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

// What is known of samples beside their states and actions.
struct SampleNumbers {
  Vector log_probs;   // log pi_old(a|s) [M]
  Vector values;      // V_old(s)
  Vector advantages;  // A^
  Vector returns;     // R = A^ + V_old(s), before A^ is standardised

  void resize(Eigen::Index samples);
  // Sample `to` becomes what sample `from` of the others is.
  void take(Eigen::Index to, const SampleNumbers& others, Eigen::Index from);
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
inline constexpr double adam_epsilon = 1e-5;          // added to the root of the second moment
inline constexpr double most_deviations = 10.0;       // where normalised numbers are clipped

inline float exp32(float x) { return static_cast<float>(math::exp(static_cast<double>(x))); }

inline std::span<const float> view(const Vector& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

bool all_finite(std::span<const double> x);

// [7] Advantages with mean 0 and deviation 1.
void standardize(Vector& advantages);

double explained_variance(const Vector& returns, const Vector& values, Vector& residual);

// [4] Of an update that is one of `updates`: linear to 0.
double learning_rate_of(const TrainingSettings& settings, std::int64_t update,
                        std::int64_t updates);

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

// [6] Shuffled by Fisher and Yates.
void shuffle(std::span<std::uint32_t> order, Stream& stream);

// The algorithm, whatever the policy: what a learner has and does beside its policy and the
// states that this sees.
struct Learner {
  // For so many parameters and environments. Random numbers come from streams named by seed
  // and `name`.
  Learner(std::size_t parameters, std::size_t environments, std::uint64_t seed,
          std::string_view name);

  Adam adam;
  Stream noise;
  Stream order_stream;
  std::int64_t updates = 0;
  RewardScale reward_scale;
  // Set once something is no longer a finite number; says what.
  std::optional<std::string> divergence;

  // The rollout being collected, of T steps of E environments: samples t*E + e.
  int t = 0;
  std::vector<double> rewards;      // [T*E], scaled
  std::vector<std::uint8_t> ended;  // [T*E]

  void begin_rollout(std::size_t samples);

  // What the actions of step t earned and how they ended, of environments `first` and following.
  // value_of(e) is V of the state in which the time limit cut off the e-th of them: an
  // episode is worth that as well (Pardo et al. 2018). Goes on to the next step.
  template <typename ValueOf>
  void reward(const TrainingSettings& settings, std::size_t first,
              std::span<const double> step_rewards, std::span<const std::uint8_t> terminated,
              std::span<const std::uint8_t> truncated, ValueOf value_of) {
    const std::size_t count = step_rewards.size();
    const std::size_t begin = static_cast<std::size_t>(t) * count;
    scale_rewards(settings, first, step_rewards, terminated, truncated);
    if (settings.time_limit == TimeLimit::bootstrap)
      for (std::size_t e = 0; e < count; ++e)
        if (truncated[e] != 0 && terminated[e] == 0)
          rewards[begin + e] += settings.gamma * static_cast<double>(value_of(e));
    ++t;
  }

  // One update, of `updates_in_all`, from the rollout, whose log_probs and values are given;
  // `last_values` [E] are V(s_T). gather(samples) puts these samples together;
  // differentiate(objective) then returns their losses and leaves the gradients where
  // `slopes` shows them. Where numbers stop being finite it ends early, with a divergence.
  template <typename Parameters, typename Slopes, typename Gather, typename Differentiate>
  UpdateReport learn(const TrainingSettings& settings, std::int64_t updates_in_all,
                     SampleNumbers& rollout, std::span<const float> last_values,
                     const Parameters& parameters, const Slopes& slopes, Gather gather,
                     Differentiate differentiate) {
    UpdateReport report = weigh_rollout(settings, updates_in_all, rollout, last_values);
    const Objective objective{settings.clip, settings.clip_value_loss, settings.value_coefficient,
                              settings.entropy_coefficient};
    // [6] Epochs of minibatches.
    order_.resize(rewards.size());
    std::iota(order_.begin(), order_.end(), 0U);
    const std::size_t size = order_.size() / static_cast<std::size_t>(settings.minibatches);
    for (int epoch = 0; epoch < settings.epochs; ++epoch) {
      shuffle(order_, order_stream);
      for (int m = 0; m < settings.minibatches; ++m) {
        gather(std::span<const std::uint32_t>(order_).subspan(static_cast<std::size_t>(m) * size,
                                                              size));
        const Losses losses = differentiate(objective);
        const double norm = clip_norm(slopes, settings.max_gradient_norm);  // [11]
        if (!std::isfinite(norm) || !std::isfinite(losses.policy + losses.value + losses.entropy)) {
          divergence = "the loss or its gradient is not a finite number";
          return report;
        }
        adam.step(parameters, slopes, report.learning_rate, adam_epsilon);  // [5]
        add(report.losses, losses);
      }
    }
    divide(report.losses, settings.epochs * settings.minibatches);
    ++updates;
    return report;
  }

  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);  // of a learner as large

 private:
  void scale_rewards(const TrainingSettings& settings, std::size_t first,
                     std::span<const double> step_rewards, std::span<const std::uint8_t> terminated,
                     std::span<const std::uint8_t> truncated);
  UpdateReport weigh_rollout(const TrainingSettings& settings, std::int64_t updates_in_all,
                             SampleNumbers& rollout, std::span<const float> last_values);

  std::vector<std::uint32_t> order_;  // of the samples, in an epoch
  Vector residual_;                   // [T*E]
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
Normalizer fresh_normalizer(int length);

void save_moments(Checkpoint& checkpoint, const std::string& name, const Normalizer& n);
void load_moments(const Checkpoint& checkpoint, const std::string& name, Normalizer& n);

}  // namespace ppo
}  // namespace evo
