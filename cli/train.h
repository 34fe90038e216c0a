// Robots in, trained controllers out, as files: where a training starts from (start.h),
// policy, checkpoint and log of each robot, and what is known already. evo-train
// is this from a command line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/robot/robot.h"
#include "formats/training/policy.h"
#include "libevo/base/parallel.h"
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
  std::string created_by;  // goes into policies and logs

  // ID.policy.h5 and ID.checkpoint.h5 go to `policies`, ID.log to `logs`.
  std::filesystem::path policies = ".";
  std::filesystem::path logs = ".";
  // One controller for all robots, into this policy; checkpoint and log lie beside it.
  std::optional<std::filesystem::path> shared;

  // Where controllers to start from are: a policy for every robot, or a folder with those
  // of parents; and one for every robot without parents, or a folder that has theirs.
  std::optional<std::filesystem::path> init;
  std::optional<std::filesystem::path> founders_from;
  // A folder that has one for every robot, instead.
  std::optional<std::filesystem::path> own;

  // Rollouts at whose moments episodes begin, or folders with a robot's, ID.h5.
  std::vector<std::filesystem::path> moments;

  std::int64_t checkpoint_every = 100'000;  // environment steps; 0: when interrupted only
  bool keep_checkpoint = false;             // at the end, too
  bool resume = false;                      // go on from checkpoints
  bool replace = false;                     // policies that were trained otherwise
  bool skip_failures = false;               // a training that diverges: no fitness, go on

  const TrainingSettings& settings(const Robot& robot) const;
};

// What the plan's files of a robot, or of all, are called.
struct TrainingPaths {
  std::filesystem::path policy;
  std::filesystem::path checkpoint;
  std::filesystem::path log;
};
TrainingPaths training_paths(const TrainingPlan& plan, const std::string& id);
// What names the random streams of a training.
std::string stream_name(const TrainingPlan& plan, const Robot& robot);

// The robot with what its policy says of it.
Robot scored(const TrainingPlan& plan, const Robot& robot, double fitness,
             const std::filesystem::path& path, const PolicyFile& policy, const Arena& arena);

// How a training went in this process.
struct Trained {
  std::size_t index = 0;       // of the robot, in the order given
  std::optional<Robot> robot;  // with fitness or failure; nothing: interrupted
  bool known = false;          // trained before with the same settings, not now
  double started = 0.0;        // seconds since 1970
  double seconds = 0.0;
  std::int64_t steps = 0;  // environment steps taken
};

// Who follows trainings; called from several threads.
struct TrainingObserver {
  std::function<void(const std::string&)> note;
  std::function<int()> interrupted;  // the signal that asks to stop, or 0
  // Before its first step in this process; not of robots that are trained already.
  std::function<void(std::size_t index)> begins;
  std::function<void(std::size_t index, const TrainingReport&)> progress;
  std::function<void(const Trained&)> ended;  // in any order
};

// Whether a robot of this shape could be trained as planned: settings and steps allow it,
// from the controller of another one, too, where it `inherits`. Throws what the beginning
// of its training would throw. Of a shape that cannot stand in the task nothing is known.
// With `robots` it is one controller for so many.
enum class Inherits { no, yes };
void check_settings(const TrainingPlan& plan, const TrainingSettings& settings, int rows, int cols,
                    Inherits inherits, int robots = 1);

// Trains the robots on the pool's threads, or one controller for all of them. Returns the signal
// that interrupted, or 0; each training that had not ended then has a checkpoint. Throws
// Error(work) for a training that failed unless failures are skipped, else what reading and
// writing the files throws; the first Error names its robot.
int train_robots(const TrainingPlan& plan, const std::vector<Robot>& robots, ThreadPool& pool,
                 const TrainingObserver& observer);

}  // namespace evo
