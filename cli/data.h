// Where the tools find tasks, profiles and recipes by name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/io/data_folders.h"

namespace evo::cli {

// Where the running executable is.
std::filesystem::path own_folder();

// The folder that holds tasks/: $EVO_DATA; else the one installed
// with the running executable, wherever its prefix was moved; else the checkout
// the executable was built in. Throws Error(no_input) when there is none.
std::filesystem::path data_root();

// Folders in $EVO_TASKS (separated by colons), then data_root()'s tasks.
DataFolders data_folders();

// Values of --physics or --train, for completion: names of the profiles in a folder of tasks/, then
// settings.
std::vector<std::string> profiles_and_settings(const std::string& folder,
                                               const std::vector<std::string>& settings);

// Throws Error(no_input) where no file has this name but a task does, as in `evo-eval
// Walker-v0 robots.jsonl`.
void refuse_task_as_file(const std::string& name);

}  // namespace evo::cli
