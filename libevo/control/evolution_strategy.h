// A maximiser of functions of many numbers: CMA-ES with a diagonal covariance
// (Ros and Hansen, "A Simple Modification in CMA-ES Achieving Linear Time and
// Space Complexity", PPSN 2008), in the notation of that paper.
#pragma once

#include <span>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/control/checkpoint.h"

namespace evo {

class EvolutionStrategy {
 public:
  // Starts at `mean` [n] with a step size common to all coordinates.
  EvolutionStrategy(std::vector<double> mean, double sigma, int population);

  // The candidates of the next generation, lambda vectors of n.
  std::vector<std::vector<double>> ask(Stream& stream) const;
  // How well they did, higher is better; NaN ranks last.
  void tell(const std::vector<std::vector<double>>& candidates, std::span<const double> fitness);

  const std::vector<double>& mean() const { return mean_; }
  double sigma() const { return sigma_; }

  void serialize(const Archive& archive);

 private:
  std::vector<double> mean_;        // m
  double sigma_;                    // step size
  std::size_t population_;          // lambda
  std::vector<double> covariance_;  // diagonal of C
  std::vector<double> path_;        // p_c
  std::vector<double> step_path_;   // p_sigma
  double generation_ = 0.0;
  std::vector<double> weights_;  // w_1 >= .. >= w_mu, sum 1
  double effective_;             // mu_eff
};

}  // namespace evo
