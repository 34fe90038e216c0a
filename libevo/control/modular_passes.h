// What PPO (ppo.h) needs of a policy for any body (modular_policy.h), over many bodies side by
// side. A sample is one environment's step: its view voxel by voxel, an action of every actuator.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libevo/control/modular_policy.h"
#include "libevo/control/ppo.h"

namespace evo {

class ModularPasses {
 public:
  using Policy = ModularPolicy;
  using Seen = const VecEnv&;
  static const VecEnv& seen(const VecEnv& env) { return env; }

  // So many environments of each robot. The robots in their order, as evenly as can be in groups
  // that take turns; environments are numbered through them.
  ModularPasses(ModularPolicy policy, std::span<const Arena* const> robots, int environments,
                int groups);

  const ModularPolicy& policy() const { return policy_; }
  auto parameters() { return parameter_blocks(policy_); }
  auto slopes() { return parameter_blocks(gradients_); }

  std::int64_t turns() const { return std::ssize(turns_); }
  void begin_turn(std::int64_t update, int rollout);
  std::size_t first() const { return turn_->first; }
  std::size_t environments() const { return body_of().size(); }
  std::size_t first_target() const { return turn_->first_target; }
  std::size_t targets() const {
    return turns_.back().first_target + turns_.back().first_action.back();
  }
  std::size_t first_action(std::size_t environment) const {
    return turn_->first_action[environment];
  }
  std::size_t most_actions() const { return most_actions_; }
  std::size_t actions_of_sample(std::size_t sample) const {
    return bodies()[minibatch_.bodies[sample]].actuators().size();
  }

  // As those of PolicyPasses.
  void look(const VecEnv& env, std::span<const int> steps);
  void act();
  void evaluate();
  std::span<const float> means() const { return means_; }
  std::span<const float> values() const {
    return {values_.data(), static_cast<std::size_t>(values_.size())};
  }
  void rest(std::size_t environment, std::span<double> targets) const;
  double target(double rest, double action) const;
  float value(const VecEnv& reached, std::span<const int> steps, std::size_t environment);
  void keep(int t);
  void gather(std::span<const std::uint32_t> samples);
  VoxelBatch& minibatch() { return minibatch_; }

  Vector& begin_backward();
  template <typename Use>
  void each_chunk(Use use) {
    evo::each_chunk(
        bodies(), minibatch_,
        [&](const VoxelSamples& samples, std::size_t first_sample, std::size_t first_action) {
          forward_chunk(samples, first_sample);
          use(Chunk{first_sample, first_action, chunk_means_, chunk_values_, mean_slopes_,
                    value_slopes_});
          backward_chunk(samples);
        });
  }
  void end_backward();

  void serialize(const Archive& archive);

 private:
  // The environments of a group, which step side by side between two updates, and where they,
  // their voxels and actuators begin among those of all.
  struct Turn {
    Bodies bodies;
    std::vector<int> body_of;               // [E_g], of `bodies`
    std::size_t first;                      // environment, of all
    std::size_t first_target;               // actuator, of all
    std::vector<Eigen::Index> first_voxel;  // [E_g + 1] of the group's
    std::vector<std::size_t> first_action;  // [E_g + 1] of the group's
  };
  const Bodies& bodies() const { return turn_->bodies; }
  const std::vector<int>& body_of() const { return turn_->body_of; }
  void look_at(const VecEnv& env, std::size_t environment);
  void forward_chunk(const VoxelSamples& samples, std::size_t first_sample);
  void backward_chunk(const VoxelSamples& samples);

  ModularPolicy policy_;
  std::vector<Turn> turns_;
  const Turn* turn_ = nullptr;
  std::size_t most_actions_ = 0;
  ModularGradients gradients_;
  // For the E_g environments whose turn it is:
  VoxelBatch state_;           // s_t
  std::vector<double> local_;  // of all voxels, as looked at
  std::vector<double> task_;   // of all environments
  VoxelBatch rollout_;         // samples t*E_g + e
  VoxelBatch minibatch_;
  VoxelBatch reached_;

  PreparedNetwork actor_;  // of the parameters at the beginning of the turn
  PreparedNetwork critic_;
  ModularPass pass_;
  std::vector<float> means_;
  Vector values_;

  PreparedNetwork changing_actor_;  // of the present parameters
  PreparedNetwork changing_critic_;
  ModularPass actor_pass_;
  ModularPass critic_pass_;
  std::vector<float> chunk_means_;
  std::vector<float> chunk_values_;
  std::vector<float> mean_slopes_;
  std::vector<float> value_slopes_;
};

// An untrained policy for a task that shows `task_length` numbers, with targets in [low, high].
ModularPolicy initial_modular_policy(const TrainingSettings& settings, int task_length, double low,
                                     double high, Stream stream);

}  // namespace evo
