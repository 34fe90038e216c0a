// The `world` of a task: objects drawn as rows of letters, filled rectangles, a
// picture of several objects with a legend, or a design-tool file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/io/node.h"
#include "libevo/task/spec.h"

namespace evo {

// Objects in the order written, each cut to the bounding box of its cells.
// `draws` are the integers an object's `offset` may name, at their lowest here.
// Throws Error(data) for bad drawings, objects in pieces or over one another.
std::vector<Placement> world_from_yaml(const Node& node, const std::filesystem::path& folder,
                                       const std::vector<DrawnInteger>& draws);

// The value of `world:` that world_from_yaml reads back; lines begin with two
// spaces.
std::string world_to_yaml(const std::vector<Placement>& objects);

// Text as a YAML scalar, quoted as in JSON, whose texts are YAML.
std::string yaml_scalar(const std::string& text);

}  // namespace evo
