// What the voxels of a session's robots see (libevo/control/voxel_views.h), and a trained
// controller of any kind at work in its environments.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "bindings/c/session.h"
#include "libevo/control/modular_policy.h"
#include "libevo/control/trainer.h"

namespace evo {

class SessionVoxels {
 public:
  // `session` must outlive this.
  explicit SessionVoxels(const Session& session);

  // Those of an environment's robot.
  const VoxelViews& of(int environment) const { return bodies_[robot(environment)]; }
  // A voxel and one that it is linked to, for every voxel in turn, ascending: each link twice.
  std::span<const std::pair<std::int32_t, std::int32_t>> links(int environment) const {
    return links_[static_cast<std::size_t>(robot(environment))];
  }
  const Bodies& bodies() const { return bodies_; }  // of the robots
  const Session& session() const { return *session_; }
  std::size_t local_values() const { return local_values_; }  // of all environments
  std::size_t task_values() const { return task_values_; }

  // As all environments are now: local [voxels x VoxelViews::local_length] of each in turn,
  // task [E x task_length].
  void look(std::span<double> local, std::span<double> task) const;

 private:
  int robot(int environment) const { return environment / session_->per_robot(); }

  const Session* session_;
  Bodies bodies_;
  std::vector<std::vector<std::pair<std::int32_t, std::int32_t>>> links_;
  std::size_t local_values_ = 0;
  std::size_t task_values_ = 0;
};

// The deterministic controller: targets of all environments, as Session::step takes them; a
// modular policy acts on any robot. Throws Error(usage) where it has other observations or
// actions than one of the robots, Error(data) where it was trained on another task.
void act(const TrainedController& controller, const SessionVoxels& voxels,
         std::span<double> targets);

}  // namespace evo
