// The genetic algorithm: children of the best so far, a number that shrinks as evaluations
// are used up (docs/methods.md, "Genetic algorithm").
#pragma once

#include "libevo/evolve/method.h"

namespace evo {

class GeneticAlgorithm {
 public:
  static constexpr const char* name = "ga";
  static constexpr bool told_again = false;
  static constexpr bool any_founders = true;
  explicit GeneticAlgorithm(const EvolutionSettings& settings) : settings_(settings) {}

  Proposal propose(int number, std::span<const Body> pending, std::set<std::string>& seen);
  void tell(const ScoredRobot& robot);
  MethodState save() const;
  void load(MethodState state);

 private:
  EvolutionSettings settings_;
  std::vector<ScoredRobot> best_;  // of those told, best first, a population at most
  int told_ = 0;
};

}  // namespace evo
