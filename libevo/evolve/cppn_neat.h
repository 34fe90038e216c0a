// Robots evolved through their genomes: NEAT over the bodies that CPPNs paint
// (docs/methods.md, "Loop"). A genome passes if its body is a valid robot that
// has not been seen in the whole run.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "libevo/body/body.h"
#include "libevo/evolve/method.h"
#include "libevo/evolve/neat_steady.h"

namespace evo {

struct CppnRobot {
  Genome genome;
  Body body;                 // decode(genome, rows, cols)
  std::vector<int> parents;  // genome keys; none if brand new
};

// `settings.pop_size` random robots as generation 0; any settings, among them
// 3 inputs and 5 outputs. `seen` are the ids to avoid; those of the new robots
// are added. Throws like first_generation, Error(usage) for other numbers of
// inputs and outputs.
std::vector<CppnRobot> first_robots(const NeatSettings& settings, int rows, int cols,
                                    std::set<std::string>& seen, NeatState& state,
                                    std::uint64_t seed);

// The next generation; throws like next_generation.
std::vector<CppnRobot> next_robots(const NeatSettings& settings, int rows, int cols,
                                   std::span<const Scored> scored, std::set<std::string>& seen,
                                   NeatState& state, std::uint64_t seed);

// The method one robot at a time: the genome keys are the robots' numbers.
class CppnNeat {
 public:
  static constexpr const char* name = "neat";
  static constexpr bool told_again = false;
  static constexpr bool any_founders = false;
  // Throws Error(usage) for other numbers of inputs and outputs.
  explicit CppnNeat(const EvolutionSettings& settings);

  // Throws like next_individual.
  Proposal propose(int number, std::span<const Body> pending, std::set<std::string>& seen);
  // Throws Error(data) for a robot without a genome.
  void tell(const ScoredRobot& robot);
  MethodState save() const;
  void load(MethodState state);

 private:
  EvolutionSettings settings_;
  std::vector<ScoredRobot> members_;  // the population, oldest first
  NeatState species_;
  int told_ = 0;
};

}  // namespace evo
