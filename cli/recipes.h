// Recipes: evolutions in rounds, as data (tasks/recipes). The best robots of each round are the
// founders of the next.
#pragma once

#include <string>
#include <vector>

#include "formats/io/data_folders.h"
#include "formats/run/run.h"

namespace evo::cli {

inline constexpr const char* default_recipe = "moments";

// Rounds of method ga, of a recipe by name or file. A round whose task is "easier" stands for one
// on each of the worlds that are easier than `task` (tasks/easier). Throws Error(usage, no_input,
// data).
std::vector<std::vector<RunSetting>> load_recipe(const std::string& name, const std::string& task,
                                                 const DataFolders& folders);

}  // namespace evo::cli
