// Every number that decides a training, with the defaults of the profile
// `paper` (docs/methods.md, "PPO in the paper"). Profiles are the YAML files of
// tasks/training/, read by formats/training/training.h.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libevo/base/words.h"
#include "libevo/control/policy.h"

namespace evo {

// What trains, by its name in methods.h:
//   ppo     a policy network, by proximal policy optimisation
//   sine    open-loop sine waves, by an evolution strategy
//   random  the best of random open-loop sine waves
//   gait    as sine, but from the best of the waves that travel over the body
//   sequence  open loop, every actuator's target at every step: exploration from the best
//           moments reached so far
class Algorithm {
 public:
  Algorithm() : Algorithm("ppo") {}
  // Throws Error(usage) for a name that there is no method of.
  explicit Algorithm(std::string_view name);

  const std::string& name() const { return name_; }
  bool operator==(const Algorithm&) const = default;

 private:
  std::string name_;
};
std::vector<std::string> algorithm_names();

enum class Schedule { constant, linear };           // linear: falls to 0 over the horizon
enum class TimeLimit { end, bootstrap };            // what an episode cut off by time counts as
enum class Standardize { none, batch, minibatch };  // over what advantages get mean 0, deviation 1

// As profiles write them (libevo/base/words.h).
constexpr const char* word(Schedule value) {
  switch (value) {
    case Schedule::constant:
      return "constant";
    case Schedule::linear:
      return "linear";
  }
  return nullptr;
}
constexpr const char* word(TimeLimit value) {
  switch (value) {
    case TimeLimit::end:
      return "end";
    case TimeLimit::bootstrap:
      return "bootstrap";
  }
  return nullptr;
}
constexpr const char* word(Standardize value) {
  switch (value) {
    case Standardize::none:
      return "none";
    case Standardize::batch:
      return "batch";
    case Standardize::minibatch:
      return "minibatch";
  }
  return nullptr;
}

// What the search for a sequence tries from a moment on (sequence_search.h).
enum class AttemptKind {
  go_on,   // with what was going on
  begin,   // a new gait
  change,  // the gait, or that of a moment that was earning much, changed
  borrow,  // the gait of a moment that was earning much
  repeat,  // the last actions, again and again
  push,    // a few targets held by groups of actuators, then the gait
  hold     // one target for each group
};
constexpr const char* word(AttemptKind value) {
  switch (value) {
    case AttemptKind::go_on:
      return "go_on";
    case AttemptKind::begin:
      return "begin";
    case AttemptKind::change:
      return "change";
    case AttemptKind::borrow:
      return "borrow";
    case AttemptKind::repeat:
      return "repeat";
    case AttemptKind::push:
      return "push";
    case AttemptKind::hold:
      return "hold";
  }
  return nullptr;
}

struct TrainingSettings {
  Algorithm algorithm;
  std::int64_t steps = 512000;  // environment steps in all; a budget, never exceeded

  // Rollout
  int environments = 4;
  int rollout = 128;  // steps of each environment between updates

  // Update
  int epochs = 4;
  int minibatches = 4;  // per epoch, freshly shuffled; a remainder is dropped
  double gamma = 0.99;
  double lambda = 0.95;  // of generalised advantage estimation
  double clip = 0.1;     // epsilon of the clipped objective
  bool clip_value_loss = true;
  double value_coefficient = 0.5;  // times half the squared error
  double entropy_coefficient = 0.01;
  Schedule entropy_schedule = Schedule::constant;
  double max_gradient_norm = 0.5;  // of all parameters together; 0: no limit
  Standardize standardize_advantages = Standardize::batch;
  TimeLimit time_limit = TimeLimit::end;

  // Adam
  double learning_rate = 2.5e-4;
  Schedule learning_rate_schedule = Schedule::linear;
  std::int64_t learning_rate_horizon = 19531;  // updates until it is 0; 0: those of the training
  double adam_epsilon = 1e-5;

  // Networks and distribution
  std::vector<int> hidden{64, 64};
  double head_gain = 1.0;        // orthogonal gain of the layer of action means
  double initial_log_std = 0.0;  // log of the standard deviation of actions
  ActionMap action_map = ActionMap::offset;
  double action_offset = 1.0;  // target = clip(offset + action)
  std::vector<int> clock;      // periods, control steps, whose phases networks see

  // Exploration
  double noise_correlation = 0.0;   // of one step's noise with the next
  double failure_weight = 1.0;      // of what an episode's end costs, as the learner sees it
  double gait_log_std = -1.2;       // initial_log_std where actions are added to a gait
  double inherited_log_std = -1.0;  // and of a policy that goes on from another robot's

  // Where training episodes begin
  double start_jitter = 0.0;    // of the task's start coordinates, voxels
  double moment_share = 0.0;    // of episodes: at a moment of the inherited controller's episode
  double moment_jitter = 0.01;  // of the coordinates there, voxels

  // Normalisation
  bool normalize_observations = true;
  bool normalize_rewards = true;  // by the deviation of discounted returns
  double observation_clip = 10.0;
  double reward_clip = 10.0;

  // Evaluation
  int evaluation_interval = 50;  // updates between evaluations; one more after the last
  int evaluation_episodes = 1;
  double evaluation_jitter = 0.0;  // of their start coordinates, voxels
  int final_episodes = 8;          // of the best policy, after training
  double final_jitter = 1e-4;      // of their start coordinates, voxels

  // Open-loop search: `environments` and the like do not apply
  int population = 16;         // candidates of a generation
  double initial_sigma = 0.5;  // of the evolution strategy, in its scaled coordinates
  double shortest_period = 8;  // control steps, of random candidates
  double longest_period = 100;
  double wave_share = 0.33;      // of the generations: waves over the whole body (gait)
  double actuator_sigma = 0.15;  // step size once each actuator is for itself (gait)

  // Exploration for sequences
  double gait_share = 0.2;  // of the steps: the search for a gait at first
  std::vector<AttemptKind> attempts = values_of<AttemptKind>();  // drawn alike, as often as named
  double time_share = 0.5;   // of attempts: from the best moment of a time, not of a level
  double rest_share = 0.03;  // of attempts: what came too early once more, after a rest

  bool operator==(const TrainingSettings&) const = default;

  std::int64_t batch() const { return std::int64_t{environments} * rollout; }
  std::int64_t updates() const { return steps / batch(); }
};

// Throws Error(usage) naming the key and the value where a setting makes no
// sense, alone or with the others.
void check(const TrainingSettings& settings);

}  // namespace evo
