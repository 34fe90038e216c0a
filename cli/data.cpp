#include "cli/data.h"

#include <cstdlib>
#include <sstream>
#include <system_error>

namespace evo::cli {

DataFolders data_folders() {
  DataFolders folders;
  if (const char* list = std::getenv("EVO_TASKS")) {
    std::istringstream pieces(list);
    for (std::string folder; std::getline(pieces, folder, ':');)
      if (!folder.empty()) folders.emplace_back(folder);
  }
  std::error_code failed;
  const auto executable = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (!failed) folders.push_back(executable.parent_path() / EVO_INSTALLED_TASKS);
  folders.emplace_back(EVO_SOURCE_TASKS);
  return folders;
}

}  // namespace evo::cli
