#include "evolution/run_command.h"

#include <fmt/format.h>

#include <optional>

#include "formats/run/setting_table.h"

namespace evo {
namespace {

// For make, to which a dollar is "$$".
std::string make_word(const std::string& value) {
  std::string word;
  for (const char c : shell_word(value)) word += c == '$' ? "$$" : std::string(1, c);
  return word;
}

}  // namespace

std::string shell_word(const std::string& text) {
  constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./,:=+";
  if (text.find_first_not_of(plain) == std::string::npos) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

std::string run_command(const std::function<std::string(const std::string&)>& setting,
                        const std::vector<std::pair<std::string, std::string>>& variables) {
  const auto changed = [&](const std::string& variable) -> std::optional<std::string> {
    std::optional<std::string> value;
    for (const auto& [name, instead] : variables)
      if (name == variable) value = instead;
    return value;
  };
  std::string line = fmt::format("make -f scripts/{}.mk", setting("method"));
  const auto add = [&](const std::string& variable, const std::string& value) {
    if (!value.empty()) line += fmt::format(" {}={}", variable, make_word(value));
  };
  add("RUN", changed("RUN").value_or(""));
  for (const SettingEntry& entry : setting_table()) {
    if (entry.kept == Kept::no) continue;
    const std::string value = changed(entry.variable()).value_or(setting(entry.name));
    if (entry.kept == Kept::quiet && value == entry.value_without(setting)) continue;
    add(entry.variable(), value);
  }
  return line + " -j8";
}

}  // namespace evo
