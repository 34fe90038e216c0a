// The settings of a training. Profiles are the YAML files of tasks/training/, read by
// formats/training/training.h.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libevo/base/words.h"
#include "libevo/control/policy.h"

namespace evo {

// What trains (methods.h):
//   ppo     a policy network, by proximal policy optimisation
//   gait    open-loop waves, by an evolution strategy
//   modular a network that every voxel shares, for one robot or for many, by proximal policy
//           optimisation
//   sequence  open loop, every actuator's target at every step: exploration from the best
//           moments reached so far
enum class Algorithm { ppo, gait, sequence, modular };
// As profiles write it (libevo/base/words.h).
constexpr auto words_for(Algorithm) { return std::array{"ppo", "gait", "sequence", "modular"}; }

enum class TimeLimit { end, bootstrap };  // what an episode cut off by time counts as
constexpr auto words_for(TimeLimit) { return std::array{"end", "bootstrap"}; }

// Every number that decides a training, as in the profile `paper` (docs/methods.md, "PPO in
// the paper"). What each means and may be stands in the table of formats/training/training.cpp,
// whatever else is read, written or said of them comes from there.
struct TrainingSettings {
  Algorithm algorithm = Algorithm::ppo;
  std::int64_t steps = 512000;
  // Rollout
  int environments = 4;
  int rollout = 128;
  // Update
  int epochs = 4;
  int minibatches = 4;
  double gamma = 0.99;
  double lambda = 0.95;
  double clip = 0.1;
  bool clip_value_loss = true;
  double value_coefficient = 0.5;
  double entropy_coefficient = 0.01;
  double max_gradient_norm = 0.5;
  TimeLimit time_limit = TimeLimit::end;
  double learning_rate = 2.5e-4;
  std::int64_t learning_rate_horizon = 19531;
  // Networks and distribution
  std::vector<int> hidden{64, 64};
  double head_gain = 1.0;
  double initial_log_std = 0.0;
  ActionMap action_map = ActionMap::offset;
  double action_offset = 1.0;
  std::vector<int> clock;
  int robots_per_update = 0;
  // What is learned from
  double failure_weight = 1.0;
  bool keep_sequence = false;
  double gait_log_std = -1.2;
  double inherited_log_std = -1.0;
  double start_jitter = 0.0;
  double moment_share = 0.0;
  double moment_jitter = 0.01;
  // Evaluation
  int evaluation_interval = 50;
  int evaluation_episodes = 1;
  double evaluation_jitter = 0.0;
  int final_episodes = 8;
  double final_jitter = 1e-4;
  // Open-loop search
  int population = 16;
  double shortest_period = 8;
  double longest_period = 100;
  double wave_share = 0.33;
  double gait_share = 0.2;

  bool operator==(const TrainingSettings&) const = default;

  std::int64_t batch() const { return std::int64_t{environments} * rollout; }
  std::int64_t updates() const { return steps / batch(); }
};

// Throws Error(usage) where settings, each within its range, make no sense together.
void check(const TrainingSettings& settings);

}  // namespace evo
