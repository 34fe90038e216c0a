// Search for an open-loop gait in two stages: first waves that travel over the
// body, a few numbers whatever its size (wave vector, period, and amplitude,
// middle and phase for each of the two kinds of actuators); then, from the best
// of those, every actuator for itself. Both by separable CMA-ES. A search that starts
// from a gait, as a child from its parent's, has the second stage only.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/body/body.h"
#include "libevo/control/checkpoint.h"
#include "libevo/control/evolution_strategy.h"
#include "libevo/control/sine.h"

namespace evo {

struct GaitSearchSettings {
  int population = 16;
  std::int64_t wave_generations = 1;  // of the first stage
  double shortest_period = 8;         // control steps
  double longest_period = 100;
};

class GaitSearch {
 public:
  GaitSearch(const Body& robot, const GaitSearchSettings& settings, Stream random);
  // From `start`, which is the first candidate of the first generation.
  GaitSearch(const Body& robot, const GaitSearchSettings& settings, Stream random,
             SineController start);

  // The candidates of the next generation.
  std::vector<SineController> ask();
  // What they earned.
  void tell(std::span<const double> returns);
  double sigma() const { return strategy_.sigma(); }

  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

 private:
  struct Actuator {
    double x = 0.0;  // cell, from the body's middle
    double y = 0.0;
    bool vertical = false;
  };
  SineController decode_wave(const std::vector<double>& x) const;
  SineController decode(const std::vector<double>& x) const;
  double period(double x) const;
  void begin_second_stage(const SineController& from);

  GaitSearchSettings settings_;
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
