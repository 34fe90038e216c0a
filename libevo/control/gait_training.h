// Training an open-loop gait in two stages: first waves that travel over the body, a few numbers
// whatever its size (wave vector, period, and amplitude, middle and phase for each of the two
// kinds of actuators); then, from the best of those, every actuator for itself. Both by separable
// CMA-ES. A training that inherits a gait, as a child its parent's, has the second stage only, and
// that gait is the first candidate of its first generation.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/control/evolution_strategy.h"
#include "libevo/control/method.h"
#include "libevo/control/open_loop.h"

namespace evo {

// Environment steps of a generation at most: episodes can end early.
std::int64_t generation_cost(const TrainingJob& job);

class GaitTraining {
 public:
  static constexpr Algorithm algorithm = Algorithm::gait;
  static constexpr Abilities can{};
  static void check(const TrainingSettings&) {}

  // Throws Error(usage) where the budget is less than one generation.
  explicit GaitTraining(const TrainingJob& job);

  // Another generation might exceed the budget.
  bool done(const TrainingJob& job, const TrainResult& result) const;
  struct Generation {
    double best = 0.0;
    SineController gait;  // that earned it
  };
  Generation advance(const TrainingJob& job, TrainResult& result, Metrics& metrics);
  void serialize(const Archive& archive);

 private:
  struct Actuator {
    double x = 0.0;  // cell, from the body's middle
    double y = 0.0;
    bool vertical = false;
  };
  // The candidates of the next generation, and what they earned.
  std::vector<SineController> ask();
  void tell(std::span<const double> returns);
  SineController decode_wave(const std::vector<double>& x) const;
  SineController decode(const std::vector<double>& x) const;
  double period(double x) const;
  void begin_second_stage(const SineController& from);

  TrainingSettings settings_;
  std::int64_t wave_generations_;  // of the first stage
  std::vector<Actuator> actuators_;
  Stream random_;
  std::int64_t generation_ = 0;  // generations told of
  bool second_stage_ = false;
  EvolutionStrategy strategy_;
  std::vector<std::vector<double>> points_;  // asked for
  std::vector<double> best_;                 // wave of the first stage
  double best_return_ = 0.0;
  std::optional<SineController> start_;
};

}  // namespace evo
