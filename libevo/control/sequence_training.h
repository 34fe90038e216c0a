// Training a sequence of actions (sequence_search.h): stretches of exploration, each
// followed by the episodes of what they found. What a robot inherits, it begins with: a
// sequence or a gait as it is, of a network what it does in an episode on the new body.
#pragma once

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
  // One stretch: as many steps as lie between two evaluations.
  void advance(const TrainingJob& job, Findings& findings, Metrics& metrics);
  void save(Checkpoint& checkpoint) const { search_.save(checkpoint); }
  void load(const Checkpoint& checkpoint) { search_.load(checkpoint); }

 private:
  SequenceSearch search_;
};

}  // namespace evo
