// Environments that a program outside drives step by step: what evo-env and the
// library share.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/robot/robot.h"
#include "libevo/base/parallel.h"
#include "libevo/task/env.h"

namespace evo {

// The numbers are those of evo_env_status.
enum class EnvironmentStatus : std::uint8_t {
  ok = 0,
  unreset = 1,   // before its first reset
  unstable = 2,  // the simulation failed; left out of steps until its next reset
};
const char* to_string(EnvironmentStatus status);

// Throws Error(usage) unless it is from 0 to less than half a voxel.
void check_jitter(double jitter);

// How episodes are to start. What is not given: the seed stays, episodes are
// counted on, draws follow from seed and episode.
struct ResetRequest {
  std::vector<int> environments;
  std::optional<std::uint64_t> seed;
  std::optional<std::uint64_t> episode;
  std::optional<Draws> draws;
  double jitter = 0.0;  // voxels
};

class Session {
 public:
  // `per_robot` environments for each robot: environment e is one of robot
  // e / per_robot. Throws Error(data) where a robot cannot stand in the task,
  // Error(usage) for too many environments.
  Session(const TaskSpec& task, std::vector<Robot> robots, int per_robot, std::uint64_t seed,
          int threads);

  const TaskSpec& task() const { return task_; }
  const std::vector<Robot>& robots() const { return robots_; }
  const Robot& robot(int environment) const;
  int environments() const { return envs_->environments(); }
  int per_robot() const { return per_robot_; }
  std::size_t action_values() const { return action_values_; }  // of all environments
  // The states themselves: observations, flags, positions, models.
  const VecEnv& envs() const { return *envs_; }

  // Throws Error(usage), with nothing reset, for an environment or draws that
  // the task does not have.
  void reset(const ResetRequest& request);
  // One control step; actions of all environments one after the other, those of
  // environments not in `active` (all, if empty) are ignored. Throws
  // Error(usage), with nothing stepped, for an action that is not a finite
  // number and for an environment that was never reset.
  void step(std::span<const double> actions, std::span<const std::uint8_t> active = {});

  // The state of an episode in progress, whole: it continues from there as often as it is
  // restored, in any environment of the same robot, task and version, to the same bits. The
  // bytes are opaque. Seeds and the count of episodes are none of it. Throws Error(usage)
  // for an environment whose status is not ok.
  std::vector<std::uint8_t> save(int environment) const;
  struct Restored {
    int environment;
    std::span<const std::uint8_t> state;
  };
  // Throws Error(usage) for environments that do not exist, Error(data) for bytes that were
  // saved elsewhere or are damaged; nothing is restored then.
  void restore(std::span<const Restored> states);

  // Moves an object of an episode in progress; its velocities stay. Throws Error(usage) for an
  // environment whose status is not ok.
  void translate(int environment, std::size_t object, Vec2 by);

  double reward(int environment) const;  // 0 unless its status is ok
  EnvironmentStatus status(int environment) const;

  // Refuses numbers that are not environments. Throws Error(usage).
  void check_environment(std::int64_t environment) const;

 private:
  // Where one environment is in its episodes.
  struct Progress {
    EnvironmentStatus status = EnvironmentStatus::unreset;
    std::uint64_t seed = 0;
    std::uint64_t next_episode = 0;
  };

  // The digest that a state of this environment begins with.
  std::string seal(int environment, std::span<const std::uint8_t> state) const;

  TaskSpec task_;
  std::string physics_;  // of the task, in full
  std::vector<Robot> robots_;
  int per_robot_;
  std::vector<std::unique_ptr<Arena>> arenas_;  // of each robot
  std::unique_ptr<VecEnv> envs_;
  std::vector<Progress> progress_;
  std::vector<std::uint8_t> active_;  // in the step being taken
  std::size_t action_values_ = 0;
  ThreadPool pool_;
};

}  // namespace evo
