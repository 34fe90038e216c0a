// Open-loop control: the best of many sine waves, optimised by an evolution
// strategy or drawn at random.
#pragma once

#include <cstdint>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/control/evolution_strategy.h"
#include "libevo/control/method.h"

namespace evo {

// Of a generation, at most, in environment steps: episodes can end early.
std::int64_t generation_cost(const TrainingJob& job);
// Throws Error(usage) where the budget is less than one generation.
void require_a_generation(const TrainingJob& job);
// Another generation might exceed the budget.
bool spent(const TrainingJob& job, const Findings& findings);
// The mean return of each candidate; the best of them is an evaluation.
std::vector<double> try_out(const TrainingJob& job, const std::vector<SineController>& candidates,
                            Findings& findings, Metrics& metrics);

class SineTraining {
 public:
  static constexpr const char* name = "sine";
  static void check(const TrainingSettings&) {}

  // Throws Error(usage) where the budget is less than one generation.
  explicit SineTraining(const TrainingJob& job);

  // Another generation might exceed the budget.
  bool done(const TrainingJob& job, const Findings& findings) const;
  // One generation.
  void advance(const TrainingJob& job, Findings& findings, Metrics& metrics);
  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

 private:
  SineController decode(const std::vector<double>& x, const TrainingSettings& settings) const;

  std::size_t actuators_;
  Stream random_;
  EvolutionStrategy strategy_;
};

class RandomTraining {
 public:
  static constexpr const char* name = "random";
  static void check(const TrainingSettings&) {}

  // Throws Error(usage) where the budget is less than one generation.
  explicit RandomTraining(const TrainingJob& job);

  bool done(const TrainingJob& job, const Findings& findings) const;
  // settings.population draws.
  void advance(const TrainingJob& job, Findings& findings, Metrics& metrics);
  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

 private:
  SineController draw(const TrainingSettings& settings);

  std::size_t actuators_;
  Stream random_;
};

}  // namespace evo
