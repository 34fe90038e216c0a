#include "formats/training/training.h"

namespace evo {
namespace {

// In the order of libevo/control/settings.h.
SettingTable<TrainingSettings> table() {
  using T = TrainingSettings;
  return SettingTable<T>(
      {
          {"algorithm", &T::algorithm, "", "network: ppo, modular; open loop: gait, sequence"},
          {"steps", &T::steps, at_least(1), "", "environment steps in all"},
          {"environments", &T::environments, at_least(1), "", "episodes side by side"},
          {"rollout", &T::rollout, at_least(1), "", "steps of each environment between updates"},
          {"epochs", &T::epochs, at_least(1), "", "passes over a rollout"},
          {"minibatches", &T::minibatches, at_least(1), "", "of each pass"},
          {"gamma", &T::gamma, a_share, "", "discount"},
          {"lambda", &T::lambda, a_share, "", "of generalised advantage estimation"},
          {"clip", &T::clip, above(0), "", "range of the probability ratio about 1"},
          {"clip_value_loss", &T::clip_value_loss, "",
           "keep values within `clip` of the old ones, too"},
          {"value_coefficient", &T::value_coefficient, at_least(0), "",
           "weight of half the squared value error"},
          {"entropy_coefficient", &T::entropy_coefficient, at_least(0), "",
           "weight of the entropy bonus"},
          {"max_gradient_norm", &T::max_gradient_norm, at_least(0), "",
           "of all parameters together; 0: no limit"},
          {"time_limit", &T::time_limit, "",
           "end: ends the episode; bootstrap: its value counts further"},
          {"learning_rate", &T::learning_rate, above(0), "", "of Adam, at first; falls to 0"},
          {"learning_rate_horizon", &T::learning_rate_horizon, at_least(0), "",
           "updates until it is 0; 0: the training's"},
          {"hidden", &T::hidden, at_least(1), "",
           "widths of the tanh layers, actor and critic each"},
          {"head_gain", &T::head_gain, above(0), "", "of the initial layer of action means"},
          {"initial_log_std", &T::initial_log_std, "",
           "log standard deviation of actions at the start"},
          {"action_map", &T::action_map, "", "offset: clip(offset + a); squash: tanh(a), scaled"},
          {"action_offset", &T::action_offset, "", "actuator target at action 0 (map offset)"},
          {"clock", &T::clock, at_least(2), "control steps", "periods whose phases networks see"},
          {"robots_per_update", &T::robots_per_update, at_least(0), "",
           "robots of an update, in turn; fewer: longer rollout; 0: all (modular)"},
          {"failure_weight", &T::failure_weight, a_share, "",
           "share of the cost of a bad end that the learner sees"},
          {"keep_sequence", &T::keep_sequence, "", "add actions to an inherited sequence (ppo)"},
          {"gait_log_std", &T::gait_log_std, "",
           "initial_log_std of actions added to a gait or sequence"},
          {"inherited_log_std", &T::inherited_log_std, "",
           "initial_log_std of an inherited policy"},
          {"start_jitter", &T::start_jitter, at_least(0), "voxels",
           "of start coordinates in training (ppo)"},
          {"moment_share", &T::moment_share, a_share, "",
           "of episodes: begin at a moment of the inherited controller's (ppo)"},
          {"moment_jitter", &T::moment_jitter, at_least(0), "voxels",
           "of coordinates at a moment (ppo)"},
          {"evaluation_interval", &T::evaluation_interval, at_least(1), "",
           "updates; one more after the last"},
          {"evaluation_episodes", &T::evaluation_episodes, at_least(1), "",
           "of the deterministic controller"},
          {"evaluation_jitter", &T::evaluation_jitter, at_least(0), "voxels",
           "of their start coordinates"},
          {"final_episodes", &T::final_episodes, at_least(0), "",
           "of the best controller, jittered; 0: none"},
          {"final_jitter", &T::final_jitter, at_least(0), "voxels", "of start coordinates"},
          {"population", &T::population, at_least(4), "",
           "candidates of a generation (gait, sequence)"},
          {"shortest_period", &T::shortest_period, at_least(2), "control steps",
           "of waves (gait, sequence)"},
          {"longest_period", &T::longest_period, "control steps", "of waves (gait, sequence)"},
          {"wave_share", &T::wave_share, a_share, "",
           "of the search: waves over the whole body (gait)"},
          {"gait_share", &T::gait_share, a_share, "",
           "of the steps: a search for a gait first (sequence)"},
      },
      check);
}

}  // namespace

template class Profiles<TrainingSettings>;

const Profiles<TrainingSettings>& training_profiles() {
  static const Profiles<TrainingSettings> profiles("training", "setting", format::training, "paper",
                                                   table());
  return profiles;
}

}  // namespace evo
