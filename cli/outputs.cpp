#include "cli/outputs.h"

#include <filesystem>
#include <map>
#include <optional>

#include "formats/io/files.h"
#include "libevo/base/error.h"

namespace evo::cli {
namespace fs = std::filesystem;

namespace {

// However it is written; nothing for what can be read and written by many.
std::optional<fs::path> file_named(const std::string& path) {
  std::error_code failed;
  if (path == standard_stream || fs::is_character_file(path, failed) || fs::is_fifo(path, failed))
    return std::nullopt;
  const fs::path whole = fs::weakly_canonical(fs::absolute(path), failed);
  return failed ? fs::path(path) : whole;
}

}  // namespace

void check_outputs(const std::vector<FileName>& outputs, const std::vector<FileName>& inputs) {
  std::map<fs::path, const FileName*> owners;
  for (const FileName& output : outputs) {
    const auto file = file_named(output.path);
    if (!file) continue;
    const auto [owner, added] = owners.emplace(*file, &output);
    if (!added)
      throw error(Failure::usage, "{} and {} are both written to '{}'; name two files",
                  owner->second->option, output.option, output.path);
  }
  for (const FileName& input : inputs) {
    const auto file = file_named(input.path);
    if (const auto owner = file ? owners.find(*file) : owners.end(); owner != owners.end())
      throw error(Failure::usage, "{} would replace {}, '{}'; name another file",
                  owner->second->option, input.option, input.path);
  }
}

void keep_inputs(const std::string& output, const std::vector<std::string>& files) {
  std::vector<FileName> inputs;
  for (const std::string& file : files) inputs.push_back({"an input", file});
  check_outputs({{"--output", output}}, inputs);
}

}  // namespace evo::cli
