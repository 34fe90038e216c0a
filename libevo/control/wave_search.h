// Open-loop control: the best of many sine waves, optimised by an evolution
// strategy or drawn at random.
#pragma once

#include <vector>

#include "libevo/base/random.h"
#include "libevo/control/evolution_strategy.h"
#include "libevo/control/method.h"

namespace evo {

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
  SineController blank() const;

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
  SineController blank() const;

 private:
  SineController draw(const TrainingSettings& settings);

  std::size_t actuators_;
  Stream random_;
};

}  // namespace evo
