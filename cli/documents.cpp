#include "cli/documents.h"

#include <filesystem>
#include <functional>
#include <map>

#include "cli/data.h"
#include "cli/terminal.h"
#include "formats/evogym.h"
#include "formats/neat.h"
#include "formats/physics.h"
#include "formats/task.h"
#include "formats/task_text.h"
#include "formats/training.h"
#include "formats/yaml.h"

namespace evo::cli {
namespace {

namespace fs = std::filesystem;

constexpr int shown_rows = 5;  // of the full body whose observation a task lays out
constexpr int shown_cols = 5;

fs::path folder_of(const std::string& name) { return fs::path(name).parent_path(); }

void print_task(const std::string& text, const std::string& name) {
  const TaskSpec task = parse_task(text, name, folder_of(name), data_folders());
  fmt::print("{}", describe_task(task, full_body(shown_rows, shown_cols)));
}

void print_physics(const std::string& text, const std::string& name) {
  const YamlNode node = YamlNode::parse(text, name);
  fmt::print("{}: physics profile, in full\n{}", printable(name),
             physics_to_yaml(physics_from_yaml(node, folder_of(name), data_folders())));
}

void print_training(const std::string& text, const std::string& name) {
  const YamlNode node = YamlNode::parse(text, name);
  fmt::print("{}: training profile, in full\n{}", printable(name),
             training_to_yaml(training_from_yaml(node, folder_of(name), data_folders())));
}

void print_neat_settings(const std::string& text, const std::string& name) {
  const NeatSettings settings = neat_settings_from_yaml(YamlNode::parse(text, name));
  fmt::print("{}: settings of NEAT, {} genomes, {} inputs, {} outputs\n", printable(name),
             settings.pop_size, settings.num_inputs, settings.num_outputs);
}

void print_neat_state(const std::string& text, const std::string& name) {
  const NeatState state = parse_neat_state(text, name);
  fmt::print("{}: state of NEAT, generation {}, {} species\n", printable(name), state.generation,
             state.species.size());
  fmt::print("{:>8} {:>8} {:>8} {:>14}\n", "species", "created", "members", "last improved");
  for (const Species& species : state.species)
    fmt::print("{:>8} {:>8} {:>8} {:>14}\n", species.key, species.created, species.members.size(),
               species.last_improved);
}

void print_world(const std::string& text, const std::string& name) {
  const World world = evogym_world_from_json(parse_json(text, name), name);
  fmt::print("{}: world of the design tool, {} objects\n", printable(name), world.objects.size());
  for (const Object& object : world.objects)
    fmt::print("  {} at [{}, {}], {}x{}, {} voxels\n", printable(object.name), object.x, object.y,
               object.body.rows, object.body.cols, count_voxels(object.body));
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

bool print_document(const std::string& text, const std::string& name) {
  using Print = void (*)(const std::string&, const std::string&);
  static const std::map<std::string, Print> kinds{{"evo/task", print_task},
                                                  {"evo/physics", print_physics},
                                                  {"evo/training", print_training},
                                                  {"evo/neat", print_neat_settings},
                                                  {"evo/neat-state", print_neat_state}};
  const auto kind = kinds.find(format_of(text));
  if (kind != kinds.end()) {
    kind->second(text, name);
    return true;
  }
  if (text.find("\"grid_width\"") == std::string::npos) return false;
  print_world(text, name);
  return true;
}

}  // namespace evo::cli
