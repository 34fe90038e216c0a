// Training a sequence of actions (sequence_search.h): first a share of the steps for a
// gait (gait_training.h), then from this stretches of exploration, each followed by the
// episodes of what they found. What a robot inherits, it begins with instead: a sequence
// or a gait as it is, of a network what it does in an episode on the new body.
#pragma once

#include <memory>
#include <optional>

#include "libevo/control/gait_training.h"
#include "libevo/control/method.h"
#include "libevo/control/sequence_search.h"

namespace evo {

class SequenceTraining {
 public:
  static constexpr const char* name = "sequence";
  static void check(const TrainingSettings&) {}

  // Throws Error(usage) where the budget is too small to explore anything.
  explicit SequenceTraining(const TrainingJob& job);

  // Too little is left of the budget for a stretch and its episodes.
  bool done(const TrainingJob& job, const Findings& findings) const;
  // A generation of the search for a gait, or a stretch of exploration: as many steps
  // as lie between two evaluations.
  void advance(const TrainingJob& job, Findings& findings, Metrics& metrics);
  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

 private:
  std::int64_t first_cost(const TrainingJob& job) const;
  void explore_from(std::optional<SequenceSearch::Start> start);

  std::unique_ptr<TrainingJob> gait_job_;  // the job, but for the gait's share of the steps
  std::optional<GaitTraining> gait_;       // until it is found
  std::optional<SequenceSearch> search_;
};

}  // namespace evo
