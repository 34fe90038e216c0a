// Gaussian-process regression over bodies (Rasmussen and Williams, "Gaussian
// Processes for Machine Learning", 2006, chapters 2 and 5; docs/methods.md, "Bayesian
// optimisation").
//
// A design is a list of voxels, one-hot coded. Two designs that differ in m
// voxels lie sqrt(2 m) apart, so the Matern 5/2 kernel of a design of D voxels
// takes only D + 1 values; they are tabulated, and the gradient of the
// likelihood needs one sum for each instead of a matrix for each parameter.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/body/body.h"

namespace evo {

using Design = std::vector<Voxel>;

// Kernel: variance * (1 + a + a^2/3) exp(-a), a = sqrt(5) sqrt(2 m) / length_scale.
struct GpParameters {
  double variance = 1.0;      // of the function; output units squared
  double length_scale = 1.0;  // one for all voxels, in one-hot units
  double noise = 0.01;        // variance of an observation around the function
};

// Limits within which likelihood is maximised. The noise's are the benchmark's.
inline constexpr GpParameters smallest_parameters{1e-4, 1e-2, 1e-9};
inline constexpr GpParameters largest_parameters{1e4, 1e3, 1e6};

// Added to the diagonal, as a share of the variance, so that the factorisation
// stands up to long length scales.
inline constexpr double gp_jitter = 1e-8;

// How many voxels differ. Both have the same length.
int mismatches(const Design& a, const Design& b);

// The value of the kernel for 0, 1, .., voxels mismatches.
std::vector<double> kernel_table(const GpParameters& parameters, std::size_t voxels);

struct LogLikelihood {
  double value = 0.0;
  // By the logarithms of variance, length scale and noise.
  std::array<double, 3> gradient{};
};

// Observations, and the likelihood of parameters given them.
class GpData {
 public:
  // Designs of one length, one output each, zero mean assumed. Throws Error(data)
  // for lengths that differ or no designs.
  GpData(std::vector<Design> designs, Eigen::VectorXd outputs);

  std::size_t size() const { return designs_.size(); }
  std::size_t voxels() const { return designs_.front().size(); }
  const std::vector<Design>& designs() const { return designs_; }
  const Eigen::VectorXd& outputs() const { return outputs_; }

  // Kernel matrix plus noise on the diagonal.
  Eigen::MatrixXd covariance(const GpParameters& parameters) const;
  LogLikelihood log_likelihood(const GpParameters& parameters) const;
  // `count` of them, evenly spread over the order.
  GpData thinned(std::size_t count) const;

 private:
  std::vector<Design> designs_;
  Eigen::VectorXd outputs_;
  Eigen::Matrix<std::uint16_t, Eigen::Dynamic, Eigen::Dynamic> mismatches_;
};

struct GpFitSettings {
  int restarts = 5;           // starting points; the first is the default parameters
  int max_iterations = 1000;  // evaluations of the likelihood from each of them
  // With more observations than this, starting points are compared on so many of
  // them, and the best continues with all.
  std::size_t screening = 300;
};

// The parameters of greatest likelihood (L-BFGS on their logarithms).
GpParameters fit(const GpData& data, const GpFitSettings& settings, Stream& stream);

// The process given the data.
class GaussianProcess {
 public:
  GaussianProcess(GpData data, const GpParameters& parameters);

  struct Posterior {
    Eigen::VectorXd mean;
    Eigen::VectorXd variance;  // of the function, without noise
  };
  Posterior predict(std::span<const Design> designs) const;

  const GpParameters& parameters() const { return parameters_; }
  const GpData& data() const { return data_; }

 private:
  GpData data_;
  GpParameters parameters_;
  std::vector<double> table_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd weights_;  // covariance^-1 outputs
};

}  // namespace evo
