// Training a policy by proximal policy optimisation: environments, episodes and
// evaluations around the learner of ppo.h. It trains one robot, or many that share a policy for any
// body: each has the settings' `environments` then, which rest while it is not their robot's
// turn, and what the policy is worth is the mean over robots.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libevo/control/method.h"
#include "libevo/control/modular_passes.h"
#include "libevo/control/policy_passes.h"
#include "libevo/control/ppo.h"
#include "libevo/task/env.h"

namespace evo {

template <typename Passes>
class PpoTraining {
 public:
  // Its policy is for any body.
  static constexpr bool for_any = std::is_same_v<Passes, ModularPasses>;
  static constexpr Algorithm algorithm = for_any ? Algorithm::modular : Algorithm::ppo;
  static constexpr Abilities can{
      .shares = for_any, .own_tasks = !for_any, .whole_updates = !for_any};
  static void check(const TrainingSettings& settings);

  explicit PpoTraining(const TrainingJob& job);

  bool done(const TrainingJob& job, const TrainResult& result) const;
  void advance(const TrainingJob& job, TrainResult& result, Metrics& metrics);  // one update
  void serialize(const Archive& archive);

 private:
  // Where an episode may begin: a state that the inherited controller came to.
  struct Moment {
    std::vector<std::uint8_t> state;  // VecEnv::save
    double return_so_far = 0.0;
  };
  void add_moments(const TrainingJob& job);

  // The next episode of an environment, at a moment or at the start. Episode k of environment e
  // has its random numbers, draws and jitter from (seed, "train", e, k).
  void start_episode(int environment);
  // One step of every environment whose turn it is; the returns of episodes that ended are added.
  void step(const TrainingJob& job, std::vector<double>& returns);
  const std::vector<int>& steps();  // [E] so far of their episodes; until the next call
  void observe() { ppo_.observe(Passes::seen(env_), steps()); }
  int first_length(int environment) const;

  TrainingSettings settings_;  // the job's, with the environments of all robots
  std::uint64_t seed_;
  VecEnv env_;
  std::vector<std::uint64_t> begun_;  // [E] episodes, with the present one
  std::vector<double> returns_;       // [E] so far
  std::vector<int> steps_;
  Ppo<Passes> ppo_;
  std::vector<Moment> moments_;           // follow from the job: in no checkpoint
  std::vector<double> rewards_;           // [E] as learned from
  std::vector<std::uint8_t> terminated_;  // [E]
  std::vector<std::uint8_t> truncated_;   // [E]
  std::vector<std::uint8_t> active_;      // [E] whose turn it is
};

// A bad end counts as much as the settings say, for the learner.
inline double learned_reward(double reward, bool terminated, const TrainingSettings& settings) {
  return terminated && reward < 0.0 ? reward * settings.failure_weight : reward;
}

// What the job inherits, a policy for one body or an open-loop controller, on its robot.
TrainedController inherited_controller(const TrainingJob& job);

}  // namespace evo
