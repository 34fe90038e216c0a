#include "formats/io/settings.h"

#include <cmath>

#include "formats/io/number.h"
#include "formats/io/text.h"

namespace evo {
namespace setting {
namespace {

std::string before_dot(const std::string& key) { return key.substr(0, key.find('.')); }

}  // namespace

std::string kind_of_number(const char* noun, const Range& range) {
  if (std::isfinite(range.high)) return fmt::format("{} {}..{}", noun, range.low, range.high);
  if (std::isfinite(range.low))
    return fmt::format("{} {} {}", noun, range.open ? ">" : ">=", range.low);
  return noun;
}

std::string expected_number(const char* noun, const Range& range) {
  if (std::isfinite(range.high))
    return fmt::format("a {} from {} to {}", noun, range.low, range.high);
  if (std::isfinite(range.low))
    return fmt::format("a {} {} {}", noun, range.open ? "above" : "of at least", range.low);
  return fmt::format("a {}", noun);
}

std::optional<double> parse_real(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return finite_number(text);
  const auto over = finite_number(trimmed(text.substr(0, slash)));
  const auto under = finite_number(trimmed(text.substr(slash + 1)));
  if (!over || !under || !std::isfinite(*over / *under)) return std::nullopt;
  return *over / *under;
}

std::vector<std::string_view> items_of(std::string_view list) {
  if (list.starts_with('[') && list.ends_with(']')) list = list.substr(1, list.size() - 2);
  std::vector<std::string_view> items = split(list, ",");
  if (items.back().empty()) items.pop_back();  // of an empty list, or after the last comma
  for (std::string_view& item : items) item = trimmed(item);
  return items;
}

// YAML 1.1 readers take 1e-4 for text.
Json number_schema(const Range& range) {
  Json number = {{"$ref", "#/$defs/number"}};
  if (std::isfinite(range.low)) number[range.open ? "exclusiveMinimum" : "minimum"] = range.low;
  if (std::isfinite(range.high)) number["maximum"] = range.high;
  return number;
}

std::pair<std::string, std::string> split_assignment(std::string_view assignment,
                                                     const std::string& example) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0)
    throw error(Failure::usage, "KEY=VALUE is expected (as in {}), found '{}'", example,
                assignment);
  return {std::string(assignment.substr(0, equals)), std::string(assignment.substr(equals + 1))};
}

std::optional<std::string> flat_text(const Node& node) {
  if (node.is_scalar()) return node.string();
  if (!node.is_sequence()) return std::nullopt;
  std::vector<std::string> items;
  for (const Node& item : node.items()) items.push_back(item.string());
  return fmt::format("[{}]", fmt::join(items, ", "));
}

std::vector<std::string> outer_keys(const std::vector<std::string>& keys) {
  std::vector<std::string> outer;
  for (const std::string& key : keys)
    if (outer.empty() || outer.back() != before_dot(key)) outer.push_back(before_dot(key));
  return outer;
}

std::optional<Node> find(const Mapping& mapping, const std::string& key,
                         const std::vector<std::string>& keys) {
  const std::string group = before_dot(key);
  const auto node = mapping.find(group);
  if (!node || group == key) return node;
  std::vector<std::string> parts;
  for (const std::string& one : keys)
    if (one.starts_with(group + ".")) parts.push_back(one.substr(group.size() + 1));
  return Mapping(*node, group, parts).find(key.substr(group.size() + 1));
}

std::string to_yaml(const std::vector<SettingRow>& rows, const std::string& indent) {
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string group = before_dot(rows[i].key);
    std::string value = rows[i].value;
    if (group != rows[i].key) {
      std::vector<std::string> parts;
      for (;; ++i) {
        parts.push_back(fmt::format("{}: {}", rows[i].key.substr(group.size() + 1), rows[i].value));
        if (i + 1 == rows.size() || before_dot(rows[i + 1].key) != group) break;
      }
      value = fmt::format("{{{}}}", fmt::join(parts, ", "));
    }
    text += fmt::format("{}{}: {}  # {}{}{}\n", indent, group, value, rows[i].unit,
                        rows[i].unit.empty() ? "" : "; ", rows[i].meaning);
  }
  return text;
}

Json schema(const Format& format, Json properties) {
  Json all = {{"format", {{"const", format.name}}}, {"version", {{"const", format.version}}}};
  for (const char* text : {"name", "description", "base"}) all[text] = {{"type", "string"}};
  all.update(properties);
  const Json text = {{"type", "string"}, {"pattern", "^[-+0-9.eE/ ]+$"}};
  const Json number = {{"description", "YAML 1.1 readers take 1e-4 for text"},
                       {"anyOf", {{{"type", "number"}}, text}}};
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", fmt::format("{} {}", format.name, format.version)},
          {"type", "object"},
          {"additionalProperties", false},
          {"properties", std::move(all)},
          {"$defs", {{"number", number}}}};
}

}  // namespace setting

std::vector<std::string> assignments(const std::vector<SettingRow>& rows) {
  std::vector<std::string> beginnings;
  for (const SettingRow& row : rows) beginnings.push_back(row.key + "=");
  return beginnings;
}

}  // namespace evo
