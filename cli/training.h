// What evo-train does: its options, and a controller for each robot. evo-run
// trains the slots of a run with the same.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/task_options.h"
#include "formats/robot/robot.h"
#include "libevo/control/settings.h"

namespace evo::cli {

struct TrainingOptions {
  TaskOptions task;
  std::string profile = "default";
  std::vector<std::string> set;
  std::optional<std::string> algorithm;
  std::optional<std::string> steps;
  std::optional<std::string> founder_steps;
  std::string out_dir = ".";
  std::optional<std::string> log_dir;
  std::optional<std::string> curve;
  int checkpoint_every = 100'000;
  std::optional<int> final_episodes;
  std::optional<double> jitter;
  std::optional<std::string> init;
  bool keep_checkpoint = false;
  bool resume = false;
  bool force = false;
  bool behaviour = false;
  std::string failures = "stop";
  // Where robots without parents have policies that they start from; no option.
  std::optional<std::string> founders_from;
  bool sharded = false;   // into folders by the first two digits of ids; no option
  bool in_rungs = false;  // trainings go on as a rule, which is not worth a note; no option

  // All of them, --seed, --output, --jobs and --progress included.
  void add_to(Command& command);
  // The profile with what the options change. Throws Error(usage).
  TrainingSettings settings() const;
  TrainingSettings founder_settings() const;  // of robots without parents
};

// How a training went in this process.
struct Trained {
  std::size_t index = 0;       // of the robot, in the order given
  std::optional<Robot> robot;  // with fitness or failure; nothing: interrupted
  bool known = false;          // trained before with the same settings, not now
  double started = 0.0;        // seconds since 1970
  double seconds = 0.0;
  std::int64_t steps = 0;  // environment steps taken
};

inline constexpr const char* how_to_go_on =
    "interrupted; give the same command with --resume to go on";

// Trains the robots on `command.jobs` threads and hands over each as it ends, in
// any order, from several threads. Returns the exit status: 0, or 128 + the signal
// that interrupted, which the caller tells; half a second after an interrupt that
// finds trainings in the middle of an update, the process saves and ends at once.
// Throws the first Error, naming its robot.
int train_robots(const Command& command, const TrainingOptions& options,
                 const std::vector<Robot>& robots,
                 const std::function<void(const Trained&)>& ended);

}  // namespace evo::cli
