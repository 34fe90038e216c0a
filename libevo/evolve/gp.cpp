#include "libevo/evolve/gp.h"

#include <nlopt.h>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <utility>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

using Index = Eigen::Index;

double scaled_distance(std::size_t mismatches, double length_scale) {
  return math::sqrt(10.0 * static_cast<double>(mismatches)) / length_scale;  // sqrt(5) sqrt(2 m)
}

// d kernel / d log(length scale) for 0, 1, .., voxels mismatches.
std::vector<double> length_scale_table(const GpParameters& p, std::size_t voxels) {
  std::vector<double> table(voxels + 1);
  for (std::size_t m = 0; m <= voxels; ++m) {
    const double a = scaled_distance(m, p.length_scale);
    table[m] = p.variance * (a * a * (1.0 + a) / 3.0) * math::exp(-a);
  }
  return table;
}

// ---- search for the parameters, in logarithms -------------------------------------

using LogParameters = std::array<double, 3>;  // variance, length scale, noise

LogParameters to_log(const GpParameters& p) {
  return {math::log(p.variance), math::log(p.length_scale), math::log(p.noise)};
}
GpParameters from_log(const LogParameters& x) {
  return {math::exp(x[0]), math::exp(x[1]), math::exp(x[2])};
}

using Optimizer = std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)>;

struct Point {
  LogParameters parameters;
  double likelihood = -std::numeric_limits<double>::infinity();
};

struct Climb {
  const GpData& data;
  nlopt_opt optimizer;
  Point best;
  std::exception_ptr failure;  // kept while NLopt's C code is on the stack
};

double objective(unsigned, const double* x, double* gradient, void* context) {
  auto& climb = *static_cast<Climb*>(context);
  try {
    const LogParameters at{x[0], x[1], x[2]};
    const LogLikelihood likelihood = climb.data.log_likelihood(from_log(at));
    if (gradient != nullptr)
      std::copy(likelihood.gradient.begin(), likelihood.gradient.end(), gradient);
    if (likelihood.value > climb.best.likelihood) climb.best = {at, likelihood.value};
    return likelihood.value;
  } catch (...) {
    climb.failure = std::current_exception();
    nlopt_force_stop(climb.optimizer);
    return 0.0;
  }
}

// The best point met on the way up from `start`. NLopt may give up early, where
// rounding hides the slope; what was found counts all the same.
Point climb(const GpData& data, LogParameters start, int max_iterations) {
  const Optimizer optimizer(nlopt_create(NLOPT_LD_LBFGS, 3), nlopt_destroy);
  if (!optimizer) throw std::bad_alloc();
  Climb climb{data, optimizer.get(), {start}, nullptr};
  nlopt_set_lower_bounds(optimizer.get(), to_log(smallest_parameters).data());
  nlopt_set_upper_bounds(optimizer.get(), to_log(largest_parameters).data());
  nlopt_set_max_objective(optimizer.get(), objective, &climb);
  nlopt_set_maxeval(optimizer.get(), max_iterations);
  nlopt_set_ftol_rel(optimizer.get(), 1e-8);
  nlopt_set_xtol_rel(optimizer.get(), 1e-5);
  double value = 0.0;
  nlopt_optimize(optimizer.get(), start.data(), &value);
  if (climb.failure) std::rethrow_exception(climb.failure);
  return climb.best;
}

LogParameters starting_point(int restart, Stream& stream) {
  LogParameters x = to_log(GpParameters{});
  if (restart == 0) return x;
  const LogParameters low = to_log(smallest_parameters);
  const LogParameters high = to_log(largest_parameters);
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] = std::clamp(x[k] + stream.gaussian(), low[k], high[k]);
  return x;
}

}  // namespace

int mismatches(const Design& a, const Design& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i] ? 1 : 0;
  return count;
}

std::vector<double> kernel_table(const GpParameters& p, std::size_t voxels) {
  std::vector<double> table(voxels + 1);
  for (std::size_t m = 0; m <= voxels; ++m) {
    const double a = scaled_distance(m, p.length_scale);
    table[m] = p.variance * (1.0 + a + a * a / 3.0) * math::exp(-a);
  }
  return table;
}

// ---- GpData -----------------------------------------------------------------------

GpData::GpData(std::vector<Design> designs, Eigen::VectorXd outputs)
    : designs_(std::move(designs)), outputs_(std::move(outputs)) {
  if (designs_.empty()) throw Error(Failure::data, "no observations to learn from");
  for (const Design& design : designs_)
    if (design.size() != voxels())
      throw error(Failure::data, "designs of {} and of {} voxels cannot be compared", voxels(),
                  design.size());
  const auto n = static_cast<Index>(size());
  mismatches_.resize(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = j; i < n; ++i)
      mismatches_(i, j) = mismatches_(j, i) = static_cast<std::uint16_t>(
          mismatches(designs_[static_cast<std::size_t>(i)], designs_[static_cast<std::size_t>(j)]));
}

