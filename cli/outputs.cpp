#include "cli/outputs.h"

#include <filesystem>
#include <map>

#include "formats/files.h"
#include "libevo/base/error.h"

namespace evo::cli {
namespace fs = std::filesystem;

void check_outputs(const std::vector<OutputName>& outputs) {
  std::map<fs::path, const OutputName*> owners;
  for (const OutputName& output : outputs) {
    std::error_code failed;
    if (output.path == standard_stream || fs::is_character_file(output.path, failed) ||
        fs::is_fifo(output.path, failed))
      continue;
    const fs::path whole = fs::weakly_canonical(fs::absolute(output.path), failed);
    const auto [owner, added] = owners.emplace(failed ? fs::path(output.path) : whole, &output);
    if (!added)
      throw error(Failure::usage, "{} and {} are both written to '{}'; name two files",
                  owner->second->option, output.option, output.path);
  }
}

}  // namespace evo::cli
