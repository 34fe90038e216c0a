// Between episodes and files: rollouts as they happen, draws as JSON.
#pragma once

#include <string>
#include <vector>

#include "formats/rollout/rollout.h"
#include "formats/training/policy.h"
#include "libevo/control/evaluate.h"
#include "libevo/task/behaviour.h"
#include "libevo/task/env.h"

namespace evo {

// Gathers what episodes of one arena do into a Rollout.
class Recorder {
 public:
  Recorder(const Arena& arena, const Robot& robot, std::uint64_t seed,
           const std::string& created_by);

  // For evaluate(): call with every moment, in any order of episodes.
  void record(const EpisodeMoment& moment);

  const Rollout& rollout() const { return rollout_; }

 private:
  Rollout rollout_;
};

// How a robot behaves in the episodes of an evaluation: a mean, as its fitness is.
class BehaviourGauge {
 public:
  // For evaluate(): call with every moment, in any order of episodes.
  void record(const EpisodeMoment& moment);

  Json mean() const;  // {"distance": 7.1, ..}

 private:
  std::vector<BehaviourMeter> episodes_;
};

// Where an episode of a policy FILE.policy.h5 is recorded, FILE.rollout.h5.
std::filesystem::path recorded_beside(const std::filesystem::path& policy);

// A policy at its task once more: the episode from the official start. Where no tool
// knows the task, the one recorded beside its `file` ("" where there is none). Throws what reading
// that throws, Error(data) for that of another robot.
Rollout play(const PolicyFile& policy, const std::filesystem::path& file,
             const std::string& created_by);

// {"ox":0,"oy":3} or {"goals":[47,32]}; {} for a task without random parts.
Json draws_to_json(const Draws& draws);
// Throws Error(data) unless the names are those the task draws.
Draws read_draws(const Node& draws, const TaskSpec& task);
// As above from JSON text, or from the file (a rollout) of that name, as an option: Error(usage).
Draws parse_draws(const std::string& text_or_file, const TaskSpec& task);

}  // namespace evo
