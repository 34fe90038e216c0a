#include "formats/training.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include "formats/files.h"

namespace evo {
namespace {

using T = TrainingSettings;

// ---- values and their words -----------------------------------------------------

template <typename Enum>
struct Words;
template <>
struct Words<Algorithm> {
  static constexpr std::array<const char*, 3> list{"ppo", "sine", "random"};
};
template <>
struct Words<Schedule> {
  static constexpr std::array<const char*, 2> list{"constant", "linear"};
};
template <>
struct Words<TimeLimit> {
  static constexpr std::array<const char*, 2> list{"end", "bootstrap"};
};
template <>
struct Words<Standardize> {
  static constexpr std::array<const char*, 3> list{"none", "batch", "minibatch"};
};
template <>
struct Words<ActionMap> {
  static constexpr std::array<const char*, 2> list{"offset", "squash"};
};
template <>
struct Words<bool> {
  static constexpr std::array<const char*, 2> list{"false", "true"};
};

template <typename V>
constexpr bool is_word = std::is_enum_v<V> || std::is_same_v<V, bool>;

// What a value must look like, for messages.
template <typename V>
std::string expectation() {
  if constexpr (is_word<V>) {
    return fmt::format("one of {}", fmt::join(Words<V>::list, ", "));
  } else if constexpr (std::is_same_v<V, double>) {
    return "a number";
  } else if constexpr (std::is_integral_v<V>) {
    return "a whole number";
  } else {
    return "a list of whole numbers, as in [64, 64],";
  }
}

template <typename V>
std::optional<V> parse(std::string_view text) {
  if constexpr (is_word<V>) {
    for (std::size_t i = 0; i < Words<V>::list.size(); ++i)
      if (text == Words<V>::list[i]) return static_cast<V>(i);
    return std::nullopt;
  } else if constexpr (std::is_same_v<V, double>) {
    return parse_number(text);
  } else if constexpr (std::is_integral_v<V>) {
    V value{};
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
  } else {
    // "64,64", in brackets or not, or nothing at all.
    if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
    V values;
    while (!text.empty()) {
      const std::size_t comma = std::min(text.find(','), text.size());
      std::string_view item = text.substr(0, comma);
      item.remove_prefix(std::min(item.find_first_not_of(' '), item.size()));
      const auto value = parse<typename V::value_type>(item);
      if (!value) return std::nullopt;
      values.push_back(*value);
      text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return values;
  }
}

template <typename V>
std::string to_text(const V& value) {
  if constexpr (is_word<V>) {
    return Words<V>::list[static_cast<std::size_t>(value)];
  } else if constexpr (std::is_arithmetic_v<V>) {
    return fmt::format("{}", value);
  } else {
    return fmt::format("[{}]", fmt::join(value, ", "));
  }
}

// ---- the settings, by name --------------------------------------------------------

using Member =
    std::variant<double T::*, int T::*, std::int64_t T::*, bool T::*, std::vector<int> T::*,
                 Algorithm T::*, Schedule T::*, TimeLimit T::*, Standardize T::*, ActionMap T::*>;

struct Setting {
  const char* key;
  Member member;
  const char* meaning;
};

// In the order of libevo/control/settings.h.
const std::vector<Setting>& all_settings() {
  static const std::vector<Setting> list{
      {"algorithm", &T::algorithm, "ppo; sine: open-loop waves, optimised; random: drawn"},
      {"steps", &T::steps, "environment steps in all"},
      {"environments", &T::environments, "episodes side by side"},
      {"rollout", &T::rollout, "steps of each environment between updates"},
      {"epochs", &T::epochs, "passes over a rollout"},
      {"minibatches", &T::minibatches, "of each pass"},
      {"gamma", &T::gamma, "discount"},
      {"lambda", &T::lambda, "of generalised advantage estimation"},
      {"clip", &T::clip, "range of the probability ratio about 1"},
      {"clip_value_loss", &T::clip_value_loss, "keep values within `clip` of the old ones, too"},
      {"value_coefficient", &T::value_coefficient, "weight of half the squared value error"},
      {"entropy_coefficient", &T::entropy_coefficient, "weight of the entropy bonus"},
      {"entropy_schedule", &T::entropy_schedule, "constant; linear: to 0 at the last update"},
      {"max_gradient_norm", &T::max_gradient_norm, "of all parameters together; 0: no limit"},
      {"standardize_advantages", &T::standardize_advantages, "none, batch or minibatch"},
      {"time_limit", &T::time_limit, "end: ends the episode; bootstrap: its value goes on"},
      {"learning_rate", &T::learning_rate, "of Adam"},
      {"learning_rate_schedule", &T::learning_rate_schedule, "constant; linear: to 0"},
      {"learning_rate_horizon", &T::learning_rate_horizon, "updates until 0; 0: the training's"},
      {"adam_epsilon", &T::adam_epsilon, "added to the root of the second moment"},
      {"hidden", &T::hidden, "widths of the tanh layers, actor and critic each"},
      {"head_gain", &T::head_gain, "of the initial layer of action means"},
      {"initial_log_std", &T::initial_log_std, "log standard deviation of actions at the start"},
      {"action_map", &T::action_map, "offset: clip(offset + a); squash: tanh(a), scaled"},
      {"action_offset", &T::action_offset, "actuator target at action 0 (map offset)"},
      {"normalize_observations", &T::normalize_observations, "by running mean and deviation"},
      {"normalize_rewards", &T::normalize_rewards, "by the deviation of discounted returns"},
      {"observation_clip", &T::observation_clip, "of normalised observations"},
      {"reward_clip", &T::reward_clip, "of normalised rewards"},
      {"evaluation_interval", &T::evaluation_interval, "updates; one more after the last"},
      {"evaluation_episodes", &T::evaluation_episodes, "of the deterministic controller"},
      {"final_episodes", &T::final_episodes, "of the best controller, jittered; 0: none"},
      {"final_jitter", &T::final_jitter, "of start coordinates, voxels"},
      {"population", &T::population, "candidates of a generation (sine, random)"},
      {"initial_sigma", &T::initial_sigma, "step size at the start (sine)"},
      {"shortest_period", &T::shortest_period, "of waves, control steps (sine, random)"},
      {"longest_period", &T::longest_period, "of waves, control steps (sine, random)"},
  };
  return list;
}

const Setting* find_setting(std::string_view key) {
  for (const Setting& setting : all_settings())
    if (key == setting.key) return &setting;
  return nullptr;
}

// Reads `text` into the setting; returns what was expected instead, or "".
std::string assign(T& settings, const Setting& setting, std::string_view text) {
  return std::visit(
      [&](auto member) -> std::string {
        using V = std::remove_reference_t<decltype(settings.*member)>;
        const std::optional<V> value = parse<V>(text);
        if (!value)
          return fmt::format("{} is expected for '{}', found '{}'", expectation<V>(), setting.key,
                             text);
        settings.*member = *value;
        return "";
      },
      setting.member);
}

std::string value_text(const T& settings, const Setting& setting) {
  return std::visit([&](auto member) { return to_text(settings.*member); }, setting.member);
}

// ---- reading ------------------------------------------------------------------------

constexpr const char* default_base = "paper";
constexpr const char* subfolder = "training";
constexpr int longest_chain = 16;  // of profiles that start from one another

// A scalar as written, a list as "1,2,3".
std::string flat_text(const Setting& setting, const YamlNode& node) {
  if (node.is_scalar()) return node.string();
  if (!node.is_sequence() || !std::holds_alternative<std::vector<int> T::*>(setting.member))
    throw node.error(
        fmt::format("a value is expected for '{}', found {}", setting.key, node.found()));
  std::vector<std::string> items;
  for (const YamlNode& item : node.items()) items.push_back(item.string());
  return fmt::format("{}", fmt::join(items, ","));
}

T load(const std::string& name_or_file, const std::filesystem::path& folder,
       const DataFolders& folders, int depth);

T read_profile(const YamlNode& node, const std::filesystem::path& folder,
               const DataFolders& folders, int depth) {
  std::vector<std::string> allowed{"format", "version", "name", "description", "base"};
  for (const std::string& key : training_keys()) allowed.push_back(key);
  const YamlMapping profile(node, "training profile", allowed);
  check_format(profile, "evo/training", 1);

  T settings;
  const auto base = profile.find("base");
  if (base && depth >= longest_chain)
    throw base->error("profiles start from one another in a circle");
  try {
    settings = load(base ? base->string() : default_base, folder, folders, depth + 1);
  } catch (const Error& failure) {
    if (!base || failure.kind() == Failure::data) throw;
    throw base->error(failure.what());
  }
  for (const Setting& setting : all_settings()) {
    const auto value = profile.find(setting.key);
    if (!value) continue;
    const std::string problem = assign(settings, setting, flat_text(setting, *value));
    if (!problem.empty()) throw value->error(problem);
  }
  try {
    check(settings);
  } catch (const Error& failure) {
    throw node.error(failure.what());
  }
  return settings;
}

T load_file(const std::filesystem::path& path, const DataFolders& folders, int depth) {
  const YamlNode node = YamlNode::parse(read_file(path, largest_document), path.string());
  return read_profile(node, path.parent_path(), folders, depth);
}

// `paper` itself has no base: its file is complete, or libevo's own values stand
// for it.
T load(const std::string& name_or_file, const std::filesystem::path& folder,
       const DataFolders& folders, int depth) {
  if (is_file_name(name_or_file)) return load_file(folder / name_or_file, folders, depth);
  if (const auto path = find_data_file(folders, subfolder, name_or_file))
    // The default base of paper.yaml is not paper.yaml again.
    return load_file(*path, name_or_file == default_base ? DataFolders{} : folders, depth);
  if (name_or_file == default_base) return T{};
  std::vector<std::string> known = data_names(folders, subfolder);
  if (known.empty()) known.emplace_back(default_base);
  throw Error(Failure::usage,
              unknown_name("training profile", name_or_file, known) + ", or a file (NAME.yaml)");
}

}  // namespace

TrainingSettings load_training(const std::string& name_or_file, const DataFolders& folders) {
  return load(name_or_file, "", folders, 0);
}

TrainingSettings training_from_yaml(const YamlNode& node, const std::filesystem::path& folder,
                                    const DataFolders& folders) {
  return read_profile(node, folder, folders, 0);
}

void apply_override(TrainingSettings& settings, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0)
    throw error(Failure::usage, "KEY=VALUE is expected (as in gamma=0.995), found '{}'",
                assignment);
  const std::string key(assignment.substr(0, equals));
  const Setting* setting = find_setting(key);
  if (setting == nullptr)
    throw Error(Failure::usage, unknown_name("training setting", key, training_keys()));
  const std::string problem = assign(settings, *setting, assignment.substr(equals + 1));
  if (!problem.empty()) throw Error(Failure::usage, problem);
}

std::string training_to_yaml(const TrainingSettings& settings) {
  std::string text = "format: evo/training\nversion: 1\n";
  for (const Setting& setting : all_settings())
    text +=
        fmt::format("{}: {}  # {}\n", setting.key, value_text(settings, setting), setting.meaning);
  return text;
}

std::vector<std::string> training_keys() {
  std::vector<std::string> keys;
  for (const Setting& setting : all_settings()) keys.emplace_back(setting.key);
  return keys;
}

}  // namespace evo
