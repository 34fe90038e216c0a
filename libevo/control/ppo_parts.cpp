#include "libevo/control/ppo_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace evo {

void SampleNumbers::resize(Eigen::Index samples) {
  for (Vector* v : {&log_probs, &values, &advantages, &returns}) v->resize(samples);
}

void SampleNumbers::take(Eigen::Index to, const SampleNumbers& others, Eigen::Index from) {
  log_probs[to] = others.log_probs[from];
  values[to] = others.values[from];
  advantages[to] = others.advantages[from];
  returns[to] = others.returns[from];
}

// ---- advantages ---------------------------------------------------------------

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
      const double goes_on = ended[i] != 0 ? 0.0 : 1.0;
      const double value = static_cast<double>(values[i]);
      const double delta = rewards[i] + gamma * goes_on * next_value - value;
      advantage = delta + gamma * lambda * goes_on * advantage;
      advantages[i] = static_cast<float>(advantage);
      next_value = value;
    }
  }
}

namespace ppo {
namespace {

constexpr double advantage_epsilon = 1e-5;

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

std::vector<double> values_of(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

}  // namespace

bool all_finite(std::span<const double> x) {
  return std::all_of(x.begin(), x.end(), [](double value) { return std::isfinite(value); });
}

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

double learning_rate_of(const TrainingSettings& s, std::int64_t update, std::int64_t updates) {
  const auto horizon =
      static_cast<double>(s.learning_rate_horizon > 0 ? s.learning_rate_horizon : updates);
  return s.learning_rate * std::max(0.0, 1.0 - static_cast<double>(update) / horizon);
}

float add_policy_loss(float log_ratio, float advantage, float clip, float share, Losses& losses) {
  const float ratio = exp32(log_ratio);
  const float surrogate = ratio * advantage;
  const float clipped = std::clamp(ratio, 1.0F - clip, 1.0F + clip) * advantage;
  losses.policy -= static_cast<double>(std::min(surrogate, clipped));
  losses.approx_kl += static_cast<double>((ratio - 1.0F) - log_ratio);
  losses.clipfrac += std::abs(ratio - 1.0F) > clip ? 1.0 : 0.0;
  return surrogate <= clipped ? -surrogate * share : 0.0F;
}

float add_value_loss(float value, float old_value, float wanted, const Objective& objective,
                     float share, Losses& losses) {
  const auto clip = static_cast<float>(objective.clip);
  const float error = value - wanted;
  const float change = value - old_value;
  const float clipped_error = old_value + std::clamp(change, -clip, clip) - wanted;
  const bool use_clipped =
      objective.clip_value_loss && clipped_error * clipped_error > error * error;
  const float counted = use_clipped ? clipped_error : error;
  losses.value += 0.5 * static_cast<double>(counted * counted);
  return use_clipped && std::abs(change) > clip ? 0.0F : share * counted;
}

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

RewardScale::RewardScale(std::size_t environments) : discounted_(environments, 0.0) {
  moments_.mean = Eigen::VectorXd::Zero(1);
  moments_.variance = Eigen::VectorXd::Ones(1);
  moments_.count = initial_moment_count;
}

void RewardScale::scale(const TrainingSettings& settings, std::size_t first,
                        std::span<const double> rewards, std::span<const std::uint8_t> ended,
                        std::span<double> scaled) {
  const std::span discounted = std::span(discounted_).subspan(first, rewards.size());
  for (std::size_t e = 0; e < rewards.size(); ++e)
    discounted[e] = settings.gamma * discounted[e] + rewards[e];
  update(moments_, discounted);
  const double deviation = std::sqrt(moments_.variance[0] + moments_.epsilon);
  for (std::size_t e = 0; e < rewards.size(); ++e) {
    scaled[e] = std::clamp(rewards[e] / deviation, -most_deviations, most_deviations);
    if (ended[e] != 0) discounted[e] = 0.0;
  }
}

void RewardScale::save(Checkpoint& checkpoint) const {
  save_moments(checkpoint, "learner/return_moments", moments_);
  checkpoint.put("learner/discounted_returns", discounted_);
}

void RewardScale::load(const Checkpoint& checkpoint) {
  load_moments(checkpoint, "learner/return_moments", moments_);
  discounted_ = checkpoint.get<double>("learner/discounted_returns", discounted_.size());
}

Normalizer fresh_normalizer(int length) {
  Normalizer normalizer;
  normalizer.mean = Eigen::VectorXd::Zero(length);
  normalizer.variance = Eigen::VectorXd::Ones(length);
  normalizer.count = initial_moment_count;
  normalizer.clip = most_deviations;
  return normalizer;
}

void save_moments(Checkpoint& checkpoint, const std::string& name, const Normalizer& n) {
  checkpoint.put(name + "/mean", values_of(n.mean));
  checkpoint.put(name + "/variance", values_of(n.variance));
  checkpoint.put<double>(name + "/count", {n.count});
}

void load_moments(const Checkpoint& checkpoint, const std::string& name, Normalizer& n) {
  const auto length = static_cast<std::size_t>(n.mean.size());
  const auto& mean = checkpoint.get<double>(name + "/mean", length);
  const auto& variance = checkpoint.get<double>(name + "/variance", length);
  std::copy(mean.begin(), mean.end(), n.mean.begin());
  std::copy(variance.begin(), variance.end(), n.variance.begin());
  n.count = checkpoint.get<double>(name + "/count", 1)[0];
}

void shuffle(std::span<std::uint32_t> order, Stream& stream) {
  for (std::size_t i = order.size() - 1; i > 0; --i)
    std::swap(order[i], order[stream.below(static_cast<std::uint32_t>(i) + 1)]);
}

Learner::Learner(std::size_t parameters, std::size_t environments, std::uint64_t seed,
                 std::string_view name)
    : adam(parameters),
      noise(seed, "train/noise", name),
      order_stream(seed, "train/shuffle", name),
      reward_scale(environments) {}

void Learner::begin_rollout(std::size_t samples) {
  t = 0;
  rewards.resize(samples);
  ended.resize(samples);
}

void Learner::scale_rewards(const TrainingSettings& settings, std::size_t first,
                            std::span<const double> step_rewards,
                            std::span<const std::uint8_t> terminated,
                            std::span<const std::uint8_t> truncated) {
  if (!all_finite(step_rewards)) divergence = "a reward is not a finite number";
  const std::size_t count = step_rewards.size();
  const std::size_t begin = static_cast<std::size_t>(t) * count;
  for (std::size_t e = 0; e < count; ++e)
    ended[begin + e] = terminated[e] != 0 || truncated[e] != 0 ? 1 : 0;
  reward_scale.scale(settings, first, step_rewards, std::span(ended).subspan(begin, count),
                     std::span(rewards).subspan(begin, count));
}

UpdateReport Learner::weigh_rollout(const TrainingSettings& settings, std::int64_t updates_in_all,
                                    SampleNumbers& rollout, std::span<const float> last_values) {
  estimate_advantages(
      rewards, ended, view(rollout.values), last_values, settings.gamma, settings.lambda,
      {rollout.advantages.data(), static_cast<std::size_t>(rollout.advantages.size())});
  rollout.returns = rollout.advantages + rollout.values;
  standardize(rollout.advantages);
  UpdateReport report;
  report.learning_rate = learning_rate_of(settings, updates, updates_in_all);  // [4]
  report.explained_variance = explained_variance(rollout.returns, rollout.values, residual_);
  return report;
}

void Learner::save(Checkpoint& checkpoint) const {
  checkpoint.put("learner/adam/first", adam.first);
  checkpoint.put("learner/adam/second", adam.second);
  checkpoint.put<double>("learner/adam/powers", {adam.first_power, adam.second_power});
  checkpoint.put("learner/noise", noise);
  checkpoint.put("learner/shuffle", order_stream);
  checkpoint.put<std::uint64_t>("learner/updates", {static_cast<std::uint64_t>(updates)});
  reward_scale.save(checkpoint);
}

void Learner::load(const Checkpoint& checkpoint) {
  adam.first = checkpoint.get<float>("learner/adam/first", adam.first.size());
  adam.second = checkpoint.get<float>("learner/adam/second", adam.second.size());
  const auto& powers = checkpoint.get<double>("learner/adam/powers", 2);
  adam.first_power = powers[0];
  adam.second_power = powers[1];
  checkpoint.get("learner/noise", noise);
  checkpoint.get("learner/shuffle", order_stream);
  updates = static_cast<std::int64_t>(checkpoint.get<std::uint64_t>("learner/updates", 1)[0]);
  reward_scale.load(checkpoint);
}

}  // namespace ppo
}  // namespace evo
