// Training one modular policy for one robot or for many: environments, episodes and
// evaluations around the learner of modular_ppo.h. Every robot has the settings'
// `environments`, which rest while it is not their robot's turn; what the policy is worth is the
// mean over robots.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libevo/control/method.h"
#include "libevo/control/modular_ppo.h"
#include "libevo/control/training_episodes.h"

namespace evo {

class ModularTraining {
 public:
  static constexpr const char* name = "modular";
  static void check(const TrainingSettings& settings);

  explicit ModularTraining(const TrainingJob& job);

  bool done(const TrainingJob& job, const Findings& findings) const;
  void advance(const TrainingJob& job, Findings& findings, Metrics& metrics);  // one update
  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

 private:
  void start_episode(int environment);
  // One step of every environment whose turn it is; the returns of episodes that ended are added.
  void step(const TrainingJob& job, std::vector<double>& returns);
  // First episodes are cut short, each after another share of the time, so that a rollout sees
  // all parts of an episode and not the same one of all robots.
  int first_length(int environment) const;  // in steps
  void require_finite() const;

  TrainingSettings settings_;  // the job's, with the environments of all robots
  std::vector<Group> groups_;  // where the learner finds them
  TrainingEpisodes episodes_;
  ModularPpo ppo_;
  std::vector<double> rewards_;           // [E] as learned from
  std::vector<std::uint8_t> terminated_;  // [E]
  std::vector<std::uint8_t> truncated_;   // [E]
  std::vector<std::uint8_t> active_;      // [E] whose turn it is
};

// An untrained policy of the job's task.
ModularPolicy initial_modular_policy(const TrainingJob& job);

}  // namespace evo
