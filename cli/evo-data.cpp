// evo-data: where tasks, profiles and recipes are, for scripts.
#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "cli/command.h"
#include "cli/data.h"
#include "formats/io/data_folders.h"
#include "formats/run/neat.h"
#include "formats/run/settings.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/training/training.h"
#include "libevo/base/error.h"

namespace {

using namespace evo;
namespace fs = std::filesystem;

// "tasks/Walker-v0.yaml", "tasks", .. as absolute paths. `..` would leave the folder.
fs::path locate(const fs::path& root, const std::string& name) {
  const fs::path asked = fs::path(name).lexically_normal();
  const bool inside = asked.is_relative() && *asked.begin() != "..";
  std::error_code missing;
  if (inside && fs::exists(root / asked, missing)) return (root / asked).lexically_normal();
  std::vector<std::string> known;
  for (const char* folder : {"tasks", "tasks/physics", "tasks/training", "tasks/recipes"})
    for (const auto& entry : fs::directory_iterator(root / folder, missing))
      known.push_back(fs::path(folder) / entry.path().filename());
  throw error(Failure::no_input, "{} has no '{}'{}", root.string(), name,
              did_you_mean(name, known));
}

std::vector<std::string> names_of(const std::string& kind) {
  if (kind == "tasks") return task_names(cli::data_folders());
  if (kind == "physics" || kind == "training") return data_names(cli::data_folders(), kind);
  throw error(Failure::usage, "--names: '{}' is not tasks, physics or training{}", kind,
              did_you_mean(kind, {"tasks", "physics", "training"}));
}

Json schema_of(const std::string& name) {
  if (name == "neat") return neat_schema();
  if (name == "physics") return physics_profiles().schema();
  if (name == "run") return run_schema();
  if (name == "training") return training_profiles().schema();
  throw error(Failure::usage, "--schema: '{}' is not neat, physics, run or training", name);
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-data");
  std::vector<std::string> paths;
  std::optional<std::string> names;
  std::optional<std::string> schema;
  command.arguments(paths, "PATH",
                    "files and folders within the data folder, such as "
                    "tasks/Walker-v0.yaml [the data folder itself]");
  command.option("--names", names, "KIND",
                 "instead of paths: the names of all tasks, or of the profiles in physics or "
                 "training, one a line");
  command.option("--schema", schema, "NAME",
                 "instead of paths: the JSON Schema of a format whose settings are a table: neat, "
                 "physics, run or training");
  command.example("cp \"$(evo-data tasks/Walker-v0.yaml)\" my-walker.yaml",
                  "a task of your own, from one that is there");
  command.example("evo-data --names tasks", "the tasks that there are, one a line");
  return command.run(argc, argv, [&] {
    if (names) {
      for (const std::string& name : names_of(*names)) fmt::print("{}\n", name);
      return 0;
    }
    if (schema) {
      fmt::print("{}\n", schema_of(*schema).dump(2));
      return 0;
    }
    const fs::path root = cli::data_root();
    if (paths.empty()) fmt::print("{}\n", root.string());
    std::vector<std::string> found;  // all, or nothing
    for (const std::string& path : paths) found.push_back(locate(root, path).string());
    for (const std::string& path : found) fmt::print("{}\n", path);
    return 0;
  });
}
