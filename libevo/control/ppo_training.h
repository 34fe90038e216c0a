// Training a policy by proximal policy optimisation: environments, episodes and
// evaluations around the learner of ppo.h.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libevo/control/method.h"
#include "libevo/control/ppo.h"
#include "libevo/control/training_episodes.h"

namespace evo {

class PpoTraining {
 public:
  static constexpr const char* name = "ppo";
  static void check(const TrainingSettings& settings);

  explicit PpoTraining(const TrainingJob& job);

  bool done(const TrainingJob& job, const Findings& findings) const;
  void advance(const TrainingJob& job, Findings& findings, Metrics& metrics);  // one update
  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

 private:
  // Where an episode may begin: a state that a demonstration, or the inherited controller, came to.
  struct Moment {
    std::vector<std::uint8_t> state;  // VecEnv::save
    double return_so_far = 0.0;
  };
  void add_moments(const Arena& arena, const Demonstration& demonstration);

  // At a moment, or at the start.
  void start_episode(const TrainingJob& job, int environment);
  // One step of every environment; the returns of episodes that ended are added.
  void step(const TrainingJob& job, std::vector<double>& returns);
  std::span<const double> learned_rewards(double failure_weight);
  void observe();
  void require_finite() const;

  TrainingEpisodes episodes_;
  Ppo ppo_;
  std::vector<Moment> moments_;          // follow from the job: in no checkpoint
  std::vector<double> learned_rewards_;  // [E]
};

}  // namespace evo
