#include "formats/run/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "formats/io/format.h"
#include "formats/io/node.h"
#include "formats/io/values.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

using Methods = std::vector<std::string>;

constexpr std::int64_t most_robots = 1'000'000;

std::vector<RunSettingInfo> make_table() {
  const Methods all;
  const Methods sampled{"ga", "map", "random", "race", "modular"};
  const Methods breed{"ga", "map", "race", "modular"};
  const Methods flow{"ga", "bo", "map"};
  const Methods founded{"ga", "modular"};
  const Methods alone{"ga", "neat", "bo", "map", "random", "program"};
  const Methods own{"ga", "neat", "bo", "map", "random", "program", "race"};
  const Methods ga{"ga"};
  const Methods neat{"neat"};
  const Methods map{"map"};
  const Methods race{"race"};
  const Methods modular{"modular"};
  const Methods program{"program"};
  constexpr SettingKind whole = SettingKind::whole;
  constexpr SettingKind text = SettingKind::text;
  constexpr SettingKind words = SettingKind::words;
  return {
      {"task", all, text, "TASK", "Walker-v0",
       "by name or file; or FILE.py:CLASS, a task in Python"},
      {"pop", all, whole, "N", "25", "robots of a generation, or that begin a race", 1,
       most_robots},
      {"evals", all, whole, "N", "250",
       "robots trained in the whole run; neat rounds up to whole populations", 1, most_robots},
      {"steps", all, whole, "N", "512000",
       "environment steps of each training; of a race, of those that end it; of modular, of each "
       "generation"},
      {"founder_steps", alone, whole, "N", "", "environment steps of robots without parents"},
      {"seed", all, whole, "N", "0", "names the random streams of the run", 0},
      {"shape", all, SettingKind::shape, "ROWSxCOLS", "5x5", "size of the bodies, in voxels"},
      {"train", all, text, "PROFILE|KEY=VALUE", "default", "as --train of evo-train"},
      {"physics", all, text, "PROFILE|KEY=VALUE", "", "as --physics of the tools"},
      {"train_options", all, text, "OPTIONS", "", "further options of evo-train"},
      {"inherit", all, words, "no|yes|all", "no",
       "whether a child's training starts from its parent's controller; all: and a founder's from "
       "the one that it has in --founders"},
      {"evaluate", alone, text, "PROGRAM", "",
       "scores robots in the place of training: reads a robot, one line of JSON, and writes it "
       "with its fitness"},
      {"founders", founded, text, "PATH", "",
       "the first generation are the --pop best robots of another run (its folder, or a record's, "
       "or a file of scored robots or of just as many bodies)"},
      {"window", flow, whole, "N", "",
       "no generations: robot k waits for the scores of robots 0 to k-N-1 alone, so that N of them "
       "may be in training, at least as many as there are cores",
       1, most_robots},
      {"neat", neat, text, "FILE", "", "settings of NEAT, as --neat of evo-neat"},
      {"features", map, text, "LIST", "filled:5,actuated:5",
       "axes of the archive, as --features of evo-archive"},
      {"rungs", race, whole, "N", "3",
       "how often a race is decided, its end included: robots begin it with steps / 2^(rungs-1)", 1,
       20},
      {"parents", race, whole, "N", "", "robots that the children of the next race descend from", 1,
       most_robots},
      {"children", modular, whole, "N", "16",
       "robots that are born in each generation, in the place of as many others", 1, most_robots},
      {"grace", modular, whole, "N", "1",
       "selections that a new robot survives, since the controller does not know it yet", 0},
      {"champions", modular, whole, "N", "4",
       "best robots that train alone in the end, each from the controller of all, for half of "
       "--steps",
       0, most_robots},
      {"sample_options", sampled, text, "OPTIONS", "",
       "options of evo-sample for the first robots, such as '--encoding cppn'"},
      {"mutate_options", breed, text, "OPTIONS", "", "options of evo-mutate, such as '--rate 0.2'"},
      {"mutate", ga, text, "PROGRAM", "",
       "what makes the children, given the options of evo-mutate"},
      {"propose", program, text, "PROGRAM", "",
       "what proposes robots: given -n N --seed S --shape RxC, and on standard input all robots "
       "scored so far, at first none; writes N robots, all different"},
      {"name", all, text, "NAME", "", "what reports and tables call the method"},
      {"video", all, words, "mp4|webm|gif", "mp4", "of the best robot's video", 1, 1, "none"},
      {"video_options", all, text, "OPTIONS", "", "options of evo-render for it"},
      {"chunk", own, whole, "N", "1", "robots that one launch trains", 1, most_robots},
      {"tries", all, whole, "N", "3",
       "how often a training may die before its robot counts as failed", 1, 1000},
  };
}

bool contains(const std::vector<std::string>& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

Json schema_of(const RunSettingInfo& info) {
  Json schema;
  if (info.kind == SettingKind::whole)
    schema = {{"type", "integer"}, {"minimum", info.least}, {"maximum", info.most}};
  else if (info.kind == SettingKind::shape)
    schema = {{"type", "string"}, {"pattern", "^[1-9][0-9]*x[1-9][0-9]*$"}};
  else if (info.kind == SettingKind::words)
    schema = {{"enum", info.words()}};
  else
    schema = {{"type", {"string", "number", "boolean"}}};
  if (!info.without.empty()) schema["enum"].push_back(info.without);
  // YAML 1.1 takes yes and no for truth values.
  if (info.name == "inherit") schema["enum"].insert(schema["enum"].end(), {true, false});
  schema["description"] = info.meaning;
  return schema;
}

}  // namespace

