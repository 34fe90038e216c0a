// The settings of runs: one table from which come the options of evo-evolve with their
// checks and help, completion, the reader of run.yaml and its schema, and the command that a
// report says made a run.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/io/json.h"

namespace evo {

enum class SettingKind { whole, shape, words, text };

struct RunSettingInfo {
  std::string name;                  // in run.yaml, "founder_steps"
  std::vector<std::string> methods;  // that have it; none: all
  SettingKind kind = SettingKind::text;
  std::string value;    // what stands for it in help: "N"; of words, those there are: "yes|no"
  std::string initial;  // where it is not given (initial_value); "" for nothing
  std::string meaning;
  std::int64_t least = 1;  // of whole numbers
  std::int64_t most = 1'000'000'000;
  std::string without = {};  // its value after --no-NAME, "none"; "": there is no such option

  std::string option() const;          // "--founder-steps"
  std::string option_without() const;  // "--no-video"
  std::vector<std::string> words() const;
  bool belongs_to(std::string_view method) const;
  bool is_of_training() const;  // means nothing where a program of one's own scores
  // What is wrong with a value, such as "is a whole number from 1 to 1000000, not 'x'".
  std::optional<std::string> defect(const std::string& value) const;
};

const std::vector<RunSettingInfo>& run_settings();
const RunSettingInfo* find_run_setting(std::string_view name);

// "ga", "neat", "bo", .., and what each of them is.
struct RunMethod {
  std::string name;
  std::string meaning;
};
const std::vector<RunMethod>& run_methods();
// Throws Error(usage) for another name.
void check_run_method(const std::string& name);

// What a setting is by the other ones, where it is not given. No method: of runs side by side.
std::string initial_value(const RunSettingInfo& info, const std::string& method,
                          const std::function<std::string(const std::string&)>& setting);

// A word of a shell's command line, quoted where it has to be.
std::string shell_word(const std::string& text);

// "evo evolve ga --run runs/walker --task Walker-v0 ..": the command of a run, without what
// holds anyway. `setting` gives a setting by its name, "" where there is none; `changes`, by
// name, count in place of the run's own; "" leaves one out.
std::string evolve_command(const std::string& folder,
                           const std::function<std::string(const std::string&)>& setting,
                           const std::vector<std::pair<std::string, std::string>>& changes = {});

// The JSON Schema of run.yaml.
Json run_schema();

}  // namespace evo
