#include "formats/training/identity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "formats/io/yaml.h"
#include "formats/task/physics_profile.h"
#include "formats/task/task.h"
#include "formats/training/training.h"
#include "libevo/base/digest.h"

namespace evo {
namespace {

// Keys of a task that are words or pictures, or have lines of their own.
constexpr std::array<std::string_view, 8> without_effect{
    "format", "version", "aliases", "difficulty", "description", "notes", "follow", "physics"};

// What no line means in a task: key without numbers, and value. Frozen for ever.
// A setting that is added to tasks gets an entry with the value that leaves tasks
// as they were.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> task_baseline{{
    {"task.steps", "500"},
    {"task.reward.weight", "1"},
    {"task.folding_reward", "-3"},
    {"task.rules.terminate", "true"},
}};

struct Place {
  std::string key;      // "task.reward.0.weight"
  std::string pattern;  // "task.reward.weight"

  Place operator/(const std::string& name) const {
    return {key + "." + name, pattern + "." + name};
  }
  Place operator/(std::size_t index) const { return {fmt::format("{}.{}", key, index), pattern}; }
};

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', '/');
  return text;
}

void add_lines(const YamlNode& node, const Place& place, std::string& lines) {
  if (node.is_mapping()) {
    for (const auto& [key, value] : node.entries()) add_lines(value, place / key.string(), lines);
  } else if (node.is_sequence()) {
    for (std::size_t i = 0; i < node.items().size(); ++i)
      add_lines(node.items()[i], place / i, lines);
  } else {
    const std::string value = node.is_null() ? "" : one_line(node.string());
    const std::pair<std::string_view, std::string_view> line{place.pattern, value};
    if (std::find(task_baseline.begin(), task_baseline.end(), line) == task_baseline.end())
      lines += fmt::format("{}={}\n", place.key, value);
  }
}

// From the form in which tasks are written, so that whatever is added there is
// part of the identity. The order counts: of objects, draws and terms, too.
std::string task_lines(const std::string& task_yaml) {
  const YamlNode document = YamlNode::parse(task_yaml, "task");
  std::string lines;
  for (const auto& [key, value] : document.entries())
    if (std::find(without_effect.begin(), without_effect.end(), key.string()) ==
        without_effect.end())
      add_lines(value, Place{"task", "task"} / key.string(), lines);
  return lines;
}

std::map<std::string, std::string> by_key(std::string_view lines) {
  std::map<std::string, std::string> values;
  while (!lines.empty()) {
    const std::size_t end = std::min(lines.find('\n'), lines.size());
    const std::string_view line = lines.substr(0, end);
    const std::size_t equals = std::min(line.find('='), line.size());
    values[std::string(line.substr(0, equals))] = line.substr(std::min(equals + 1, line.size()));
    lines.remove_prefix(std::min(end + 1, lines.size()));
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
  result.lines = fmt::format("evo-training 2\nrobot={}\nseed={}\n", identity(robot), seed);
  result.lines += task_lines(task_yaml);
  for (const std::string& line : physics_identity(task.physics)) result.lines += line + "\n";
  for (const std::string& line : training_identity(settings)) result.lines += line + "\n";
  if (!origin.robots.empty()) result.lines += fmt::format("robots={}\n", origin.robots);
  if (!origin.inherited.empty()) result.lines += fmt::format("inherited={}\n", origin.inherited);
  for (std::size_t i = 0; i < origin.moments.size(); ++i)
    result.lines += fmt::format("moments.{}={}\n", i, origin.moments[i]);
  for (std::size_t i = 0; i < origin.parts.size(); ++i)
    result.lines += fmt::format("{}{}={}\n", part_prefix, i, origin.parts[i]);
  return result;
}

std::optional<TrainingSpan> span_of_same(const std::string& there, const std::string& asked) {
  const auto is_part = [](const std::string& key) { return key.rfind(part_prefix, 0) == 0; };
  const auto whole_number = [](const std::string& text) -> std::optional<std::int64_t> {
    std::int64_t value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
  };
  auto one = by_key(there);
  auto other = by_key(asked);
  TrainingSpan span;
  span.steps = TrainingSettings{}.steps;  // the baseline's, which has no line
  if (const auto steps = one.find(steps_key); steps != one.end()) {
    const auto value = whole_number(steps->second);
    if (!value) return std::nullopt;
    span.steps = *value;
  }
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
    return found == values.end() ? "the built-in value" : found->second;
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
