#include "libevo/control/evolution_strategy.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libevo/base/elementary.h"

namespace evo {

EvolutionStrategy::EvolutionStrategy(std::vector<double> mean, double sigma, int population)
    : mean_(std::move(mean)),
      sigma_(sigma),
      population_(static_cast<std::size_t>(population)),
      covariance_(mean_.size(), 1.0),
      path_(mean_.size(), 0.0),
      step_path_(mean_.size(), 0.0),
      weights_(population_ / 2) {
  for (std::size_t i = 0; i < weights_.size(); ++i)
    weights_[i] = math::log(static_cast<double>(population + 1) / 2.0) -
                  math::log(static_cast<double>(i + 1));
  const double sum = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  double squares = 0.0;
  for (double& w : weights_) {
    w /= sum;
    squares += w * w;
  }
  effective_ = 1.0 / squares;
}

std::vector<std::vector<double>> EvolutionStrategy::ask(Stream& stream) const {
  std::vector<std::vector<double>> candidates(population_, mean_);
  for (std::vector<double>& x : candidates)
    for (std::size_t j = 0; j < x.size(); ++j)
      x[j] += sigma_ * std::sqrt(covariance_[j]) * stream.gaussian();
  return candidates;
}

void EvolutionStrategy::tell(const std::vector<std::vector<double>>& candidates,
                             std::span<const double> fitness) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto rank = [&](std::size_t i) { return std::isnan(fitness[i]) ? -HUGE_VAL : fitness[i]; };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rank(a) > rank(b); });

  // Strategy parameters of the paper's Table 1 and section 3.
  const auto n = static_cast<double>(mean_.size());
  const double c_sigma = (effective_ + 2.0) / (n + effective_ + 5.0);
  const double damping =
      1.0 + 2.0 * std::max(0.0, std::sqrt((effective_ - 1.0) / (n + 1.0)) - 1.0) + c_sigma;
  const double c_c = (4.0 + effective_ / n) / (n + 4.0 + 2.0 * effective_ / n);
  const double separable = (n + 2.0) / 3.0;  // fewer parameters learn faster
  const double c_1 = std::min(1.0, separable * 2.0 / ((n + 1.3) * (n + 1.3) + effective_));
  const double c_mu = std::min(1.0 - c_1, separable * 2.0 * (effective_ - 2.0 + 1.0 / effective_) /
                                              ((n + 2.0) * (n + 2.0) + effective_));
  const double expected_norm = std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));

  // y_w = (m' - m) / sigma, the step of the mean.
  std::vector<double> step(mean_.size(), 0.0);
  std::vector<double> spread(mean_.size(), 0.0);  // sum_i w_i y_i^2
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    for (std::size_t j = 0; j < mean_.size(); ++j) {
      const double y = (candidates[order[i]][j] - mean_[j]) / sigma_;
      step[j] += weights_[i] * y;
      spread[j] += weights_[i] * y * y;
    }
  }

  ++generation_;
  double square = 0.0;
  for (std::size_t j = 0; j < mean_.size(); ++j) {
    mean_[j] += sigma_ * step[j];
    step_path_[j] =
        (1.0 - c_sigma) * step_path_[j] +
        std::sqrt(c_sigma * (2.0 - c_sigma) * effective_) * step[j] / std::sqrt(covariance_[j]);
    square += step_path_[j] * step_path_[j];
  }
  const double norm = std::sqrt(square);
  const double settled =
      1.0 - math::exp(2.0 * generation_ * math::log(1.0 - c_sigma));  // 1 - (1-c)^2g
  const bool moving = norm / std::sqrt(settled) < (1.4 + 2.0 / (n + 1.0)) * expected_norm;
  for (std::size_t j = 0; j < mean_.size(); ++j) {
    path_[j] *= 1.0 - c_c;
    if (moving) path_[j] += std::sqrt(c_c * (2.0 - c_c) * effective_) * step[j];
    const double lost = moving ? 0.0 : c_c * (2.0 - c_c) * covariance_[j];
    covariance_[j] =
        (1.0 - c_1 - c_mu) * covariance_[j] + c_1 * (path_[j] * path_[j] + lost) + c_mu * spread[j];
  }
  sigma_ *= math::exp(c_sigma / damping * (norm / expected_norm - 1.0));
}

void EvolutionStrategy::serialize(const Archive& archive) {
  archive.row<double>("mean", mean_);
  archive.numbers<double>("sigma_generation", sigma_, generation_);
  archive.row<double>("covariance", covariance_);
  archive.row<double>("path", path_);
  archive.row<double>("step_path", step_path_);
}

}  // namespace evo
