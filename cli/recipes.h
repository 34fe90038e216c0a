// Recipes: evolutions in rounds, as data (tasks/recipes). The best robots of each round are the
// founders of the next.
#pragma once

#include <string>
#include <vector>

#include "formats/io/data_folders.h"
#include "formats/run/run.h"

namespace evo::cli {

inline constexpr const char* default_recipe = "moments";

struct Recipe {
  std::string description;
  std::vector<std::vector<RunSetting>> rounds;  // of method ga
};

// By name or file. A round whose task is "easier" stands for one on each of the worlds that are
// easier than `task` (tasks/easier). Throws Error(usage, no_input, data).
Recipe load_recipe(const std::string& name, const std::string& task, const DataFolders& folders);

}  // namespace evo::cli
