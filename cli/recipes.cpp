#include "cli/recipes.h"

#include <algorithm>

#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/node.h"
#include "formats/run/settings.h"

namespace evo::cli {
namespace {

std::vector<RunSetting> round_of(const Node& node) {
  std::vector<std::string> known;
  for (const RunSettingInfo& info : run_settings())
    if (info.belongs_to("ga")) known.push_back(info.name);
  const Mapping mapping(node, "round", known);
  std::vector<RunSetting> round;
  for (const auto& [key, value] : mapping.node().entries()) {
    const std::string text = value.string();
    if (const auto defect = find_run_setting(key.string())->defect(text))
      throw value.error(fmt::format("{} {}", key.string(), *defect));
    round.push_back({key.string(), text});
  }
  return round;
}

// The easier worlds of a task, the easiest first.
std::vector<std::string> easier_worlds(const std::string& task, const DataFolders& folders) {
  std::vector<std::string> found;
  for (const std::string& name : data_names(folders, "easier"))
    if (name.starts_with(task + "-")) found.push_back(name);
  if (found.empty())
    throw error(Failure::usage, "there is no easier world for {} in tasks/easier", task);
  return found;
}

}  // namespace

std::vector<std::vector<RunSetting>> load_recipe(const std::string& name, const std::string& task,
                                                 const DataFolders& folders) {
  std::string file = name;
  if (!is_file_name(name)) {
    const auto found = find_data_file(folders, "recipes", name);
    if (!found)
      throw error(Failure::usage, "{}",
                  unknown_name("recipe", name, data_names(folders, "recipes")));
    file = found->string();
  }
  const Node document = Node::yaml(read_file(file, largest_document), file);
  check_format(document, format::recipe);
  const Mapping mapping(document, "recipe", {"format", "version", "description", "rounds"});
  if (const auto description = mapping.find("description")) (void)description->string();
  std::vector<std::vector<RunSetting>> rounds;
  for (const Node& node : mapping.at("rounds").items()) {
    const std::vector<RunSetting> round = round_of(node);
    const auto easier = std::find_if(round.begin(), round.end(), [](const RunSetting& setting) {
      return setting.name == "task" && setting.value == "easier";
    });
    if (easier == round.end()) {
      rounds.push_back(round);
      continue;
    }
    for (const std::string& world : easier_worlds(task, folders)) {
      rounds.push_back(round);
      rounds.back()[static_cast<std::size_t>(easier - round.begin())].value = world;
    }
  }
  if (rounds.empty()) throw mapping.at("rounds").error("a recipe has a round at least");
  return rounds;
}

}  // namespace evo::cli
