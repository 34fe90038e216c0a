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
#include "formats/io/json.h"
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

using Member =
    std::variant<double T::*, int T::*, std::int64_t T::*, bool T::*, std::vector<int> T::*,
                 std::vector<AttemptKind> T::*, Algorithm T::*, Schedule T::*, TimeLimit T::*,
                 Standardize T::*, ActionMap T::*, Exchange T::*, Gating T::*>;

struct Setting {
  const char* key;
  Member member;
  const char* baseline;
  const char* meaning;
  // The paper knows nothing of it: written only where it differs from what is built
  // in, so that profiles without it keep their text.
  bool ours;
  NumberRange range;
};

const std::vector<Setting>& all_settings() {
  using namespace number_range;
  constexpr bool yes = true;
  constexpr bool no = false;
  static const std::vector<Setting> list{
#define SETTING(type, name, initial, baseline, range, paper, meaning) \
  {#name, &T::name, baseline, meaning, !(paper), range},
#include "libevo/control/training_settings.def"
#undef SETTING
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

Json schema_of(const Setting& setting) {
  return std::visit(
      [&](auto member) -> Json {
        using Value = std::remove_reference_t<decltype(std::declval<T&>().*member)>;
        const NumberRange& range = setting.range;
        const auto bounded = [&](Json number) {
          if (std::isfinite(range.least))
            number[range.open ? "exclusiveMinimum" : "minimum"] = range.least;
          if (std::isfinite(range.most)) number["maximum"] = range.most;
          return number;
        };
        if constexpr (std::is_same_v<Value, bool>)
          return {{"type", "boolean"}};
        else if constexpr (IsWord<Value>)
          return {{"enum", Words<Value>::all()}};
        else if constexpr (std::is_arithmetic_v<Value>)
          return bounded({{"$ref", "#/$defs/number"}});
        else if constexpr (IsWord<typename Value::value_type>)
          return {{"type", "array"},
                  {"minItems", 1},
                  {"items", {{"enum", Words<typename Value::value_type>::all()}}}};
        else
          return {{"type", "array"}, {"items", bounded({{"type", "integer"}})}};
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

Json training_schema() {
  Json properties = {{"format", {{"const", format::training.name}}},
                     {"version", {{"const", format::training.version}}}};
  for (const char* text : {"name", "description", "base"}) properties[text] = {{"type", "string"}};
  for (const Setting& setting : all_settings()) {
    Json property = schema_of(setting);
    property["description"] = setting.meaning;
    properties[setting.key] = std::move(property);
  }
  const Json number = {
      {"description", "YAML 1.1 readers take 1e-4 for text"},
      {"anyOf", {{{"type", "number"}}, {{"type", "string"}, {"pattern", "^[-+0-9.eE]+$"}}}}};
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", fmt::format("{} {}", format::training.name, format::training.version)},
          {"type", "object"},
          {"additionalProperties", false},
          {"properties", std::move(properties)},
          {"$defs", {{"number", number}}}};
}

}  // namespace evo
