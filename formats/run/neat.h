// NEAT's files: the state between generations (JSON, `species.json`) and the
// settings (YAML, tasks/neat.yaml).
#pragma once

#include <string>
#include <string_view>

#include "formats/io/json.h"
#include "formats/io/yaml.h"
#include "libevo/evolve/neat.h"

namespace evo {

// The state as a document: one species per line, ends with a newline. Numbers are
// written so that reading gives the same state to the last bit.
std::string neat_state_to_text(const NeatState& state);

// Throws Error(data) with `where` and the JSON path.
NeatState parse_neat_state(std::string_view text, const std::string& where);
NeatState load_neat_state(const std::string& file);

// Settings: what is not given has the value of NeatSettings. Throws Error(data)
// with file, line and column. Text may also be neat-python's own (neat_ini.h).
NeatSettings neat_settings_from_yaml(const YamlNode& node);
NeatSettings parse_neat_settings(const std::string& text, const std::string& where);
NeatSettings load_neat_settings(const std::string& file);

}  // namespace evo
