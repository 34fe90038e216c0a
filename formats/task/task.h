// Tasks as YAML. docs/make-a-task.md shows
// the form by example; this reader refuses whatever it does not know, with file,
// line, column and the nearest word that is allowed.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/data_folders.h"
#include "libevo/task/spec.h"

namespace evo {

// A task by name, by alias, or by file (a name with '/' or ending in .yaml).
// TaskSpec.source is complete in itself: parse_task reads it without any other
// file. Throws Error(usage) for an unknown name, Error(no_input), Error(data).
TaskSpec load_task(const std::string& name_or_file, const DataFolders& folders);

// A task from text; `where` begins every message. Files that it names (its base, its world,
// its physics) are looked for in `folder`, tasks and profiles by name in `folders`.
TaskSpec parse_task(std::string_view text, const std::string& where,
                    const std::filesystem::path& folder = {}, const DataFolders& folders = {});

// The whole task, worlds drawn, physics complete: parse_task gives it back.
std::string task_to_yaml(const TaskSpec& task);

// Changes the physics of a task that was loaded, its source included, by profile_words such as
// those of --physics. Throws Error(usage), and as Profiles::load; constants are checked together.
void change_physics(TaskSpec& task, const std::vector<std::string>& words,
                    const DataFolders& folders);

// All tasks in the folders, by name (aliases left out).
std::vector<std::string> task_names(const DataFolders& folders);

}  // namespace evo
