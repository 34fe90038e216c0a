// Robots in, trained controllers out, as files: policy, checkpoint and log of each robot, and
// what is known already. evo-train is this from a command line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/journal.h"
#include "formats/robot/robot.h"
#include "formats/training/policy.h"
#include "libevo/control/settings.h"
#include "libevo/control/trainer.h"
#include "libevo/task/spec.h"

namespace evo {

// All that decides what a training does and where its files go.
struct TrainingPlan {
  TaskSpec task;
  TrainingSettings children;  // of robots with parents
  TrainingSettings founders;  // of the others
  std::uint64_t seed = 0;

  // The folder of ID.policy.h5, ID.checkpoint.h5 and ID.log.
  std::string policies = ".";
  // One controller for all robots, into this policy; checkpoint and log lie beside it.
  std::optional<std::string> shared;

  // Where controllers to start from are: a policy for every robot, or a folder with those
  // of parents; and one for every robot without parents, or a folder that has theirs.
  std::optional<std::string> init;
  std::optional<std::string> founders_from;
  // A folder that has one for every robot, instead.
  std::optional<std::string> own;

  int checkpoint_every = 100'000;  // environment steps; 0: when interrupted only
  bool keep_checkpoint = false;    // at the end, too
  bool resume = false;             // continue from checkpoints
  bool replace = false;            // policies that were trained otherwise
  bool skip_failures = false;      // a training that diverges: no fitness, continue

  const TrainingSettings& settings(const Robot& robot) const;
};

// What the plan's files of a robot, or of all, are called.
struct TrainingPaths {
  std::filesystem::path policy;
  std::filesystem::path checkpoint;
  std::filesystem::path log;
};
TrainingPaths training_paths(const TrainingPlan& plan, const std::string& id);
// What the journal calls a training.
std::string journal_name(const TrainingPlan& plan, const Robot& robot);

// The robot with what its policy says of it.
Robot scored(const TrainingPlan& plan, const Robot& robot, double fitness,
             const std::filesystem::path& path, const PolicyFile& policy, const Arena& arena);

// Whether robots of the first one's shape could be trained as planned, with or without parents:
// settings and steps allow it. Throws what the beginning of their trainings would throw. A shape
// that cannot stand in the task passes.
void check_trainings(const TrainingPlan& plan, const std::vector<Robot>& robots);

// Trains the robots, or one controller for all of them, on the command's threads with a live line
// of progress; each that has ended is put at its place, with its fitness or failure, in any order,
// from several threads. Returns the exit status: 0, or 128 + the signal that interrupted; each
// training that had not ended then has a checkpoint. Throws Error(work) for a
// training that failed unless failures are skipped, else what reading and writing the files
// throws; the first Error names its robot.
int train_robots(const cli::Command& command, const TrainingPlan& plan,
                 const std::vector<Robot>& robots, const cli::Journal& journal,
                 const std::function<void(std::size_t, Robot)>& put);

}  // namespace evo
