#include "cli/data.h"

#include <algorithm>
#include <system_error>

#include "formats/task/task.h"
#include "libevo/base/error.h"

namespace evo::cli {

namespace fs = std::filesystem;

fs::path own_folder() {
  std::error_code unknown;
  return fs::read_symlink("/proc/self/exe", unknown).parent_path();
}

fs::path data_root() {
  const fs::path here = own_folder();
  return evo::data_root({here / EVO_INSTALLED_DATA, here / EVO_CHECKOUT});
}

DataFolders data_folders() { return evo::data_folders(data_root()); }

std::vector<std::string> profiles_and_settings(const std::string& folder,
                                               const std::vector<std::string>& settings) {
  std::vector<std::string> words = data_names(data_folders(), folder);
  words.insert(words.end(), settings.begin(), settings.end());
  return words;
}

void refuse_task_as_file(const std::string& name) {
  std::error_code ignored;
  if (name.empty() || is_file_name(name) || fs::exists(name, ignored)) return;
  const std::vector<std::string> tasks = task_names(data_folders());
  if (std::find(tasks.begin(), tasks.end(), name) == tasks.end()) return;
  throw error(
      Failure::no_input,
      "{}: this is a task and no file; give it as --task {}. `evo-inspect task {}` explains "
      "it",
      name, name, name);
}

}  // namespace evo::cli
