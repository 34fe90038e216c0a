// Physics profiles as YAML (docs/physics.md, "Profiles"): every constant of
// libevo/sim/physics.h by name; a profile may start from another one and give
// only what differs.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/io/data_folders.h"
#include "formats/io/node.h"
#include "formats/io/profile.h"
#include "libevo/sim/physics.h"

namespace evo {

// A profile by name ("paper") or by file (a name with '/' or ending in .yaml).
// "evogym" is what libevo has built in where no folder has it. Throws
// Error(usage) for an unknown name, Error(no_input), Error(data).
Physics load_physics(const std::string& name_or_file, const DataFolders& folders);

// A profile as written in a file or in a task: a mapping of constants, with
// `base` naming the profile it starts from (default evogym). A base that is a
// file is looked for in `folder`.
Physics physics_from_yaml(const Node& node, const std::filesystem::path& folder,
                          const DataFolders& folders);

// Sets one constant: "gravity=50", "soft.edge=3e8/7". Throws Error(usage).
void apply_override(Physics& physics, std::string_view assignment);

// The complete profile, each constant with unit and meaning; numbers are exact:
// physics_from_yaml gives the same bits. Every line begins with `indent`.
std::string physics_to_yaml(const Physics& physics);
std::string physics_constants_to_yaml(const Physics& physics, const std::string& indent);

// Every constant with what there is to know of it, in the order of the profile.
std::vector<SettingRow> physics_table(const Physics& physics);

// The JSON Schema of a profile.
Json physics_schema();

// "physics.gravity=50": what decides a result, a line per constant.
std::vector<std::string> physics_identity(const Physics& physics);

}  // namespace evo
