// Read from top to bottom: the objective and its gradient, then the learner that uses them.
// Implementation details carry the numbers of "The 37 Implementation Details of Proximal Policy
// Optimization" (Huang et al. 2022) in brackets.
#include "libevo/control/ppo.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"
#include "libevo/control/modular_passes.h"
#include "libevo/control/policy_passes.h"

namespace evo {
namespace {

constexpr double half_log_two_pi = 0.9189385332046727;
constexpr double initial_moment_count = 1e-4;  // weight of the prior mean 0, variance 1
constexpr double most_deviations = 10.0;       // where normalised numbers are clipped
constexpr double adam_epsilon = 1e-5;          // added to the root of the second moment
constexpr double advantage_epsilon = 1e-5;

float exp32(float x) { return static_cast<float>(math::exp(static_cast<double>(x))); }

std::span<const float> view(const Vector& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

// log pi(a|s) without log_scale(); `z` receives (a - mu) / sigma.
float log_density(std::span<const float> actions, std::span<const float> means,
                  std::span<const float> deviations, std::span<float> z) {
  float sum = 0.0F;
  for (std::size_t i = 0; i < actions.size(); ++i) {
    z[i] = (actions[i] - means[i]) / deviations[i];
    sum += z[i] * z[i];
  }
  return -0.5F * sum;
}

// [8] Clipped surrogate objective of a sample, added to `losses`; dL/d log pi, nothing where
// the clipped, constant branch is the smaller.
float add_policy_loss(float log_ratio, float advantage, float clip, float share, Losses& losses) {
  const float ratio = exp32(log_ratio);
  const float surrogate = ratio * advantage;
  const float clipped = std::clamp(ratio, 1.0F - clip, 1.0F + clip) * advantage;
  losses.policy -= static_cast<double>(std::min(surrogate, clipped));
  losses.approx_kl += static_cast<double>((ratio - 1.0F) - log_ratio);
  losses.clipfrac += std::abs(ratio - 1.0F) > clip ? 1.0 : 0.0;
  return surrogate <= clipped ? -surrogate * share : 0.0F;
}

// [9] Value loss, clipped around the old value if so set, added to `losses`; dL/dV.
float add_value_loss(float value, float old_value, float wanted, const TrainingSettings& settings,
                     float share, Losses& losses) {
  const auto clip = static_cast<float>(settings.clip);
  const float error = value - wanted;
  const float change = value - old_value;
  const float clipped_error = old_value + std::clamp(change, -clip, clip) - wanted;
  const bool use_clipped =
      settings.clip_value_loss && clipped_error * clipped_error > error * error;
  const float counted = use_clipped ? clipped_error : error;
  losses.value += 0.5 * static_cast<double>(counted * counted);
  return use_clipped && std::abs(change) > clip ? 0.0F : share * counted;
}

// Sums over samples become means.
void divide(Losses& losses, double samples) {
  for (double* loss :
       {&losses.policy, &losses.value, &losses.entropy, &losses.approx_kl, &losses.clipfrac})
    *loss /= samples;
}

void add(Losses& sum, const Losses& losses) {
  sum.policy += losses.policy;
  sum.value += losses.value;
  sum.entropy += losses.entropy;
  sum.approx_kl += losses.approx_kl;
  sum.clipfrac += losses.clipfrac;
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;  // of the sample: divided by n - 1
};

Moments moments(std::span<const float> x) {
  Moments result;
  for (const float value : x) result.mean += static_cast<double>(value);
  result.mean /= static_cast<double>(x.size());
  for (const float value : x) {
    const double difference = static_cast<double>(value) - result.mean;
    result.variance += difference * difference;
  }
  result.variance /= std::max(1.0, static_cast<double>(x.size()) - 1.0);
  return result;
}

// [7] Advantages with mean 0 and deviation 1.
void standardize(Vector& advantages) {
  const Moments m = moments(view(advantages));
  const double deviation = std::sqrt(m.variance) + advantage_epsilon;
  for (float& a : advantages) a = static_cast<float>((static_cast<double>(a) - m.mean) / deviation);
}

double explained_variance(const Vector& returns, const Vector& values, Vector& residual) {
  residual = returns - values;
  const double total = moments(view(returns)).variance;
  return total > 0.0 ? 1.0 - moments(view(residual)).variance / total : 0.0;
}

// [4] Of an update that is one of `updates`: linear to 0.
double learning_rate_of(const TrainingSettings& s, std::int64_t update, std::int64_t updates) {
  const auto horizon =
      static_cast<double>(s.learning_rate_horizon > 0 ? s.learning_rate_horizon : updates);
  return s.learning_rate * std::max(0.0, 1.0 - static_cast<double>(update) / horizon);
}

// [6] By Fisher and Yates.
void shuffle(std::span<std::uint32_t> order, Stream& stream) {
  for (std::size_t i = order.size() - 1; i > 0; --i)
    std::swap(order[i], order[stream.below(static_cast<std::uint32_t>(i) + 1)]);
}

}  // namespace

void Gaussians::set(const Vector& log_std, std::size_t most_actions) {
  shared_ = log_std.size() == 1;
  deviations_.resize(most_actions);
  for (std::size_t j = 0; j < most_actions; ++j)
    deviations_[j] = exp32(log_std[static_cast<Eigen::Index>(place(j))]);
  double sum = 0.0;
  for (const float s : log_std) sum += static_cast<double>(s) + half_log_two_pi;
  log_scale_ = static_cast<float>(sum);
}

void Samples::resize(Eigen::Index samples) {
  for (Vector* v : {&log_probs, &values, &advantages, &returns}) v->resize(samples);
}

Normalizer fresh_normalizer(int length) {
  Normalizer normalizer;
  normalizer.mean = Eigen::VectorXd::Zero(length);
  normalizer.variance = Eigen::VectorXd::Ones(length);
  normalizer.count = initial_moment_count;
  normalizer.clip = most_deviations;
  return normalizer;
}

void estimate_advantages(std::span<const double> rewards, std::span<const std::uint8_t> ended,
                         std::span<const float> values, std::span<const float> last_values,
                         double gamma, double lambda, std::span<float> advantages) {
  const std::size_t environments = last_values.size();
  const std::size_t steps = rewards.size() / environments;
  for (std::size_t e = 0; e < environments; ++e) {
    double next_value = static_cast<double>(last_values[e]);
    double advantage = 0.0;
    for (std::size_t t = steps; t-- > 0;) {
      const std::size_t i = t * environments + e;
      const double continues = ended[i] != 0 ? 0.0 : 1.0;
      const double value = static_cast<double>(values[i]);
      const double delta = rewards[i] + gamma * continues * next_value - value;
      advantage = delta + gamma * lambda * continues * advantage;
      advantages[i] = static_cast<float>(advantage);
      next_value = value;
    }
  }
}

// ---- the objective ------------------------------------------------------------

template <typename Passes>
Losses differentiate(Passes& passes, const Samples& batch, const TrainingSettings& settings,
                     Gaussians& pi) {
  const auto samples = static_cast<std::size_t>(batch.log_probs.size());
  const float share = 1.0F / static_cast<float>(samples);
  const auto clip = static_cast<float>(settings.clip);
  const auto value_share = static_cast<float>(settings.value_coefficient) * share;
  pi.set(passes.policy().log_std, passes.most_actions());
  const std::span<const float> deviations = pi.deviations();
  Vector& log_std_slope = passes.begin_backward();
  Losses losses;
  passes.each_chunk([&](const Chunk& chunk) {
    std::size_t first = 0;  // action
    for (std::size_t m = 0; m < chunk.values.size(); ++m) {
      const auto i = static_cast<Eigen::Index>(chunk.sample + m);
      const std::size_t count = passes.actions_of_sample(chunk.sample + m);
      // z becomes the slope.
      const std::span<float> z = chunk.mean_slopes.subspan(first, count);
      const float log_ratio =
          log_density(std::span(batch.actions).subspan(chunk.action + first, count),
                      chunk.means.subspan(first, count), deviations, z) -
          pi.log_scale(count) - batch.log_probs[i];
      const float g = add_policy_loss(log_ratio, batch.advantages[i], clip, share, losses);
      for (std::size_t j = 0; j < count; ++j) {
        log_std_slope[static_cast<Eigen::Index>(pi.place(j))] += g * (z[j] * z[j] - 1.0F);
        z[j] = g * z[j] / deviations[j];
      }
      chunk.value_slopes[m] = add_value_loss(chunk.values[m], batch.values[i], batch.returns[i],
                                             settings, value_share, losses);
      // [10] Entropy of the Gaussians: sum_j (1/2 + log(sigma_j sqrt(2 pi))).
      losses.entropy += 0.5 * static_cast<double>(count) + static_cast<double>(pi.log_scale(count));
      first += count;
    }
  });
  divide(losses, static_cast<double>(samples));
  const double actions_per_deviation = static_cast<double>(batch.actions.size()) /
                                       static_cast<double>(samples) /
                                       static_cast<double>(log_std_slope.size());
  log_std_slope.array() -= static_cast<float>(settings.entropy_coefficient * actions_per_deviation);
  passes.end_backward();
  return losses;
}

// ---- the learner --------------------------------------------------------------

template <typename Passes>
Ppo<Passes>::Ppo(const TrainingSettings& settings, Passes passes, std::uint64_t seed,
                 std::string_view name)
    : settings_(settings),
      passes_(std::move(passes)),
      adam_(parameter_count(passes_.policy())),
      noise_(seed, "train/noise", name),
      shuffle_(seed, "train/shuffle", name),
      return_moments_(fresh_normalizer(1)),
      discounted_(static_cast<std::size_t>(settings.environments), 0.0),
      targets_(passes_.targets(), 1.0) {
  begin_rollout();
}

template <typename Passes>
std::int64_t Ppo<Passes>::updates_in_all() const {
  return settings_.steps * passes_.turns() / settings_.batch();
}

template <typename Passes>
void Ppo<Passes>::begin_rollout() {
  passes_.begin_turn(updates_, settings_.rollout);
  const auto steps = static_cast<std::size_t>(settings_.rollout);
  const std::size_t samples = steps * passes_.environments();
  t_ = 0;
  rollout_.resize(static_cast<Eigen::Index>(samples));
  rollout_.actions.resize(steps * passes_.first_action(passes_.environments()));
  rewards_.resize(samples);
  ended_.resize(samples);
}

// [20, 21] Observations are normalised by running moments and clipped.
template <typename Passes>
void Ppo<Passes>::observe(Seen seen, std::span<const int> steps) {
  passes_.look(seen, steps);
}

// [19] The log-probability is that of the action before it is clipped.
template <typename Passes>
std::span<const double> Ppo<Passes>::act() {
  passes_.act();
  passes_.keep(t_);
  const std::span<const float> means = passes_.means();
  pi_.set(passes_.policy().log_std, passes_.most_actions());
  const std::span<const float> deviations = pi_.deviations();
  z_.resize(passes_.most_actions());
  const std::size_t environments = passes_.environments();
  const std::span actions = std::span(rollout_.actions)
                                .subspan(static_cast<std::size_t>(t_) * means.size(), means.size());
  const std::span targets = std::span(targets_).subspan(passes_.first_target(), means.size());
  for (std::size_t e = 0; e < environments; ++e) {
    const std::size_t first = passes_.first_action(e);
    const std::size_t count = passes_.first_action(e + 1) - first;
    passes_.rest(e, targets.subspan(first, count));
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t i = first + j;
      actions[i] = means[i] + deviations[j] * static_cast<float>(noise_.gaussian());
      targets[i] = passes_.target(targets[i], static_cast<double>(actions[i]));
    }
    const auto row = static_cast<Eigen::Index>(static_cast<std::size_t>(t_) * environments + e);
    rollout_.log_probs[row] =
        log_density(actions.subspan(first, count), means.subspan(first, count), deviations, z_) -
        pi_.log_scale(count);
    rollout_.values[row] = passes_.values()[e];
  }
  return targets_;
}

template <typename Passes>
void Ppo<Passes>::reward(std::span<const double> rewards, std::span<const std::uint8_t> terminated,
                         std::span<const std::uint8_t> truncated, Seen reached,
                         std::span<const int> steps) {
  const std::size_t first = passes_.first();
  const std::size_t count = passes_.environments();
  const std::size_t begin = static_cast<std::size_t>(t_) * count;
  for (std::size_t e = 0; e < count; ++e)
    ended_[begin + e] = terminated[first + e] != 0 || truncated[first + e] != 0 ? 1 : 0;
  scale(rewards.subspan(first, count));
  // An episode that the time limit cut off is worth what its last state is, as well (Pardo et
  // al. 2018).
  if (settings_.time_limit == TimeLimit::bootstrap)
    for (std::size_t e = 0; e < count; ++e)
      if (truncated[first + e] != 0 && terminated[first + e] == 0)
        rewards_[begin + e] +=
            settings_.gamma * static_cast<double>(passes_.value(reached, steps, e));
  ++t_;
}

// [22, 23] Rewards are divided by the deviation of the discounted sum of rewards, a rolling
// one without look-ahead, and clipped.
template <typename Passes>
void Ppo<Passes>::scale(std::span<const double> rewards) {
  const std::size_t begin = static_cast<std::size_t>(t_) * rewards.size();
  const std::span sums = std::span(discounted_).subspan(passes_.first(), rewards.size());
  for (std::size_t e = 0; e < rewards.size(); ++e) sums[e] = settings_.gamma * sums[e] + rewards[e];
  update(return_moments_, sums);
  const double deviation = std::sqrt(return_moments_.variance[0] + return_moments_.epsilon);
  for (std::size_t e = 0; e < rewards.size(); ++e) {
    rewards_[begin + e] = std::clamp(rewards[e] / deviation, -most_deviations, most_deviations);
    if (ended_[begin + e] != 0) sums[e] = 0.0;
  }
}

template <typename Passes>
UpdateReport Ppo<Passes>::weigh_rollout() {
  passes_.evaluate();  // V(s_T)
  estimate_advantages(
      rewards_, ended_, view(rollout_.values), passes_.values(), settings_.gamma, settings_.lambda,
      {rollout_.advantages.data(), static_cast<std::size_t>(rollout_.advantages.size())});
  rollout_.returns = rollout_.advantages + rollout_.values;
  standardize(rollout_.advantages);
  UpdateReport report;
  report.learning_rate = learning_rate_of(settings_, updates_, updates_in_all());
  report.explained_variance = explained_variance(rollout_.returns, rollout_.values, residual_);
  return report;
}

template <typename Passes>
UpdateReport Ppo<Passes>::learn() {
  UpdateReport report = weigh_rollout();
  // [6] Epochs of minibatches.
  order_.resize(rewards_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  const std::size_t size = order_.size() / static_cast<std::size_t>(settings_.minibatches);
  for (int epoch = 0; epoch < settings_.epochs; ++epoch) {
    shuffle(order_, shuffle_);
    for (int m = 0; m < settings_.minibatches; ++m) {
      gather(std::span(order_).subspan(static_cast<std::size_t>(m) * size, size));
      const Losses losses = differentiate(passes_, minibatch_, settings_, pi_);
      const auto slopes = passes_.slopes();
      const double norm = clip_norm(slopes, settings_.max_gradient_norm);  // [11]
      if (!std::isfinite(norm) || !std::isfinite(losses.policy + losses.value + losses.entropy))
        throw Error(Failure::work, "the loss or its gradient is not a finite number");
      adam_.step(passes_.parameters(), slopes, report.learning_rate, adam_epsilon);  // [5]
      add(report.losses, losses);
    }
  }
  divide(report.losses, settings_.epochs * settings_.minibatches);
  ++updates_;
  begin_rollout();
  return report;
}

// Into minibatch_, and the passes' own.
template <typename Passes>
void Ppo<Passes>::gather(std::span<const std::uint32_t> samples) {
  passes_.gather(samples);
  minibatch_.resize(static_cast<Eigen::Index>(samples.size()));
  minibatch_.actions.clear();
  const std::size_t environments = passes_.environments();
  const std::size_t a_step = passes_.first_action(environments);
  for (std::size_t m = 0; m < samples.size(); ++m) {
    const std::size_t e = samples[m] % environments;
    const auto begin =
        rollout_.actions.begin() + static_cast<std::ptrdiff_t>(samples[m] / environments * a_step);
    minibatch_.actions.insert(minibatch_.actions.end(),
                              begin + static_cast<std::ptrdiff_t>(passes_.first_action(e)),
                              begin + static_cast<std::ptrdiff_t>(passes_.first_action(e + 1)));
    const auto to = static_cast<Eigen::Index>(m);
    const auto from = static_cast<Eigen::Index>(samples[m]);
    minibatch_.log_probs[to] = rollout_.log_probs[from];
    minibatch_.values[to] = rollout_.values[from];
    minibatch_.advantages[to] = rollout_.advantages[from];
    minibatch_.returns[to] = rollout_.returns[from];
  }
}

// ---- checkpoints ----------------------------------------------------------------

void serialize(const Archive& archive, Normalizer& normalizer) {
  archive.row<double>("mean", normalizer.mean);
  archive.row<double>("variance", normalizer.variance);
  archive.numbers<double>("count", normalizer.count);
}

template <typename Passes>
void Ppo<Passes>::serialize(const Archive& archive) {
  archive.numbers<std::uint64_t>("updates", updates_);
  passes_.serialize(archive);
  if (archive.loads()) begin_rollout();
  archive.row<float>("adam/first", adam_.first);
  archive.row<float>("adam/second", adam_.second);
  archive.numbers<double>("adam/powers", adam_.first_power, adam_.second_power);
  archive.stream("noise", noise_);
  archive.stream("shuffle", shuffle_);
  evo::serialize(archive.part("return_moments"), return_moments_);
  archive.row<double>("discounted_returns", discounted_);
}

template Losses differentiate(PolicyPasses&, const Samples&, const TrainingSettings&, Gaussians&);
template Losses differentiate(ModularPasses&, const Samples&, const TrainingSettings&, Gaussians&);
template class Ppo<PolicyPasses>;
template class Ppo<ModularPasses>;

}  // namespace evo
