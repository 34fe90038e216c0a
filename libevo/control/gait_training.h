// Training a gait: open-loop waves, first over the whole body, then of every
// actuator for itself (gait_search.h); from an inherited gait, the latter only.
#pragma once

#include <cstdint>

#include "libevo/control/gait_search.h"
#include "libevo/control/method.h"

namespace evo {

// Environment steps of a generation at most: episodes can end early.
std::int64_t generation_cost(const TrainingJob& job);

class GaitTraining {
 public:
  static constexpr const char* name = "gait";
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
  void save(Checkpoint& checkpoint) const { search_.save(checkpoint); }
  void load(const Checkpoint& checkpoint) { search_.load(checkpoint); }

 private:
  GaitSearch search_;
};

}  // namespace evo