std::string RunSettingInfo::option() const {
  std::string text = "--" + name;
  std::replace(text.begin(), text.end(), '_', '-');
  return text;
}

std::string RunSettingInfo::option_without() const { return "--no-" + option().substr(2); }

std::vector<std::string> RunSettingInfo::words() const {
  return kind == SettingKind::words ? split_list(value, '|') : std::vector<std::string>{};
}

bool RunSettingInfo::belongs_to(std::string_view method) const {
  return methods.empty() || contains(methods, method);
}

bool RunSettingInfo::is_of_training() const {
  return contains({"task", "steps", "founder_steps", "train", "physics", "train_options", "inherit",
                   "video", "video_options"},
                  name);
}

std::optional<std::string> RunSettingInfo::defect(const std::string& text) const {
  if (!without.empty() && text == without) return std::nullopt;
  constexpr std::size_t longest = 16384;
  if (text.size() > longest) return fmt::format("is longer than {} bytes", longest);
  if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; }))
    return "has line breaks or control characters";
  if (kind == SettingKind::words && !contains(words(), text))
    return fmt::format("is one of {}, not '{}'", fmt::join(words(), ", "), text);
  if (kind == SettingKind::shape) {
    try {
      parse_shape(text);
    } catch (const Error& e) {
      return fmt::format("is rows x columns, such as 5x5, not '{}'", text);
    }
  }
  if (kind == SettingKind::whole) {
    std::int64_t number = 0;
    const auto end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data(), end, number);
    if (code != std::errc() || stop != end || number < least || number > most ||
        (text[0] == '0' && text.size() > 1))
      return fmt::format("is a whole number from {} to {}, not '{}'", least, most, text);
  }
  return std::nullopt;
}

const std::vector<RunSettingInfo>& run_settings() {
  static const std::vector<RunSettingInfo> table = make_table();
  return table;
}

const RunSettingInfo* find_run_setting(std::string_view name) {
  for (const RunSettingInfo& info : run_settings())
    if (info.name == name) return &info;
  return nullptr;
}

const std::vector<RunMethod>& run_methods() {
  static const std::vector<RunMethod> list{
      {"ga", "genetic algorithm: children of the best, a share that shrinks"},
      {"neat", "CPPN-NEAT: networks that paint bodies, in species"},
      {"bo", "Bayesian optimisation: a Gaussian process proposes bodies"},
      {"map", "MAP-Elites: children of the fittest robot of every kind"},
      {"random", "robots drawn at random, what every method has to beat"},
      {"program", "robots that a program of one's own proposes"},
      {"race", "trainings race: the better half of the robots continues"},
      {"modular", "one controller learns on all bodies while they evolve"}};
  return list;
}

void check_run_method(const std::string& name) {
  std::vector<std::string> names;
  for (const RunMethod& method : run_methods()) names.push_back(method.name);
  if (!contains(names, name))
    throw error(Failure::usage, "{}", unknown_name("method", name, names));
}

std::string initial_value(const RunSettingInfo& info, const std::string& method,
                          const std::function<std::string(const std::string&)>& setting) {
  if (method == "modular") {
    if (info.name == "pop") return "64";
    if (info.name == "steps") return "262144";
    if (info.name == "train") return "modular";
  }
  if (info.name == "video" && method.empty()) return info.without;
  if (info.name == "shape" && setting("task") == "Lifter-v0") return "5x7";
  if (info.name == "parents") return fmt::format("{}", (std::stoll("0" + setting("pop")) + 7) / 8);
  return info.initial;
}

std::string shell_word(const std::string& text) {
  constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./,:=+@%";
  if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

std::string evolve_command(const std::string& folder,
                           const std::function<std::string(const std::string&)>& setting,
                           const std::vector<std::pair<std::string, std::string>>& changes) {
  const auto value_of = [&](const std::string& name) {
    for (const auto& [changed, value] : changes)
      if (changed == name) return value;
    return setting(name);
  };
  std::string line = fmt::format("evo evolve {}", shell_word(setting("method")));
  if (!folder.empty()) line += " --run " + shell_word(folder);
  for (const RunSettingInfo& info : run_settings()) {
    const std::string value = value_of(info.name);
    const bool holds_anyway = value == initial_value(info, setting("method"), value_of) &&
                              !contains({"task", "pop", "evals", "steps", "seed"}, info.name);
    if (!value.empty() && value == info.without)
      line += " " + info.option_without();
    else if (!value.empty() && !holds_anyway)
      line += fmt::format(" {} {}", info.option(), shell_word(value));
  }
  return line;
}

Json run_schema() {
  std::vector<std::string> methods;
  for (const RunMethod& method : run_methods()) methods.push_back(method.name);
  Json properties = {{"format", {{"const", format::run.name}}},
                     {"version", {{"const", format::run.version}}},
                     {"method", {{"enum", methods}}},
                     {"source", {{"type", "string"}}},
                     {"source_hash", {{"type", "string"}, {"pattern", "^[0-9a-f]{64}$"}}},
                     {"makefile", {{"type", "string"}, {"pattern", "^[0-9a-f]{64}$"}}}};
  for (const RunSettingInfo& info : run_settings()) properties[info.name] = schema_of(info);
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", fmt::format("{} {}", format::run.name, format::run.version)},
          {"type", "object"},
          {"required", {"format", "version", "method"}},
          {"properties", std::move(properties)},
          {"additionalProperties", false}};
}

}  // namespace evo
