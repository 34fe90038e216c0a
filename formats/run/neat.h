// NEAT's files: the state between generations (JSON, `species.json`) and the
// settings (YAML, tasks/neat.yaml).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "formats/io/data_folders.h"
#include "formats/io/json.h"
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
NeatSettings parse_neat_settings(const std::string& text, const std::string& where);
NeatSettings load_neat_settings(const std::string& file);
// The JSON Schema of them.
Json neat_schema();

constexpr int default_population = 25;

// Settings of NEAT from a file, else from neat.yaml in the folders, for a population of
// `count`: if none is given, the file's, else the default. Throws what reading throws, and
// Error(data) for a file whose runs would end by their fitness.
NeatSettings neat_settings(const std::optional<std::string>& file, std::optional<int> count,
                           const DataFolders& folders);

}  // namespace evo
