#include "cli/documents.h"

#include <filesystem>
#include <map>
#include <string_view>

#include "cli/data.h"
#include "formats/io/format.h"
#include "formats/io/node.h"
#include "formats/io/text.h"
#include "formats/io/values.h"
#include "formats/robot/evogym.h"
#include "formats/run/neat.h"
#include "formats/run/neat_ini.h"
#include "formats/run/run.h"
#include "formats/run/settings.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/task/text.h"
#include "formats/training/training.h"

namespace evo::cli {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const std::string& name) { return fs::path(name).parent_path(); }

std::string describe_task_file(const std::string& text, const std::string& name) {
  return describe_task(parse_task(text, name, folder_of(name), data_folders()));
}

std::string describe_physics(const std::string& text, const std::string& name) {
  const Physics physics =
      physics_profiles().read(Node::yaml(text, name), folder_of(name), data_folders());
  return fmt::format("{}: physics profile, in full\n{}", printable(name),
                     physics_profiles().to_yaml(physics));
}

std::string describe_training(const std::string& text, const std::string& name) {
  const TrainingSettings settings =
      training_profiles().read(Node::yaml(text, name), folder_of(name), data_folders());
  return fmt::format("{}: training profile, in full\n{}", printable(name),
                     training_profiles().to_yaml(settings));
}

std::string describe_neat_settings(const std::string& text, const std::string& name) {
  const NeatSettings settings = parse_neat_settings(text, name);
  return fmt::format("{}: settings of NEAT, {} genomes, {} inputs, {} outputs\n", printable(name),
                     settings.pop_size, settings.num_inputs, settings.num_outputs);
}

std::string describe_neat_state(const std::string& text, const std::string& name) {
  const NeatState state = parse_neat_state(text, name);
  std::string told = fmt::format(
      "{}: state of NEAT, generation {}, {} species\n{:>8} {:>8} {:>8} {:>14}\n", printable(name),
      state.generation, state.species.size(), "species", "created", "members", "last improved");
  for (const Species& species : state.species)
    told += fmt::format("{:>8} {:>8} {:>8} {:>14}\n", species.key, species.created,
                        species.members.size(), species.last_improved);
  return told;
}

std::string describe_run(const std::string& text, const std::string& name) {
  const RunSettings settings = RunSettings::parse(text, name);
  std::string told = fmt::format("{}: settings of a run\n", printable(name));
  for (const RunSetting& setting : settings.list())
    told += fmt::format("{:<16} {}\n", setting.name, printable(setting.value));
  return told;
}

std::string describe_world(const std::string& text, const std::string& name) {
  const World world = read_evogym_world(Node::json(text, name));
  std::string told = fmt::format("{}: world of the design tool, {} objects\n", printable(name),
                                 world.objects.size());
  for (const Object& object : world.objects)
    told += fmt::format("  {} at [{}, {}], {}x{}, {} voxels\n", printable(object.name), object.x,
                        object.y, object.body.rows, object.body.cols, count_voxels(object.body));
  return told;
}

// The value of the first key `format`, whether JSON or YAML.
std::string format_of(const std::string& text) {
  constexpr std::string_view blanks = " \t\r\n\"";
  std::size_t at = text.find("format");
  if (at == std::string::npos) return {};
  at = text.find_first_not_of(blanks, at + std::string_view("format").size());
  if (at == std::string::npos || text[at] != ':') return {};
  at = text.find_first_not_of(blanks, at + 1);
  if (at == std::string::npos) return {};
  return text.substr(at, text.find_first_of(" \t\r\n\",}#", at) - at);
}

}  // namespace

std::string describe_task(const TaskSpec& task) {
  const RunSettingInfo& info = *find_run_setting("shape");
  const auto [rows, cols] =
      parse_shape(initial_value(info, "ga", [&](const std::string&) { return task.name; }));
  return describe_task(task, full_body(rows, cols));
}

std::optional<Document> describe_document(const std::string& text, const std::string& name) {
  using Describe = std::string (*)(const std::string& text, const std::string& name);
  static const std::map<std::string, Describe> kinds{
      {format::task.name, describe_task_file},        {format::physics.name, describe_physics},
      {format::training.name, describe_training},     {format::neat.name, describe_neat_settings},
      {format::neat_state.name, describe_neat_state}, {format::run.name, describe_run}};
  auto known = kinds.find(format_of(text));
  if (known == kinds.end() && begins_as_ini(text)) known = kinds.find(format::neat.name);
  if (known != kinds.end()) return Document{known->first, known->second(text, name)};
  if (text.find("\"grid_width\"") == std::string::npos) return std::nullopt;
  return Document{"world of the design tool", describe_world(text, name)};
}

}  // namespace evo::cli
