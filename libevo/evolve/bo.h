// Bayesian optimisation, a design at a time: what the Gaussian process expects most of,
// given the scores and, as if they had the expected ones, the robots that are pending. Its
// parameters are fitted anew once a population (libevo/evolve/suggest.h).
#pragma once

#include "libevo/evolve/method.h"
#include "libevo/evolve/suggest.h"

namespace evo {

class BayesianOptimisation {
 public:
  static constexpr const char* name = "bo";
  static constexpr bool told_again = true;
  static constexpr bool any_founders = false;
  explicit BayesianOptimisation(const EvolutionSettings& settings) : settings_(settings) {}

  Proposal propose(int number, std::span<const Body> pending, std::set<std::string>& seen);
  void tell(const ScoredRobot& robot);
  MethodState save() const;
  void load(MethodState state);

 private:
  std::optional<GpParameters> parameters();

  EvolutionSettings settings_;
  std::vector<Observation> observations_;
  std::optional<GpParameters> parameters_;  // fitted to the first `fitted_` observations
  int fitted_ = 0;
};

}  // namespace evo
