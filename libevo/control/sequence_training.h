// Training a sequence of actions (sequence_search.h) beside a gait (gait_training.h). A share
// of the steps goes to the gait first. From what it finds, stretches of exploration continue,
// each followed by the episodes of what they found; and from then on the two searches take
// turns. The one is next that would be ahead a while later, had it all steps until then:
// where a rhythm is all it takes, the gait; at a stair, exploration. Now and then it is the
// other, since searches that rest may wake up. A better gait enters the archive.
//
// What a robot inherits, it begins with instead: a sequence or a gait as it is, of a network
// what it does in an episode on the new body.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "libevo/control/gait_training.h"
#include "libevo/control/method.h"
#include "libevo/control/sequence_search.h"

namespace evo {

class SequenceTraining {
 public:
  static constexpr Algorithm algorithm = Algorithm::sequence;
  static constexpr Abilities can{};
  static void check(const TrainingSettings&) {}

  // Throws Error(usage) where the budget is too small to explore anything.
  explicit SequenceTraining(const TrainingJob& job);

  // Too little is left of the budget for a stretch and its episodes.
  bool done(const TrainingJob& job, const TrainResult& result) const;
  // A generation of the search for a gait, or a stretch of exploration: as many steps
  // as lie between two evaluations.
  void advance(const TrainingJob& job, TrainResult& result, Metrics& metrics);
  void serialize(const Archive& archive);

 private:
  // How fast a search gains, lately.
  struct Pace {
    double per_step = 0.0;   // return
    std::int64_t turns = 0;  // taken with the other search
    void turn(double gained, std::int64_t steps);
  };

  std::int64_t first_cost(const TrainingJob& job) const;
  void explore_from(std::optional<OpenLoop> start);
  bool gait_is_next(const TrainingJob& job, const TrainResult& result) const;
  void search_gait(const TrainingJob& job, TrainResult& result, Metrics& metrics);
  void explore(const TrainingJob& job, TrainResult& result, Metrics& metrics);

  std::unique_ptr<TrainingJob> gait_job_;  // the job, but for the gait's first share of the steps
  std::optional<GaitTraining> gait_;       // none where it was not looked for
  std::optional<SequenceSearch> search_;   // once there is something to start from

  std::optional<GaitTraining::Generation> best_gait_;
  Pace gait_pace_;
  Pace exploration_pace_;
};

}  // namespace evo
