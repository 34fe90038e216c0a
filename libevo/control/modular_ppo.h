// Proximal policy optimisation (ppo.h) of a modular policy over many bodies side by side.
// A sample is one environment's step: its view voxel by voxel, an action of every actuator.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libevo/control/checkpoint.h"
#include "libevo/control/modular_policy.h"
#include "libevo/control/optimizer.h"
#include "libevo/control/ppo_parts.h"
#include "libevo/control/settings.h"

namespace evo {

// Samples of a rollout.
struct ModularSamples : SampleNumbers {
  VoxelBatch states;           // s [M]
  std::vector<float> actions;  // a of every sample in turn, before the action map
};

struct ModularScratch {
  PreparedNetwork prepared_actor;
  PreparedNetwork prepared_critic;
  ModularPass actor;
  ModularPass critic;
  std::vector<float> means;
  std::vector<float> mean_slopes;
  std::vector<float> values;
  std::vector<float> value_slopes;
};

// The parts of L over a batch, and dL/d(parameters), which replaces `gradients`. The entropy
// is the mean over samples of that of all their actuators.
Losses differentiate(const ModularPolicy& policy, const Bodies& bodies, const ModularSamples& batch,
                     const Objective& objective, ModularGradients& gradients,
                     ModularScratch& scratch);

// An untrained policy for a task that shows `task_length` numbers, with targets in [low, high].
ModularPolicy initial_modular_policy(const TrainingSettings& settings, int task_length, double low,
                                     double high, Stream stream);

// A policy's numbers in a checkpoint, under `name`; loading needs a policy of the same shape.
void save_policy(Checkpoint& checkpoint, const std::string& name, const ModularPolicy& policy);
void load_policy(const Checkpoint& checkpoint, const std::string& name, ModularPolicy& policy);

// Environments that step side by side between two updates, and what bodies they have.
struct Group {
  Bodies bodies;
  std::vector<int> body_of;  // [E_g], of `bodies`
};

class ModularPpo {
 public:
  // Environments are numbered through the groups, which must outlive this. Each update learns
  // from one group, in turn. Random numbers come from streams named by seed and `name`.
  ModularPpo(const TrainingSettings& settings, ModularPolicy policy, std::span<const Group> groups,
             std::uint64_t seed, std::string_view name);

  // The environments that step until the next update.
  std::size_t first_environment() const { return turn().first; }
  std::size_t last_environment() const { return turn().first + turn().body_of().size(); }
  std::int64_t updates_in_all() const;

  // As Ppo's, but that arrays are of all environments, of which only those are looked at that
  // step. What is seen is read from `env`; `reached` has not been reset yet.
  void observe(const VecEnv& env, std::span<const int> steps);
  std::span<const double> act();
  void reward(std::span<const double> rewards, std::span<const std::uint8_t> terminated,
              std::span<const std::uint8_t> truncated, const VecEnv& reached,
              std::span<const int> steps);
  UpdateReport learn();

  const ModularPolicy& policy() const { return policy_; }
  std::int64_t updates() const { return learner_.updates; }
  const std::optional<std::string>& divergence() const { return learner_.divergence; }

  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

 private:
  // A group, and where its environments, voxels and actuators begin among those of all.
  struct Turn {
    const Group* group;
    std::size_t first;                      // environment, of all
    std::size_t first_target;               // actuator, of all
    std::vector<Eigen::Index> first_voxel;  // [E_g + 1] of the group's
    std::vector<std::size_t> first_action;  // [E_g + 1] of the group's
    const Bodies& bodies() const { return group->bodies; }
    const std::vector<int>& body_of() const { return group->body_of; }
  };
  const Turn& turn() const {
    return turns_[static_cast<std::size_t>(learner_.updates) % turns_.size()];
  }

  void look(const VecEnv& env, std::size_t environment);
  void gather(std::span<const std::uint32_t> samples);
  void begin_turn();

  TrainingSettings settings_;
  ModularPolicy policy_;
  std::vector<Turn> turns_;
  std::vector<double> targets_;  // of all actuators
  ppo::Learner learner_;
  // Of the E_g environments whose turn it is:
  VoxelBatch state_;           // s_t
  std::vector<double> local_;  // of all voxels, as looked at
  std::vector<double> task_;   // of all environments
  ModularSamples rollout_;     // being collected, samples t*E_g + e

  PreparedNetwork actor_;  // of the present parameters
  PreparedNetwork critic_;
  ModularPass pass_;
  std::vector<float> means_;
  Vector values_;
  VoxelBatch bootstrapped_;
  ModularSamples minibatch_;
  ModularGradients gradients_;
  ModularScratch scratch_;
};

}  // namespace evo
