// Training profiles as YAML: every setting of libevo/control/settings.h by name;
// a profile may start from another one and give only what differs.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/data_folders.h"
#include "formats/io/json.h"
#include "formats/io/node.h"
#include "formats/io/profile.h"
#include "libevo/control/settings.h"

namespace evo {

// A profile by name ("default", in the subfolder `training` of a data folder) or
// by file (a name with '/' or ending in .yaml). "paper" is what libevo has built
// in where no folder has it. Throws Error(usage) for an unknown name,
// Error(no_input), Error(data).
TrainingSettings load_training(const std::string& name_or_file, const DataFolders& folders);

// A mapping of settings, with `base` naming the profile it starts from (default
// paper). A base that is a file is looked for in `folder`.
TrainingSettings training_from_yaml(const Node& node, const std::filesystem::path& folder,
                                    const DataFolders& folders);

// Sets one setting: "gamma=0.995", "hidden=32,32". Throws Error(usage).
void apply_override(TrainingSettings& settings, std::string_view assignment);

// The complete profile, each setting with its meaning; numbers are exact:
// training_from_yaml gives the same settings.
std::string training_to_yaml(const TrainingSettings& settings);

// Every setting with what there is to know of it, in the order of the profile.
std::vector<SettingRow> training_table(const TrainingSettings& settings);

// The JSON Schema of a profile.
Json training_schema();

// "training.gamma=0.995": what decides a result, a line per setting.
std::vector<std::string> training_identity(const TrainingSettings& settings);

}  // namespace evo
