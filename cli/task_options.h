// --task and --physics: what robots are trained and measured in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "libevo/task/spec.h"

namespace evo::cli {

struct TaskOptions {
  std::optional<std::string> task;
  std::vector<std::string> physics;

  // `otherwise` says in the help what holds without --task.
  void add_to(Command& command, const std::string& otherwise = "; required");

  bool given() const { return task.has_value(); }
  // The task, with physics changed as asked. Throws Error(usage) without --task.
  TaskSpec load() const;
};

}  // namespace evo::cli
