#include "formats/training/training.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include "formats/io/format.h"
#include "libevo/base/words.h"

namespace evo {
namespace {

using T = TrainingSettings;

// ---- values and their words -----------------------------------------------------

// Types of which a value is one of a few words.
template <typename Value>
struct Words {};
template <Worded Value>
struct Words<Value> {
  static std::vector<std::string> all() { return words_of<Value>(); }
  static std::optional<Value> parse(std::string_view text) { return from_word<Value>(text); }
  static std::string of(Value value) { return word(value); }
};
template <>
struct Words<bool> {
  static std::vector<std::string> all() { return {"false", "true"}; }
  static std::optional<bool> parse(std::string_view text) {
    if (text != "false" && text != "true") return std::nullopt;
    return text == "true";
  }
  static std::string of(bool value) { return value ? "true" : "false"; }
};
template <>
struct Words<Algorithm> {
  static std::vector<std::string> all() { return algorithm_names(); }
  static std::optional<Algorithm> parse(std::string_view text) {
    for (const std::string& name : algorithm_names())
      if (text == name) return Algorithm(name);
    return std::nullopt;
  }
  static std::string of(const Algorithm& value) { return value.name(); }
};

template <typename Value>
concept IsWord = requires {
  Words<Value>::all();
};

// What a value must look like, for messages.
template <typename Value>
std::string expectation() {
  if constexpr (IsWord<Value>) {
    return fmt::format("one of {}", fmt::join(Words<Value>::all(), ", "));
  } else if constexpr (std::is_same_v<Value, double>) {
    return "a number";
  } else if constexpr (std::is_integral_v<Value>) {
    return "a whole number";
  } else if constexpr (IsWord<typename Value::value_type>) {
    return fmt::format("a list of {}", fmt::join(Words<typename Value::value_type>::all(), ", "));
  } else {
    return "a list of whole numbers, as in [64, 64],";
  }
}

template <typename Value>
std::optional<Value> parse(std::string_view text) {
  if constexpr (IsWord<Value>) {
    return Words<Value>::parse(text);
  } else if constexpr (std::is_same_v<Value, double>) {
    return parse_number(text);
  } else if constexpr (std::is_integral_v<Value>) {
    Value value{};
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
  } else {
    // "64,64", in brackets or not, or nothing at all.
    if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
    Value values;
    while (!text.empty()) {
      const std::size_t comma = std::min(text.find(','), text.size());
      std::string_view item = text.substr(0, comma);
      item.remove_prefix(std::min(item.find_first_not_of(' '), item.size()));
      const auto value = parse<typename Value::value_type>(item);
      if (!value) return std::nullopt;
      values.push_back(*value);
      text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return values;
  }
}

template <typename Value>
std::string to_text(const Value& value) {
  if constexpr (IsWord<Value>) {
    return Words<Value>::of(value);
  } else if constexpr (std::is_arithmetic_v<Value>) {
    return fmt::format("{}", value);
  } else {
    std::vector<std::string> items;
    items.reserve(value.size());
    for (const auto& item : value) items.push_back(to_text(item));
    return fmt::format("[{}]", fmt::join(items, ", "));
  }
}

// ---- the settings, by name --------------------------------------------------------

using Member = std::variant<double T::*, int T::*, std::int64_t T::*, bool T::*,
                            std::vector<int> T::*, std::vector<AttemptKind> T::*, Algorithm T::*,
                            Schedule T::*, TimeLimit T::*, Standardize T::*, ActionMap T::*>;

struct Setting {
  const char* key;
  Member member;
  // What no line of an identity means (formats/training/identity.h): frozen for ever,
  // whatever becomes of the default. A new setting's is what leaves trainings as
  // they were.
  const char* baseline;
  const char* meaning;
  // The paper knows nothing of it: written only where it differs from what is built
  // in, so that profiles without it keep their text.
  bool ours = false;
};

// In the order of libevo/control/settings.h. All that is said and written of the
// settings comes from here; what they may be is checked there.
const std::vector<Setting>& all_settings() {
  static const std::vector<Setting> list{
      {"algorithm", &T::algorithm, "ppo", "network: ppo; open loop: gait, sequence, sine, random"},
      {"steps", &T::steps, "512000", "environment steps in all"},
      {"environments", &T::environments, "4", "episodes side by side"},
      {"rollout", &T::rollout, "128", "steps of each environment between updates"},
      {"epochs", &T::epochs, "4", "passes over a rollout"},
      {"minibatches", &T::minibatches, "4", "of each pass"},
      {"gamma", &T::gamma, "0.99", "discount"},
      {"lambda", &T::lambda, "0.95", "of generalised advantage estimation"},
      {"clip", &T::clip, "0.1", "range of the probability ratio about 1"},
      {"clip_value_loss", &T::clip_value_loss, "true",
       "keep values within `clip` of the old ones, too"},
      {"value_coefficient", &T::value_coefficient, "0.5", "weight of half the squared value error"},
      {"entropy_coefficient", &T::entropy_coefficient, "0.01", "weight of the entropy bonus"},
      {"entropy_schedule", &T::entropy_schedule, "constant",
       "constant; linear: to 0 at the last update"},
      {"max_gradient_norm", &T::max_gradient_norm, "0.5",
       "of all parameters together; 0: no limit"},
      {"standardize_advantages", &T::standardize_advantages, "batch", "none, batch or minibatch"},
      {"time_limit", &T::time_limit, "end", "end: ends the episode; bootstrap: its value goes on"},
      {"learning_rate", &T::learning_rate, "0.00025", "of Adam"},
      {"learning_rate_schedule", &T::learning_rate_schedule, "linear", "constant; linear: to 0"},
      {"learning_rate_horizon", &T::learning_rate_horizon, "19531",
       "updates until 0; 0: the training's"},
      {"adam_epsilon", &T::adam_epsilon, "1e-05", "added to the root of the second moment"},
      {"hidden", &T::hidden, "[64, 64]", "widths of the tanh layers, actor and critic each"},
      {"head_gain", &T::head_gain, "1", "of the initial layer of action means"},
      {"initial_log_std", &T::initial_log_std, "0",
       "log standard deviation of actions at the start"},
      {"action_map", &T::action_map, "offset", "offset: clip(offset + a); squash: tanh(a), scaled"},
      {"action_offset", &T::action_offset, "1", "actuator target at action 0 (map offset)"},
      {"clock", &T::clock, "[]", "periods, control steps, whose phases networks see", true},
      {"noise_correlation", &T::noise_correlation, "0", "of one step's exploration with the next",
       true},
      {"failure_weight", &T::failure_weight, "1", "of what a bad end costs, for the learner", true},
      {"gait_log_std", &T::gait_log_std, "-1.2", "initial_log_std of actions added to a gait",
       true},
      {"inherited_log_std", &T::inherited_log_std, "-1", "initial_log_std of an inherited policy",
       true},
      {"start_jitter", &T::start_jitter, "0", "of start coordinates in training, voxels (ppo)",
       true},
      {"moment_share", &T::moment_share, "0",
       "of episodes: begin at a moment of the inherited controller's (ppo)", true},
      {"moment_jitter", &T::moment_jitter, "0.01", "of coordinates at a moment, voxels (ppo)",
       true},
      {"normalize_observations", &T::normalize_observations, "true",
       "by running mean and deviation"},
      {"normalize_rewards", &T::normalize_rewards, "true",
       "by the deviation of discounted returns"},
      {"observation_clip", &T::observation_clip, "10", "of normalised observations"},
      {"reward_clip", &T::reward_clip, "10", "of normalised rewards"},
      {"evaluation_interval", &T::evaluation_interval, "50", "updates; one more after the last"},
      {"evaluation_episodes", &T::evaluation_episodes, "1", "of the deterministic controller"},
      {"evaluation_jitter", &T::evaluation_jitter, "0", "of their start coordinates, voxels", true},
      {"final_episodes", &T::final_episodes, "8", "of the best controller, jittered; 0: none"},
      {"final_jitter", &T::final_jitter, "0.0001", "of start coordinates, voxels"},
      {"population", &T::population, "16", "candidates of a generation (sine, random)"},
      {"initial_sigma", &T::initial_sigma, "0.5", "step size at the start (sine)"},
      {"shortest_period", &T::shortest_period, "8", "of waves, control steps (sine, random)"},
      {"longest_period", &T::longest_period, "100", "of waves, control steps (sine, random)"},
      {"wave_share", &T::wave_share, "0.33", "of the search: waves over the whole body (gait)",
       true},
      {"actuator_sigma", &T::actuator_sigma, "0.15",
       "step size of each actuator's own search (gait)", true},
      {"gait_share", &T::gait_share, "0.2", "of the steps: a search for a gait first (sequence)",
       true},
      {"attempts", &T::attempts, "[go_on, begin, change, borrow, repeat, push, hold]",
       "what exploration tries, drawn alike (sequence)", true},
      {"time_share", &T::time_share, "0.5", "of attempts: from the best of a time (sequence)",
       true},
      {"rest_share", &T::rest_share, "0.03", "of attempts: once more after a rest (sequence)",
       true},
  };
  return list;
}

const Setting* find_setting(std::string_view key) {
  for (const Setting& setting : all_settings())
    if (key == setting.key) return &setting;
  return nullptr;
}

// " (did you mean 'ppo'?)"
template <typename Value>
std::string word_meant(std::string_view text) {
  if constexpr (IsWord<Value>)
    return did_you_mean(std::string(text), Words<Value>::all());
  else
    return "";
}

// What other programs call a setting, and what it is called here.
std::string key_meant(const std::string& key) {
  static const std::map<std::string, std::string> elsewhere{
      {"algo", "algorithm"},
      {"clip_coef", "clip"},
      {"clip_range", "clip"},
      {"ent_coef", "entropy_coefficient"},
      {"gae_lambda", "lambda"},
      {"hidden_size", "hidden"},
      {"lr", "learning_rate"},
      {"max_grad_norm", "max_gradient_norm"},
      {"n_envs", "environments"},
      {"n_epochs", "epochs"},
      {"n_steps", "rollout"},
      {"net_arch", "hidden"},
      {"norm_adv", "standardize_advantages"},
      {"num_envs", "environments"},
      {"num_mini_batch", "minibatches"},
      {"num_minibatches", "minibatches"},
      {"num_steps", "rollout"},
      {"ppo_epoch", "epochs"},
      {"total_timesteps", "steps"},
      {"update_epochs", "epochs"},
      {"vf_coef", "value_coefficient"},
  };
  const auto found = elsewhere.find(key);
  return found == elsewhere.end() ? key : found->second;
}

// Reads `text` into the setting; returns what was expected instead, or "".
std::string assign(T& settings, const Setting& setting, std::string_view text) {
  return std::visit(
      [&](auto member) -> std::string {
        using Value = std::remove_reference_t<decltype(settings.*member)>;
        const std::optional<Value> value = parse<Value>(text);
        if (!value)
          return fmt::format("{} is expected for '{}', found '{}'{}", expectation<Value>(),
                             setting.key, text, word_meant<Value>(text));
        settings.*member = *value;
        return "";
      },
      setting.member);
}

std::string value_text(const T& settings, const Setting& setting) {
  return std::visit([&](auto member) { return to_text(settings.*member); }, setting.member);
}

bool is_list(const Setting& setting) {
  return std::visit(
      [](auto member) {
        using Value = std::remove_reference_t<decltype(std::declval<T&>().*member)>;
        return !IsWord<Value> && !std::is_arithmetic_v<Value>;
      },
      setting.member);
}

// What a value looks like, in a table.
std::string kind_of(const Setting& setting) {
  return std::visit(
      [](auto member) -> std::string {
        using Value = std::remove_reference_t<decltype(std::declval<T&>().*member)>;
        if constexpr (IsWord<Value>)
          return fmt::format("{}", fmt::join(Words<Value>::all(), "|"));
        else if constexpr (std::is_same_v<Value, double>)
          return "number";
        else if constexpr (std::is_integral_v<Value>)
          return "whole";
        else
          return "list";
      },
      setting.member);
}

// ---- reading ------------------------------------------------------------------------

// A scalar as written, a list as "1,2,3".
std::string flat_text(const Setting& setting, const YamlNode& node) {
  if (node.is_scalar()) return node.string();
  if (!node.is_sequence() || !is_list(setting))
    throw node.error(
        fmt::format("a value is expected for '{}', found {}", setting.key, node.found()));
  std::vector<std::string> items;
  for (const YamlNode& item : node.items()) items.push_back(item.string());
  return fmt::format("{}", fmt::join(items, ","));
}

void read_settings(T& settings, const YamlMapping& profile) {
  for (const Setting& setting : all_settings()) {
    const auto value = profile.find(setting.key);
    if (!value) continue;
    const std::string problem = assign(settings, setting, flat_text(setting, *value));
    if (!problem.empty()) throw value->error(problem);
  }
  try {
    check(settings);
  } catch (const Error& failure) {
    throw profile.node().error(failure.what());
  }
}

const ProfileKind<T>& training_kind() {
  static const ProfileKind<T> kind{"training profile", format::training, "training", "paper",
                                   training_keys(),    read_settings};
  return kind;
}

}  // namespace

TrainingSettings load_training(const std::string& name_or_file, const DataFolders& folders) {
  return load_profile(training_kind(), name_or_file, "", folders);
}

TrainingSettings training_from_yaml(const YamlNode& node, const std::filesystem::path& folder,
                                    const DataFolders& folders) {
  return read_profile(training_kind(), node, folder, folders);
}

void apply_override(TrainingSettings& settings, std::string_view assignment) {
  const auto [key, value] = split_assignment(assignment, "gamma=0.995");
  const Setting* setting = find_setting(key);
  if (setting == nullptr)
    throw error(Failure::usage, "unknown training setting '{}'{}; allowed: {}", key,
                did_you_mean(key_meant(key), training_keys()), fmt::join(training_keys(), ", "));
  const std::string problem = assign(settings, *setting, value);
  if (!problem.empty()) throw Error(Failure::usage, problem);
}

std::string training_to_yaml(const TrainingSettings& settings) {
  std::string text = "format: evo/training\nversion: 1\n";
  for (const Setting& setting : all_settings()) {
    const std::string value = value_text(settings, setting);
    if (setting.ours && value == value_text(T{}, setting)) continue;
    text += fmt::format("{}: {}  # {}\n", setting.key, value, setting.meaning);
  }
  return text;
}

std::vector<std::string> training_keys() {
  std::vector<std::string> keys;
  for (const Setting& setting : all_settings()) keys.emplace_back(setting.key);
  return keys;
}

std::vector<SettingRow> training_table(const TrainingSettings& settings) {
  std::vector<SettingRow> rows;
  for (const Setting& setting : all_settings())
    rows.push_back(
        {setting.key, value_text(settings, setting), kind_of(setting), "", setting.meaning});
  return rows;
}

std::vector<std::string> training_identity(const TrainingSettings& settings) {
  std::vector<std::string> lines;
  for (const Setting& setting : all_settings())
    if (const std::string value = value_text(settings, setting); value != setting.baseline)
      lines.push_back(fmt::format("training.{}={}", setting.key, value));
  return lines;
}

}  // namespace evo
