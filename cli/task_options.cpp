#include "cli/task_options.h"

#include "cli/data.h"
#include "formats/physics.h"
#include "formats/task.h"

namespace evo::cli {

void TaskOptions::add_to(Command& command) {
  command.option("--task", task, "TASK", "a benchmark task by name, or a task file of your own");
  command.option("--physics", physics, "PROFILE",
                 "physics profile by name or file (evogym, paper) [the task's]");
  command.option("--set", set, "KEY=VALUE",
                 "one constant of the physics, such as gravity=50 (repeatable)");
}

TaskSpec TaskOptions::load() const {
  if (!task) throw error(Failure::usage, "--task is required; 'evo-inspect tasks' lists the tasks");
  TaskSpec spec = load_task(*task, data_folders());
  change_physics(spec);
  return spec;
}

void TaskOptions::change_physics(TaskSpec& spec) const {
  if (!physics && set.empty()) return;
  Physics changed = physics ? load_physics(*physics, data_folders()) : spec.physics;
  for (const std::string& assignment : set) apply_override(changed, assignment);
  set_physics(spec, changed);
}

}  // namespace evo::cli
