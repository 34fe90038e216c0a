#include "formats/data_folders.h"

#include <set>
#include <system_error>

namespace evo {
namespace fs = std::filesystem;

bool is_file_name(const std::string& name_or_file) {
  const fs::path path(name_or_file);
  return name_or_file.find('/') != std::string::npos || path.extension() == ".yaml" ||
         path.extension() == ".yml";
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
