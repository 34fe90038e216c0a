#include "formats/training/identity.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>

#include "formats/io/node.h"
#include "formats/io/values.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/training/training.h"
#include "libevo/base/digest.h"

namespace evo {
namespace {

// Keys of a task that are words or pictures, or have lines of their own.
constexpr std::array<std::string_view, 8> without_effect{
    "format", "version", "aliases", "difficulty", "description", "notes", "follow", "physics"};

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', '/');
  return text;
}

void add_lines(const Node& node, const std::string& key, std::string& lines) {
  if (node.is_mapping()) {
    for (const auto& [name, value] : node.entries())
      add_lines(value, fmt::format("{}.{}", key, name.string()), lines);
  } else if (node.is_sequence()) {
    int number = 0;
    for (const Node& item : node.items())
      add_lines(item, fmt::format("{}.{}", key, number++), lines);
  } else {
    lines += fmt::format("{}={}\n", key, node.is_null() ? "" : one_line(node.string()));
  }
}

// From the form in which tasks are written, so that whatever is added there is
// part of the identity. The order counts: of objects, draws and terms, too.
std::string task_lines(const std::string& task_yaml) {
  const Node document = Node::yaml(task_yaml, "task");
  std::string lines;
  for (const auto& [key, value] : document.entries())
    if (std::find(without_effect.begin(), without_effect.end(), key.string()) ==
        without_effect.end())
      add_lines(value, "task." + key.string(), lines);
  return lines;
}

std::map<std::string, std::string> by_key(const std::string& lines) {
  std::map<std::string, std::string> values;
  for (const std::string& line : split_list(lines, '\n')) {
    const std::size_t equals = std::min(line.find('='), line.size());
    values[line.substr(0, equals)] = line.substr(std::min(equals + 1, line.size()));
  }
  return values;
}

const std::string steps_key = "training.steps";
const std::string part_prefix = "part.";

}  // namespace

std::string TrainingIdentity::hash() const { return sha256_hex(lines); }

TrainingIdentity identify(const Body& robot, const TaskSpec& task, const TrainingSettings& settings,
                          std::uint64_t seed, const TrainingOrigin& origin) {
  const std::string task_yaml = task_to_yaml(task);
  TrainingIdentity result;
  result.lines = fmt::format("evo-training 3\nrobot={}\nseed={}\n", identity(robot), seed);
  result.lines += task_lines(task_yaml);
  for (const std::string& line : physics_profiles().identity(task.physics))
    result.lines += line + "\n";
  for (const std::string& line : training_profiles().identity(settings))
    result.lines += line + "\n";
  if (!origin.robots.empty()) result.lines += fmt::format("robots={}\n", origin.robots);
  if (!origin.inherited.empty()) result.lines += fmt::format("inherited={}\n", origin.inherited);
  for (std::size_t i = 0; i < origin.parts.size(); ++i)
    result.lines += fmt::format("{}{}={}\n", part_prefix, i, origin.parts[i]);
  return result;
}

std::optional<TrainingSpan> span_of_same(const std::string& there, const std::string& asked) {
  const auto is_part = [](const std::string& key) { return key.rfind(part_prefix, 0) == 0; };
  auto one = by_key(there);
  auto other = by_key(asked);
  TrainingSpan span;
  const auto steps = whole_number(one[steps_key]);
  if (!steps) return std::nullopt;
  span.steps = *steps;
  for (std::size_t i = 0; one.count(part_prefix + std::to_string(i)) != 0; ++i) {
    const auto value = whole_number(one[part_prefix + std::to_string(i)]);
    if (!value) return std::nullopt;
    span.parts.push_back(*value);
  }
  for (auto* values : {&one, &other}) {
    values->erase(steps_key);
    for (auto it = values->begin(); it != values->end();)
      it = is_part(it->first) ? values->erase(it) : std::next(it);
  }
  if (one != other) return std::nullopt;
  return span;
}

std::string difference(const std::string& there, const std::string& asked) {
  constexpr int most_shown = 3;
  const auto one = by_key(there);
  const auto other = by_key(asked);
  auto keys = one;
  keys.insert(other.begin(), other.end());
  std::string text;
  int count = 0;
  const auto shown = [](const std::map<std::string, std::string>& values, const std::string& key) {
    const auto found = values.find(key);
    return found == values.end() ? "nothing" : found->second;
  };
  for (const auto& [key, any] : keys) {
    const std::string left = shown(one, key);
    const std::string right = shown(other, key);
    if (left == right) continue;
    if (++count <= most_shown)
      text +=
          fmt::format("{}{}: {} there, {} asked for", text.empty() ? "" : "; ", key, left, right);
  }
  if (count > most_shown) text += fmt::format("; {} more", count - most_shown);
  return text;
}

}  // namespace evo
