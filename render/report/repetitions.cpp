#include "render/report/repetitions.h"

#include <fmt/format.h>

#include <algorithm>

namespace evo::report {
namespace {

// All settings but the seed, as text.
std::string without_seed(const Run& run) {
  std::string key;
  for (const RunSetting& setting : run.settings)
    if (setting.name != "seed") key += setting.name + "=" + setting.value + "\n";
  return key;
}

// Names the settings that tell a group from the others of the same method.
std::string name_of(const Run& run, const std::vector<Repetitions>& groups) {
  const std::string method = run.method();
  std::string name = method;
  for (const RunSetting& setting : run.settings) {
    const bool differs = std::any_of(groups.begin(), groups.end(), [&](const Repetitions& other) {
      return other.method == method && other.runs[0]->setting(setting.name) != setting.value;
    });
    if (differs && setting.name != "seed")
      name += fmt::format(", {} {}", setting.name, setting.value);
  }
  return name;
}

}  // namespace

std::vector<Repetitions> repetitions(const std::vector<const Run*>& runs) {
  std::vector<Repetitions> groups;
  std::map<std::string, std::size_t> known;
  for (const Run* run : runs) {
    const auto [group, is_new] = known.emplace(without_seed(*run), groups.size());
    if (is_new) groups.push_back({"", run->method(), {}});
    groups[group->second].runs.push_back(run);
  }
  for (Repetitions& group : groups) group.label = name_of(*group.runs[0], groups);
  return groups;
}

}  // namespace evo::report
