// The options of evo-train, and what they mean as a TrainingPlan.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/task_options.h"
#include "cli/train.h"
#include "formats/robot/robot.h"

namespace evo::cli {

struct TrainingOptions {
  TaskOptions task;
  std::vector<std::string> train;  // profiles and settings (profile_words)
  std::optional<std::string> steps;
  std::optional<std::string> founder_steps;
  std::string out_dir = ".";
  int checkpoint_every = 100'000;
  std::optional<std::string> init;
  std::optional<std::string> founder_init;
  std::vector<std::string> moments;
  std::optional<std::string> shared;
  bool by_sequence = false;
  bool keep_checkpoint = false;
  bool resume = false;
  bool force = false;
  bool skip_failures = false;

  // All of them, --seed, --output, --jobs and --progress included.
  void add_to(Command& command);
  // Throws Error(usage) for settings that make no sense, and what a task or profile that
  // cannot be read throws.
  TrainingPlan plan(std::uint64_t seed) const;
};

// Trains the robots on `command.jobs` threads with a live line of progress; `begins` is told
// of each before its first step, `ended` after its last, in any order, from several threads.
// Returns the exit status: 0, or 128 + the signal that interrupted. Throws like evo::train_robots.
int train_robots(const Command& command, const TrainingPlan& plan, const std::vector<Robot>& robots,
                 const std::function<void(std::size_t)>& begins,
                 const std::function<void(const Trained&)>& ended);

inline constexpr const char* how_to_go_on =
    "interrupted; give the same command with --resume to go on";

}  // namespace evo::cli
