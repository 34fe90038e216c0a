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
  change_physics(spec);
  return spec;
}

void TaskOptions::change_physics(TaskSpec& spec) const {
  if (physics.empty()) return;
  const auto [profile, settings] = profile_words(physics);
  Physics changed = profile ? physics_profiles().load(*profile, data_folders()) : spec.physics;
  for (const std::string& assignment : settings) physics_profiles().assign(changed, assignment);
  physics_profiles().check(changed);
  set_physics(spec, changed);
}

}  // namespace evo::cli
