#include "formats/run/setting_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "formats/io/format.h"
#include "formats/io/values.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

// scripts/settings.tsv, by CMake.
constexpr std::string_view table =
#include "run_settings.inc"
    ;

// Unlike split_list, with the empty pieces.
std::vector<std::string> fields_of(std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == separator)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

SettingEntry parse_entry(const std::string& line) {
  const std::vector<std::string> fields = fields_of(line, '\t');
  if (fields.size() != 6) throw error(Failure::work, "settings.tsv: six columns, not '{}'", line);
  SettingEntry entry{fields[0], split_list(fields[1], ' '), fields[2], fields[3], Kept::no,
                     fields[5]};
  for (const auto& [word, kept] : {std::pair{"changed", Kept::changed},
                                   std::pair{"quiet", Kept::quiet}, std::pair{"yes", Kept::yes}})
    if (fields[4] == word) entry.kept = kept;
  return entry;
}

std::vector<SettingEntry> parse_table() {
  std::vector<SettingEntry> entries;
  for (const std::string& line : fields_of(table, '\n'))
    if (!line.empty() && line[0] != '#' && !line.starts_with("name\t"))
      entries.push_back(parse_entry(line));
  return entries;
}

bool is_words(const std::string& type) { return type.find('|') != std::string::npos; }

// A whole number without needless zeros.
bool is_number(const std::string& value) {
  return !value.empty() && value.find_first_not_of("0123456789") == std::string::npos &&
         (value == "0" || value[0] != '0');
}

// "yes, no or all"
std::string either(const std::string& type) {
  const std::vector<std::string> words = split_list(type, '|');
  return fmt::format("{} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

// What stands for a value in help.
std::string value_word(const SettingEntry& entry) {
  if (is_words(entry.type)) return entry.type;
  if (entry.type == "count" || entry.type == "number") return "N";
  if (entry.type == "shape") return "ROWSxCOLS";
  std::string word = entry.type;
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return word;
}

// The default as help has it: "5x7 for task=Lifter-v0; 5x5" as it is, "(STEPS)" without brackets.
std::string shown_default(const SettingEntry& entry) {
  std::string text = entry.initial;
  if (text.starts_with('(')) text = text.substr(1, text.size() - 2);
  return text.empty() ? "" : " [" + text + "]";
}

std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  std::string lines;
  std::size_t column = indent;
  for (const std::string& word : split_list(text, ' ')) {
    if (column + 1 + word.size() > width) {
      lines += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      lines += ' ';
      ++column;
    }
    lines += word;
    column += word.size();
  }
  return lines;
}

Json schema_of(const SettingEntry& entry) {
  if (entry.type == "count") return {{"type", "integer"}, {"minimum", 1}};
  if (entry.type == "number") return {{"type", "integer"}, {"minimum", 0}};
  if (entry.type == "shape") return {{"type", "string"}, {"pattern", "^[1-9][0-9]*x[1-9][0-9]*$"}};
  // YAML 1.1 takes yes and no for truth values.
  if (entry.type == "yes|no|all") return {{"enum", {"yes", "no", "all", true, false}}};
  if (is_words(entry.type)) return {{"enum", split_list(entry.type, '|')}};
  return {{"type", {"string", "number", "boolean", "null"}}};
}

}  // namespace

std::string SettingEntry::variable() const {
  std::string capitals = name;
  std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return capitals;
}

bool SettingEntry::belongs_to(std::string_view pipeline) const {
  return std::any_of(pipelines.begin(), pipelines.end(),
                     [&](const std::string& owner) { return owner == "all" || owner == pipeline; });
}

std::string SettingEntry::value_without(
    const std::function<std::string(const std::string&)>& setting) const {
  if (initial.starts_with('(')) return "";
  const std::size_t end = initial.find("; ");
  if (end == std::string::npos) return initial;
  // "A for task=T|U; B"
  const std::size_t condition = initial.find(" for ");
  const std::size_t equals = initial.find('=', condition);
  const std::string other = initial.substr(condition + 5, equals - condition - 5);
  const std::vector<std::string> values =
      split_list(initial.substr(equals + 1, end - equals - 1), '|');
  const bool holds = std::find(values.begin(), values.end(), setting(other)) != values.end();
  return holds ? initial.substr(0, condition) : initial.substr(end + 2);
}

std::optional<std::string> SettingEntry::defect(const std::string& value) const {
  if (type == "number" && !is_number(value))
    return fmt::format("is a number from 0, not '{}'", value);
  if (type == "count" && (!is_number(value) || value == "0"))
    return fmt::format("is a number from 1, not '{}'", value);
  if (is_words(type)) {
    const std::vector<std::string> words = split_list(type, '|');
    if (std::find(words.begin(), words.end(), value) == words.end())
      return fmt::format("is {}, not '{}'", either(type), value);
  }
  return std::nullopt;
}

const std::vector<SettingEntry>& setting_table() {
  static const std::vector<SettingEntry> entries = parse_table();
  return entries;
}

const SettingEntry* find_setting_entry(std::string_view name) {
  for (const SettingEntry& entry : setting_table())
    if (entry.name == name) return &entry;
  return nullptr;
}

std::string present_name(const std::string& name) {
  if (name == "population") return "pop";
  if (name == "evaluations") return "evals";
  return name;
}

std::string settings_help(std::string_view pipeline) {
  constexpr std::size_t indent = 26;
  constexpr std::size_t width = 80;
  std::string text;
  for (const SettingEntry& entry : setting_table()) {
    if (!pipeline.empty() && !entry.belongs_to(pipeline)) continue;
    const std::string head = entry.variable() + "=" + value_word(entry);
    std::string help = entry.help + shown_default(entry);
    if (pipeline.empty() && entry.pipelines[0] != "all")
      help = fmt::format("{}: {}", fmt::join(entry.pipelines, ", "), help);
    text += head.size() + 2 > indent ? head + "\n" + std::string(indent, ' ')
                                     : head + std::string(indent - head.size(), ' ');
    text += wrapped(help, indent, width) + "\n";
  }
  return text;
}

Json run_schema() {
  Json properties = {{"format", {{"const", format::run.name}}},
                     {"version", {{"const", format::run.version}}},
                     {"method", {{"type", "string"}}}};
  for (const SettingEntry& entry : setting_table()) {
    if (entry.kept == Kept::no) continue;
    Json property = schema_of(entry);
    property["description"] = entry.help;
    properties[entry.name] = std::move(property);
  }
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", fmt::format("{} {}", format::run.name, format::run.version)},
          {"type", "object"},
          {"required", {"format", "version"}},
          {"propertyNames", {{"pattern", "^[a-z0-9_]+$"}}},
          {"properties", std::move(properties)},
          {"additionalProperties", {{"type", {"string", "number", "boolean", "null"}}}}};
}

}  // namespace evo
