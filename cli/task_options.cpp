#include "cli/task_options.h"

#include "cli/data.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"

namespace evo::cli {

void TaskOptions::add_to(Command& command, const std::string& otherwise) {
  command.option("--task", task, "TASK",
                 "a benchmark task by name, or a task file of your own" +
                     (task ? " [" + *task + "]" : otherwise));
  command.option("--physics", physics, "PROFILE",
                 "physics profile by name or file (evogym, paper) [the task's]");
  command.option(
      "--set", set, "KEY=VALUE",
      "one constant of the physics, such as gravity=50 (repeatable); 'evo-inspect physics' "
      "lists them");
  command.suggestions("--task", [] { return task_names(data_folders()); });
  command.suggestions("--physics", [] { return data_names(data_folders(), "physics"); });
  command.suggestions("--set", [] { return assignments(physics_table(Physics())); });
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

std::string profile_name(const Physics& physics) {
  const DataFolders folders = data_folders();
  for (const std::string& name : data_names(folders, "physics"))
    if (load_physics(name, folders) == physics) return name;
  return "own";
}

}  // namespace evo::cli
