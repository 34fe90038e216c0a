#include "formats/task/yaml.h"

#include <algorithm>
#include <array>

namespace evo {
namespace {

bool is_height(const YamlNode& reward) {
  if (value_of(reward, "when")) return false;
  if (const auto weight = value_of(reward, "weight"); weight && weight->number() < 0) return false;
  return std::ranges::any_of(std::array{"displacement", "extent"}, [&](const char* what) {
    const auto measured = value_of(reward, what);
    const auto axis = measured ? value_of(*measured, "axis") : std::nullopt;
    return axis && axis->string() == "y";
  });
}

}  // namespace

std::optional<YamlNode> task_document(const Rollout& rollout) {
  if (rollout.task_yaml.empty()) return std::nullopt;
  return YamlNode::parse(rollout.task_yaml, "task of the rollout");
}

std::optional<YamlNode> value_of(const YamlNode& mapping, const std::string& key) {
  if (!mapping.is_mapping()) return std::nullopt;
  for (const YamlNode::Entry& entry : mapping.entries())
    if (entry.key.string() == key) return entry.value;
  return std::nullopt;
}

namespace {

bool rewards_any(const Rollout& rollout, bool (*what)(const YamlNode&)) {
  const auto task = task_document(rollout);
  const auto rewards = task ? value_of(*task, "reward") : std::nullopt;
  return rewards && rewards->is_sequence() && std::ranges::any_of(rewards->items(), what);
}

}  // namespace

bool rewards_height(const Rollout& rollout) { return rewards_any(rollout, is_height); }

bool rewards_turning(const Rollout& rollout) {
  return rewards_any(rollout,
                     [](const YamlNode& part) { return value_of(part, "rotation").has_value(); });
}

}  // namespace evo
