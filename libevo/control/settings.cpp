#include "libevo/control/settings.h"

#include <algorithm>

#include "libevo/base/error.h"
#include "libevo/control/methods.h"

namespace evo {
namespace {

void require(bool holds, const char* key, double value, const char* allowed) {
  if (!holds) throw error(Failure::usage, "training: {} is {}; {}", key, value, allowed);
}

void at_least(const char* key, double value, double minimum) {
  if (!(value >= minimum))
    throw error(Failure::usage, "training: {} is {}; it must be at least {}", key, value, minimum);
}

void positive(const char* key, double value) {
  require(value > 0.0, key, value, "it must be positive");
}

void share(const char* key, double value) {
  require(value >= 0.0 && value <= 1.0, key, value, "it must lie in [0, 1]");
}

}  // namespace

void check(const TrainingSettings& s) {
  at_least("steps", static_cast<double>(s.steps), 1);
  at_least("environments", s.environments, 1);
  at_least("rollout", s.rollout, 1);
  at_least("epochs", s.epochs, 1);
  at_least("minibatches", s.minibatches, 1);
  require(s.minibatches <= s.batch(), "minibatches", s.minibatches,
          "a rollout has fewer samples (environments x rollout)");
  share("gamma", s.gamma);
  share("lambda", s.lambda);
  positive("clip", s.clip);
  at_least("value_coefficient", s.value_coefficient, 0);
  at_least("entropy_coefficient", s.entropy_coefficient, 0);
  at_least("max_gradient_norm", s.max_gradient_norm, 0);
  positive("learning_rate", s.learning_rate);
  at_least("learning_rate_horizon", static_cast<double>(s.learning_rate_horizon), 0);
  positive("adam_epsilon", s.adam_epsilon);
  for (const int width : s.hidden) at_least("hidden", width, 1);
  positive("head_gain", s.head_gain);
  positive("observation_clip", s.observation_clip);
  positive("reward_clip", s.reward_clip);
  at_least("evaluation_interval", s.evaluation_interval, 1);
  at_least("evaluation_episodes", s.evaluation_episodes, 1);
  at_least("final_episodes", s.final_episodes, 0);
  at_least("final_jitter", s.final_jitter, 0);
  at_least("population", s.population, 4);
  positive("initial_sigma", s.initial_sigma);
  at_least("shortest_period", s.shortest_period, 2);
  at_least("longest_period", s.longest_period, s.shortest_period);
  for (const int period : s.clock) at_least("clock", period, 2);
  share("noise_correlation", s.noise_correlation);
  require(s.noise_correlation < 1.0, "noise_correlation", s.noise_correlation,
          "it must be below 1");
  share("failure_weight", s.failure_weight);
  at_least("start_jitter", s.start_jitter, 0);
  share("moment_share", s.moment_share);
  at_least("moment_jitter", s.moment_jitter, 0);
  at_least("evaluation_jitter", s.evaluation_jitter, 0);
  share("wave_share", s.wave_share);
  positive("actuator_sigma", s.actuator_sigma);
  share("gait_share", s.gait_share);
  if (s.attempts.empty())
    throw Error(Failure::usage, "training: attempts is []; name one kind at least");
  share("time_share", s.time_share);
  share("rest_share", s.rest_share);
  check_method(s);
}

}  // namespace evo
