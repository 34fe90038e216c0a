#include "evolution/run_command.h"

#include <fmt/format.h>

namespace evo {
namespace {

// A variable of the pipelines, the setting it becomes, and the value it has by itself.
struct Variable {
  const char* name;
  const char* setting;
  const char* own = "";
};

std::vector<Variable> variables_of(bool steady, const std::string& profile) {
  std::vector<Variable> variables{{"RUN", ""}};
  if (steady) variables.push_back({"METHOD", "method"});
  const bool ours = profile == "default" || profile == "paper" || profile == "release2";
  variables.insert(variables.end(), {{"TASK", "task"},
                                     {"POP", "population"},
                                     {"EVALS", "evaluations"},
                                     {"STEPS", "steps"},
                                     {"FOUNDER_STEPS", "founder_steps"},
                                     {"RUNGS", "rungs", "3"},
                                     {"PARENTS", "parents"},
                                     {"SEED", "seed"},
                                     {"SHAPE", "shape"},
                                     {"ALGO", "algo", ours ? "ppo" : "profile"},  // evolve.mk
                                     {"TRAIN", "train", "default"},
                                     {"PHYSICS", "physics", "task"},
                                     {"TRAIN_OPTIONS", "train_options"},
                                     {"FOUNDERS", "founders"},
                                     {"SAMPLE_OPTIONS", "sample_options"},
                                     {"MUTATE", "mutate"},
                                     {"MUTATE_OPTIONS", "mutate_options"},
                                     {"INHERIT", "inherit"},
                                     {"FEATURES", "features"},
                                     {"NEAT", "neat", "default"},
                                     {"WINDOW", "window"},
                                     {"EVALUATE", "evaluate"}});
  return variables;
}

// As a word of a shell's command line, for make, to which a dollar is "$$".
std::string shell_word(const std::string& value) {
  constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./,:=+";
  if (value.find_first_not_of(plain) == std::string::npos) return value;
  std::string word = "'";
  for (const char c : value) word += c == '\'' ? "'\\''" : c == '$' ? "$$" : std::string(1, c);
  return word + "'";
}

}  // namespace

std::string run_command(const std::function<std::string(const std::string&)>& setting,
                        const std::vector<std::pair<std::string, std::string>>& variables) {
  const bool steady = setting("layout") == "steady";
  std::string line = fmt::format("make -f scripts/{}.mk", steady ? "steady" : setting("method"));
  for (const Variable& variable : variables_of(steady, setting("train"))) {
    std::string value = *variable.setting == '\0' ? "" : setting(variable.setting);
    for (const auto& [name, instead] : variables)
      if (name == variable.name) value = instead;
    if (value.empty() || value == variable.own) continue;
    line += fmt::format(" {}={}", variable.name, shell_word(value));
  }
  return line + " -j8";
}

}  // namespace evo