Eigen::MatrixXd GpData::covariance(const GpParameters& p) const {
  const std::vector<double> table = kernel_table(p, voxels());
  Eigen::MatrixXd covariance =
      mismatches_.unaryExpr([&](std::uint16_t m) { return table[m]; }).cast<double>();
  covariance.diagonal().array() += p.noise + gp_jitter * p.variance;
  return covariance;
}

LogLikelihood GpData::log_likelihood(const GpParameters& p) const {
  const auto n = static_cast<Index>(size());
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance(p));
  if (factor.info() != Eigen::Success)
    return {-std::numeric_limits<double>::max(), {0.0, 0.0, 0.0}};
  const Eigen::VectorXd weights = factor.solve(outputs_);
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n));

  constexpr double log_two_pi = 1.8378770664093453;
  double half_log_determinant = 0.0;
  for (Index i = 0; i < n; ++i) half_log_determinant += math::log(factor.matrixLLT()(i, i));
  LogLikelihood result;
  result.value = -0.5 * outputs_.dot(weights) - half_log_determinant -
                 0.5 * static_cast<double>(n) * log_two_pi;

  // d value / d parameter = 1/2 sum_ij (w_i w_j - inverse_ij) d covariance_ij / d parameter.
  std::vector<double> pull(voxels() + 1, 0.0);  // the first factor, summed by mismatches
  double diagonal = 0.0;
  for (Index j = 0; j < n; ++j) {
    diagonal += weights(j) * weights(j) - inverse(j, j);
    for (Index i = j + 1; i < n; ++i)
      pull[mismatches_(i, j)] += 2.0 * (weights(i) * weights(j) - inverse(i, j));
  }
  pull[0] += diagonal;
  const std::vector<double> by_variance = kernel_table(p, voxels());
  const std::vector<double> by_length_scale = length_scale_table(p, voxels());
  for (std::size_t m = 0; m <= voxels(); ++m) {
    result.gradient[0] += 0.5 * pull[m] * by_variance[m];
    result.gradient[1] += 0.5 * pull[m] * by_length_scale[m];
  }
  result.gradient[0] += 0.5 * diagonal * gp_jitter * p.variance;
  result.gradient[2] = 0.5 * diagonal * p.noise;
  return result;
}

GpData GpData::thinned(std::size_t count) const {
  count = std::min(count, size());
  std::vector<Design> designs;
  Eigen::VectorXd outputs(static_cast<Index>(count));
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = k * size() / count;
    designs.push_back(designs_[i]);
    outputs(static_cast<Index>(k)) = outputs_(static_cast<Index>(i));
  }
  return {std::move(designs), std::move(outputs)};
}

// ---- fit --------------------------------------------------------------------------

GpParameters fit(const GpData& data, const GpFitSettings& settings, Stream& stream) {
  const bool screened = data.size() > settings.screening;
  const GpData few = screened ? data.thinned(settings.screening) : data;
  Point best{to_log(GpParameters{})};
  for (int restart = 0; restart < settings.restarts; ++restart) {
    const Point found = climb(few, starting_point(restart, stream), settings.max_iterations);
    if (found.likelihood > best.likelihood) best = found;
  }
  if (screened) best = climb(data, best.parameters, settings.max_iterations);
  return from_log(best.parameters);
}

// ---- GaussianProcess --------------------------------------------------------------

GaussianProcess::GaussianProcess(GpData data, const GpParameters& parameters)
    : data_(std::move(data)),
      parameters_(parameters),
      table_(kernel_table(parameters, data_.voxels())),
      factor_(data_.covariance(parameters)) {
  if (factor_.info() != Eigen::Success)
    throw error(Failure::work,
                "the covariance of {} observations cannot be factored (variance {}, length scale "
                "{}, noise {})",
                data_.size(), parameters.variance, parameters.length_scale, parameters.noise);
  weights_ = factor_.solve(data_.outputs());
}

GaussianProcess::Posterior GaussianProcess::predict(std::span<const Design> designs) const {
  constexpr std::size_t block = 256;  // designs solved for at a time; bounds the memory
  const auto n = static_cast<Index>(data_.size());
  const auto total = static_cast<Index>(designs.size());
  Posterior posterior{Eigen::VectorXd(total), Eigen::VectorXd(total)};
  Eigen::MatrixXd cross;
  for (std::size_t first = 0; first < designs.size(); first += block) {
    const auto count = static_cast<Index>(std::min(block, designs.size() - first));
    const auto at = static_cast<Index>(first);
    cross.resize(n, count);
    for (Index c = 0; c < count; ++c)
      for (Index i = 0; i < n; ++i)
        cross(i, c) = table_[static_cast<std::size_t>(
            mismatches(data_.designs()[static_cast<std::size_t>(i)],
                       designs[first + static_cast<std::size_t>(c)]))];
    posterior.mean.segment(at, count).noalias() = cross.transpose() * weights_;
    factor_.matrixL().solveInPlace(cross);
    posterior.variance.segment(at, count) =
        (parameters_.variance - cross.colwise().squaredNorm().array()).max(0.0).transpose();
  }
  return posterior;
}

}  // namespace evo
