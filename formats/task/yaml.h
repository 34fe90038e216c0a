// What a rollout's task says to those who draw it.
#pragma once

#include <optional>
#include <string>

#include "formats/io/yaml.h"
#include "formats/rollout/rollout.h"

namespace evo {

// The whole task; nothing in files that do not carry one. Throws Error(data) for text
// that is no YAML.
std::optional<YamlNode> task_document(const Rollout& rollout);

// Of a mapping; nothing where the key is not there, or the node is no mapping.
std::optional<YamlNode> value_of(const YamlNode& mapping, const std::string& key);

// Whether the task rewards height at all times: a displacement or an extent along y.
bool rewards_height(const Rollout& rollout);
// Whether the robot's turning counts.
bool rewards_turning(const Rollout& rollout);

}  // namespace evo
