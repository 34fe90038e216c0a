// The options of evo-train, and what they mean as a TrainingPlan.
#pragma once

#include <cstdint>
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
  bool by_sequence = false;
  TrainingPlan files;  // and how they are treated

  // All of them, --seed, --output, --jobs and --progress included.
  void add_to(Command& command);
  // Throws Error(usage) for settings that make no sense, and what a task or profile that
  // cannot be read throws.
  TrainingPlan plan(std::uint64_t seed) const;
};

}  // namespace evo::cli
