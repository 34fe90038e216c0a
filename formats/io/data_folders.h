// Where tasks and profiles are found by name: folders that hold them as YAML
// files, searched in order, first hit wins.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace evo {

// Each holds tasks as NAME.yaml, easier worlds for them as easier/NAME.yaml, physics profiles as
// physics/NAME.yaml.
using DataFolders = std::vector<std::filesystem::path>;

// The folder that holds tasks/ and scripts/: $EVO_DATA; else the first of
// `candidates` that is one. Throws Error(no_input).
std::filesystem::path data_root(const std::vector<std::filesystem::path>& candidates);

// The folders in $EVO_TASKS (separated by colons), then `root`/tasks.
DataFolders data_folders(const std::filesystem::path& root);

// "my/walk.yaml", "./walk", "walk.yml": a file rather than a name.
inline bool is_file_name(const std::string& name_or_file) {
  const std::filesystem::path path(name_or_file);
  return name_or_file.find('/') != std::string::npos || path.extension() == ".yaml" ||
         path.extension() == ".yml";
}

// The values of --physics or --train: the last profile named, by name or file, and settings
// ("gravity=50") that change it, in order.
struct ProfileWords {
  std::optional<std::string> profile;
  std::vector<std::string> settings;
};
ProfileWords profile_words(const std::vector<std::string>& values);

// SUBFOLDER/NAME.yaml in the first folder that has it.
std::optional<std::filesystem::path> find_data_file(const DataFolders& folders,
                                                    const std::string& subfolder,
                                                    const std::string& name);

// All names that find_data_file would find, sorted.
std::vector<std::string> data_names(const DataFolders& folders, const std::string& subfolder);

}  // namespace evo
