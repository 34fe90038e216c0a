#include "formats/io/data_folders.h"

#include <cstdlib>
#include <set>
#include <system_error>

#include "formats/io/values.h"
#include "libevo/base/error.h"
#include "libevo/base/join.h"

namespace evo {
namespace fs = std::filesystem;

namespace {

// Without "..", and without a slash at the end.
fs::path tidy(const fs::path& path) {
  const fs::path normal = fs::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

bool is_data_root(const fs::path& folder) {
  std::error_code missing;
  return fs::is_directory(folder / "tasks" / "physics", missing);
}

}  // namespace

fs::path data_root(const std::vector<fs::path>& candidates) {
  if (const char* folder = std::getenv("EVO_DATA"); folder != nullptr && *folder != '\0') {
    if (!is_data_root(folder))
      throw error(Failure::no_input, "EVO_DATA: '{}' is not a folder with tasks/physics in it",
                  folder);
    return tidy(folder);
  }
  std::vector<std::string> seen;
  for (const fs::path& candidate : candidates) {
    const fs::path folder = tidy(candidate);
    if (is_data_root(folder)) return folder;
    seen.push_back(folder.string());
  }
  throw error(Failure::no_input,
              "the tasks are neither in {}; name the folder that holds tasks/ in EVO_DATA",
              joined(seen, " nor in "));
}

DataFolders data_folders(const fs::path& root) {
  DataFolders folders;
  if (const char* list = std::getenv("EVO_TASKS"))
    for (const std::string& folder : split_list(list, ':')) folders.emplace_back(folder);
  folders.push_back(root / "tasks");
  return folders;
}

ProfileWords profile_words(const std::vector<std::string>& values) {
  ProfileWords words;
  for (const std::string& value : values) {
    const std::size_t equals = value.find('=');
    if (equals != std::string::npos && value.find('/') > equals)
      words.settings.push_back(value);
    else
      words.profile = value;
  }
  return words;
}

std::optional<fs::path> find_data_file(const DataFolders& folders, const std::string& subfolder,
                                       const std::string& name) {
  for (const fs::path& folder : folders) {
    const fs::path path = folder / subfolder / (name + ".yaml");
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) return path;
  }
  return std::nullopt;
}

std::vector<std::string> data_names(const DataFolders& folders, const std::string& subfolder) {
  std::set<std::string> names;
  for (const fs::path& folder : folders) {
    std::error_code missing;  // a folder that does not exist has no names
    for (const auto& entry : fs::directory_iterator(folder / subfolder, missing))
      if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
  }
  return {names.begin(), names.end()};
}

}  // namespace evo
