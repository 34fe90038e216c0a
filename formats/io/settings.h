// A table of settings: what there is to say of each, once.
//
//   const SettingTable<Physics> table{{
//       {"gravity", &Physics::gravity, at_least(0), "length/time^2", "downward acceleration"},
//       {"soft.edge", within(&Physics::soft, &SpringStiffness::edge), at_least(0), ..}}};
//
// From it come reading, KEY=VALUE, writing, help, completion, the JSON Schema, and the lines of
// an identity. A key with a dot stands in a mapping of its own: soft: {edge: 1, diagonal: 2}.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/io/format.h"
#include "formats/io/json.h"
#include "formats/io/node.h"
#include "formats/io/values.h"
#include "libevo/base/error.h"
#include "libevo/base/words.h"

namespace evo {

// What a number, or each in a list, may be.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool open = false;  // `low` itself is not in it

  bool contains(double value) const { return value <= high && (open ? value > low : value >= low); }
};
constexpr Range at_least(double low) { return {.low = low}; }
constexpr Range above(double low) { return {.low = low, .open = true}; }
constexpr Range between(double low, double high) { return {.low = low, .high = high}; }
inline constexpr Range a_share = between(0.0, 1.0);

// A setting as people are told of it.
struct SettingRow {
  std::string key;
  std::string value;  // shortest text that gives it back
  std::string kind;   // "number >= 0", "whole 1..9", "list of whole > 0", "a|b"
  std::string unit;   // empty: none
  std::string meaning;
};

// ---- what a value of a type is, in words ------------------------------------------------

namespace setting {

std::string kind_of_number(const char* noun, const Range& range);   // "number >= 0"
std::string expected_number(const char* noun, const Range& range);  // "a number of at least 0"
std::optional<double> parse_real(std::string_view text);            // "0.2", or "3e8/3.5"
std::vector<std::string_view> items_of(std::string_view list);      // "[a, b]" or "a,b"
Json number_schema(const Range& range);

// For every type of value: kind, what is expected, reading, writing and its JSON Schema. More
// types may be added beside their tables.
template <typename T>
struct Value;

// One of a few words: all() lists them, in_words() is that of a value.
template <typename T, typename Own>
struct Word {
  static std::string kind(const Range&) { return fmt::format("{}", fmt::join(Own::all(), "|")); }
  static std::string expected(const Range&) {
    return fmt::format("one of {}", fmt::join(Own::all(), ", "));
  }
  static Json schema(const Range&) { return {{"enum", Own::all()}}; }
};

template <>
struct Value<bool> : Word<bool, Value<bool>> {
  static std::vector<std::string> all() { return {"false", "true"}; }
  static std::optional<bool> parse(std::string_view text, const Range&) {
    if (text != "false" && text != "true") return std::nullopt;
    return text == "true";
  }
  static std::string text(bool value) { return value ? "true" : "false"; }
  static Json schema(const Range&) { return {{"type", "boolean"}}; }
};

template <Worded T>
struct Value<T> : Word<T, Value<T>> {
  static std::vector<std::string> all() { return words_of<T>(); }
  static std::optional<T> parse(std::string_view text, const Range&) { return from_word<T>(text); }
  static std::string text(T value) { return word(value); }
};

template <>
struct Value<double> {
  static std::string kind(const Range& range) { return kind_of_number("number", range); }
  static std::string expected(const Range& range) { return expected_number("number", range); }
  static std::optional<double> parse(std::string_view text, const Range& range) {
    const auto value = parse_real(text);
    return value && range.contains(*value) ? value : std::nullopt;
  }
  static std::string text(double value) { return fmt::format("{}", value); }
  static Json schema(const Range& range) { return number_schema(range); }
};

template <std::signed_integral T>
struct Value<T> {
  static std::string kind(const Range& range) { return kind_of_number("whole", range); }
  static std::string expected(const Range& range) { return expected_number("whole number", range); }
  static std::optional<T> parse(std::string_view text, const Range& range) {
    const auto value = whole_number(text);  // "12", "3M", "5e5"
    if (!value || !range.contains(static_cast<double>(*value)) || !std::in_range<T>(*value))
      return std::nullopt;
    return static_cast<T>(*value);
  }
  static std::string text(T value) { return fmt::format("{}", value); }
  static Json schema(const Range& range) { return number_schema(range); }
};

template <typename T>
struct Value<std::vector<T>> {
  static std::string kind(const Range& range) { return "list of " + Value<T>::kind(range); }
  static std::string expected(const Range& range) {
    return "a list, each " + Value<T>::expected(range) + ",";
  }
  static std::optional<std::vector<T>> parse(std::string_view text, const Range& range) {
    std::vector<T> values;
    for (const std::string_view item : items_of(text)) {
      const auto value = Value<T>::parse(item, range);
      if (!value) return std::nullopt;
      values.push_back(*value);
    }
    return values;
  }
  static std::string text(const std::vector<T>& values) {
    std::vector<std::string> items;
    for (const T& value : values) items.push_back(Value<T>::text(value));
    return fmt::format("[{}]", fmt::join(items, ", "));
  }
  static Json schema(const Range& range) {
    return {{"type", "array"}, {"items", Value<T>::schema(range)}};
  }
};

// " (did you mean 'ppo'?)", of words.
template <typename T>
std::string meant(std::string_view text) {
  if constexpr (requires { Value<T>::all(); })
    return did_you_mean(std::string(text), Value<T>::all());
  else
    return "";
}

// "gravity=50" as key and value. Throws Error(usage), with the example.
std::pair<std::string, std::string> split_assignment(std::string_view assignment,
                                                     const std::string& example);
// A scalar as written, a list as "1,2,3"; nothing for what is neither.
std::optional<std::string> flat_text(const Node& node);
// The keys that may stand in a mapping: of those with a dot what is before it.
std::vector<std::string> outer_keys(const std::vector<std::string>& keys);
// The value at a key, which may have a dot.
std::optional<Node> find(const Mapping& mapping, const std::string& key,
                         const std::vector<std::string>& keys);
// Lines "key: value  # unit; meaning", those of one mapping together.
std::string to_yaml(const std::vector<SettingRow>& rows, const std::string& indent);
// A mapping of `format` with these properties and no others.
Json schema(const Format& format, Json properties);

}  // namespace setting

