// The settings that pipelines have, as scripts/settings.tsv lists them. From this table
// come the checks of run.yaml, its schema, help, completion and the command of a run; make
// reads the file itself (scripts/command-line.mk).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/json.h"

namespace evo {

enum class Kept {
  no,       // not in run.yaml: it decides no result
  changed,  // only where it has not its default
  quiet,    // always; left out of a command at its default
  yes,
};

struct SettingEntry {
  std::string name;                    // in run.yaml; make has it in capital letters
  std::vector<std::string> pipelines;  // "all": those that evolve
  std::string type;                    // count, number, shape, .., or words as in "yes|no"
  std::string initial;                 // its default, as the table words it
  Kept kept = Kept::no;
  std::string help;

  std::string variable() const;  // "FOUNDER_STEPS"
  // Whether a pipeline that evolves has it: "ga", "race".
  bool belongs_to(std::string_view pipeline) const;
  // What it is where it is not given, by the other settings; "" where the table only
  // says it in words.
  std::string value_without(const std::function<std::string(const std::string&)>& setting) const;
  // What is wrong with a value, such as "is a number from 1, not 'x'"; nothing: it is one.
  std::optional<std::string> defect(const std::string& value) const;
};

const std::vector<SettingEntry>& setting_table();
const SettingEntry* find_setting_entry(std::string_view name);

// What a setting was called in runs of earlier versions.
std::string present_name(const std::string& name);

// Of all settings, or those of one pipeline, a line each: "POP=N    robots of .. [25]".
std::string settings_help(std::string_view pipeline);

// The JSON Schema of run.yaml.
Json run_schema();

}  // namespace evo
