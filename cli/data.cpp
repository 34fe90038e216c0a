#include "cli/data.h"

#include <system_error>

namespace evo::cli {

namespace fs = std::filesystem;

fs::path data_root() {
  std::error_code unknown;
  const fs::path here = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  return evo::data_root({here / EVO_INSTALLED_DATA, here / EVO_CHECKOUT});
}

DataFolders data_folders() { return evo::data_folders(data_root()); }

}  // namespace evo::cli