// How an assignment of each begins: "gravity=".
std::vector<std::string> assignments(const std::vector<SettingRow>& rows);

// A member of a member.
template <typename Settings, typename Part, typename T>
auto within(Part Settings::*part, T Part::*member) {
  return [=](auto& settings) -> auto& { return (settings.*part).*member; };
}

// ---- the table --------------------------------------------------------------------------

template <typename Settings>
struct Setting {
  // `member` gives the value in Settings: a pointer to a member, or a function.
  template <typename Member>
  Setting(std::string name, Member member, Range range, std::string its_unit, std::string means)
      : key(std::move(name)), unit(std::move(its_unit)), meaning(std::move(means)) {
    using T = std::remove_cvref_t<std::invoke_result_t<Member, Settings&>>;
    using V = setting::Value<T>;
    kind = V::kind(range);
    property = V::schema(range);
    assign = [member, range, this_key = key](Settings& s, const std::string& text) {
      const auto value = V::parse(text, range);
      if (!value)
        return fmt::format("{} is expected for '{}', found '{}'{}", V::expected(range), this_key,
                           text, setting::meant<T>(text));
      std::invoke(member, s) = *value;
      return std::string();
    };
    value = [member](const Settings& s) { return V::text(std::invoke(member, s)); };
  }
  // Any number, or a value of another kind.
  template <typename Member>
  Setting(std::string name, Member member, std::string its_unit, std::string means)
      : Setting(std::move(name), member, Range{}, std::move(its_unit), std::move(means)) {}

  std::string key;
  std::string kind;
  std::string unit;  // empty: none
  std::string meaning;
  Json property;  // in a schema
  // Returns what is wrong with the text, or nothing.
  std::function<std::string(Settings&, const std::string&)> assign;
  std::function<std::string(const Settings&)> value;
};

template <typename Settings>
class SettingTable {
 public:
  // `check` throws Error(usage) for settings that make no sense together.
  SettingTable(std::vector<Setting<Settings>> settings, void (*check)(const Settings&))
      : settings_(std::move(settings)), check_(check) {
    for (const Setting<Settings>& one : settings_) keys_.push_back(one.key);
  }

  const std::vector<std::string>& keys() const { return keys_; }
  // Those that a mapping may have.
  std::vector<std::string> outer_keys() const { return setting::outer_keys(keys_); }

  // Takes over what the mapping gives. Throws Error(data).
  void read(Settings& settings, const Mapping& mapping) const {
    for (const Setting<Settings>& one : settings_) {
      const auto node = setting::find(mapping, one.key, keys_);
      if (!node) continue;
      const auto text = setting::flat_text(*node);
      const std::string problem =
          text ? one.assign(settings, *text)
               : fmt::format("a value is expected for '{}', found {}", one.key, node->found());
      if (!problem.empty()) throw node->error(problem);
    }
    try {
      check(settings);
    } catch (const Error& failure) {
      throw mapping.node().error(failure.what());
    }
  }

  // Throws Error(usage) for settings that make no sense together.
  void check(const Settings& settings) const { check_(settings); }

  // "gravity=50"; `what` names a setting in messages. Throws Error(usage). Whether settings make
  // sense together is left to the caller, who may have more to assign.
  void assign(Settings& settings, std::string_view assignment, const char* what) const {
    const auto [key, text] = setting::split_assignment(
        assignment, keys_.front() + "=" + settings_.front().value(settings));
    const auto found = std::find(keys_.begin(), keys_.end(), key);
    if (found == keys_.end()) throw Error(Failure::usage, unknown_name(what, key, keys_));
    const auto index = static_cast<std::size_t>(found - keys_.begin());
    const std::string problem = settings_[index].assign(settings, text);
    if (!problem.empty()) throw Error(Failure::usage, problem);
  }

  std::vector<SettingRow> rows(const Settings& settings) const {
    std::vector<SettingRow> rows;
    for (const Setting<Settings>& one : settings_)
      rows.push_back({one.key, one.value(settings), one.kind, one.unit, one.meaning});
    return rows;
  }

  // "training.gamma=0.99": what decides a result.
  std::vector<std::string> identity(const Settings& settings, const std::string& prefix) const {
    std::vector<std::string> lines;
    for (const Setting<Settings>& one : settings_)
      lines.push_back(fmt::format("{}.{}={}", prefix, one.key, one.value(settings)));
    return lines;
  }

  // For a mapping of these settings.
  Json schema(const Format& format) const {
    Json properties = Json::object();
    for (const Setting<Settings>& one : settings_) {
      Json property = one.property;
      property["description"] = one.meaning;
      const std::size_t dot = one.key.find('.');
      if (dot == std::string::npos) {
        properties[one.key] = std::move(property);
        continue;
      }
      Json& group = properties[one.key.substr(0, dot)];
      group["type"] = "object";
      group["additionalProperties"] = false;
      group["properties"][one.key.substr(dot + 1)] = std::move(property);
    }
    return setting::schema(format, std::move(properties));
  }

 private:
  std::vector<Setting<Settings>> settings_;
  void (*check_)(const Settings&);
  std::vector<std::string> keys_;
};

}  // namespace evo
