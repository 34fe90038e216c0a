#include "cli/task_options.h"

#include "cli/data.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"

namespace evo::cli {

void TaskOptions::add_to(Command& command, const std::string& otherwise) {
  command.option("--task", task, "TASK",
                 "a benchmark task by name, or a task file of your own" +
                     (task ? " [" + *task + "]" : otherwise));
  command.option("--physics", physics, "PROFILE|KEY=VALUE",
                 "a physics profile by name or file, or one constant, such as gravity=50 "
                 "(repeatable); 'evo-inspect physics' lists them [the task's]");
  command.suggestions("--task", [] { return task_names(data_folders()); });
  command.suggestions("--physics", [] {
    return profiles_and_settings("physics", assignments(physics_profiles().rows({})));
  });
}

TaskSpec TaskOptions::load() const {
  if (!task) throw error(Failure::usage, "--task is required; 'evo-inspect tasks' lists the tasks");
  TaskSpec spec = load_task(*task, data_folders());
  change_physics(spec, physics, data_folders());
  return spec;
}

}  // namespace evo::cli
