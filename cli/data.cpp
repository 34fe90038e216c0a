#include "cli/data.h"

#include <array>
#include <cstdlib>
#include <sstream>
#include <system_error>

#include "libevo/base/error.h"

namespace evo::cli {
namespace {

namespace fs = std::filesystem;

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

fs::path data_root() {
  if (const char* folder = std::getenv("EVO_DATA"); folder != nullptr && *folder != '\0') {
    if (!is_data_root(folder))
      throw error(Failure::no_input, "EVO_DATA: '{}' is not a folder with tasks/physics in it",
                  folder);
    return tidy(folder);
  }
  std::error_code failed;
  const fs::path here = fs::read_symlink("/proc/self/exe", failed).parent_path();
  const std::array candidates{tidy(here / EVO_INSTALLED_DATA), tidy(here / EVO_CHECKOUT)};
  for (const fs::path& candidate : candidates)
    if (!failed && is_data_root(candidate)) return candidate;
  throw error(Failure::no_input,
              "the tasks are neither in {} nor in {}; name the folder that holds tasks/ and "
              "scripts/ in EVO_DATA",
              candidates[0].string(), candidates[1].string());
}

DataFolders data_folders() {
  DataFolders folders;
  if (const char* list = std::getenv("EVO_TASKS")) {
    std::istringstream pieces(list);
    for (std::string folder; std::getline(pieces, folder, ':');)
      if (!folder.empty()) folders.emplace_back(folder);
  }
  folders.push_back(data_root() / "tasks");
  return folders;
}

}  // namespace evo::cli
