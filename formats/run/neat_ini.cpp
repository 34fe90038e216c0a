#include "formats/run/neat_ini.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <vector>

#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/json.h"
#include "formats/io/text.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

std::string lower(std::string_view text) {
  std::string folded(text);
  std::transform(folded.begin(), folded.end(), folded.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return folded;
}

bool is_comment(std::string_view line) { return line.front() == '#' || line.front() == ';'; }

const std::set<std::string> sections{"NEAT", "DefaultGenome", "DefaultSpeciesSet",
                                     "DefaultStagnation", "DefaultReproduction"};

// What we have no setting for, with the values that change nothing.
const std::map<std::string, std::vector<std::string>> without_effect{
    {"bias_init_type", {"gaussian", "normal"}},
    {"response_init_type", {"gaussian", "normal"}},
    {"weight_init_type", {"gaussian", "normal"}},
    {"enabled_rate_to_true_add", {"0", "0.0"}},
    {"enabled_rate_to_false_add", {"0", "0.0"}},
    {"single_structural_mutation", {"false", "no", "off", "0"}},
    {"structural_mutation_surer", {"default", "false"}}};

// Words of configparser for flags; other settings have none.
std::string flag_or(const std::string& value) {
  static const std::set<std::string> yes{"true", "yes", "on"};
  static const std::set<std::string> no{"false", "no", "off"};
  const std::string folded = lower(value);
  return yes.contains(folded) ? "true" : no.contains(folded) ? "false" : value;
}

const std::set<std::string> flags{"reset_on_extinction", "no_fitness_termination", "feed_forward",
                                  "enabled_default"};

struct Entry {
  std::string key;
  std::string value;
  std::size_t line = 0;
};

// "activation_options: [sigmoid, tanh]"
std::string yaml_of(const Entry& entry, const std::string& where) {
  const std::string place = fmt::format("{}:{}", where, entry.line);
  if (const auto known = without_effect.find(entry.key); known != without_effect.end()) {
    const auto& neutral = known->second;
    if (std::find(neutral.begin(), neutral.end(), lower(entry.value)) == neutral.end())
      throw error(Failure::data, "{}: {} may be {} here, not '{}'", place, entry.key,
                  fmt::join(neutral, " or "), entry.value);
    return "#";
  }
  std::string value = flag_or(entry.value);
  if (flags.contains(entry.key) && (value == "1" || value == "0"))
    value = value == "1" ? "true" : "false";
  const bool is_list = entry.key.ends_with("_options");
  std::vector<std::string> words;
  for (const std::string_view word :
       is_list ? split_words(entry.value) : std::vector<std::string_view>{value})
    words.push_back(compact(Json(word)));
  const auto list = fmt::format("{}", fmt::join(words, ", "));
  return fmt::format("{}: {}", compact(Json(entry.key)), is_list ? "[" + list + "]" : list);
}

}  // namespace

bool begins_as_ini(std::string_view text) {
  for (const std::string_view whole : split(text, "\n")) {
    const std::string_view line = trimmed(whole);
    if (line.empty() || is_comment(line)) continue;
    // A section, of whatever name: the reader says which there are.
    constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_- ";
    return line.front() == '[' && line.size() > 2 &&
           line.find_first_not_of(letters, 1) == line.size() - 1 && line.back() == ']';
  }
  return false;
}

std::string neat_ini_to_yaml(std::string_view text, const std::string& where) {
  std::vector<Entry> entries;
  std::size_t number = 0;
  for (const std::string_view whole : split(text, "\n")) {
    ++number;
    const std::string_view line = trimmed(whole);
    if (line.empty() || is_comment(line)) continue;
    const std::string place = fmt::format("{}:{}", where, number);
    if (line.front() == '[') {
      const std::string name(trimmed(line.substr(1, line.find(']') - 1)));
      if (line.back() != ']' || !sections.contains(name))
        throw error(Failure::data, "{}: '{}' is no section of neat-python; there are: {}", place,
                    line, fmt::join(sections, ", "));
      continue;
    }
    if (whole.front() != line.front() && !entries.empty()) {  // begins with blanks
      entries.back().value += fmt::format(" {}", line);
      continue;
    }
    const std::size_t equals = line.find_first_of("=:");
    if (equals == std::string_view::npos || equals == 0)
      throw error(Failure::data, "{}: expected KEY = VALUE, found '{}'", place, line);
    entries.push_back({lower(trimmed(line.substr(0, equals))),
                       std::string(trimmed(line.substr(equals + 1))), number});
  }
  std::string yaml;
  std::size_t line = 1;
  for (const Entry& entry : entries) {
    for (; line < entry.line; ++line) yaml += '\n';
    yaml += yaml_of(entry, where);
  }
  return yaml + fmt::format("\nformat: {}\nversion: {}\n", format::neat.name, format::neat.version);
}

}  // namespace evo
