#include <set>

#include "bindings/web/wasm/files.h"
#include "formats/io/data_folders.h"

namespace evo {
namespace fs = std::filesystem;

std::optional<fs::path> find_data_file(const DataFolders& folders, const std::string& subfolder,
                                       const std::string& name) {
  for (const fs::path& folder : folders) {
    fs::path path = folder / subfolder / (name + ".yaml");
    if (given_files().count(path.string()) != 0) return path;
  }
  return std::nullopt;
}

std::vector<std::string> data_names(const DataFolders& folders, const std::string& subfolder) {
  std::set<std::string> names;
  for (const fs::path& folder : folders)
    for (const auto& [name, text] : given_files())
      if (const fs::path path(name); path.parent_path() == (folder / subfolder / "x").parent_path())
        names.insert(path.stem().string());
  return {names.begin(), names.end()};
}

}  // namespace evo
