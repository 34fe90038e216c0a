#include "render/goals.h"

#include <algorithm>
#include <cmath>

#include "formats/yaml.h"

namespace evo::render {
namespace {

// Of a goal, voxels; nothing for a task without goals.
std::optional<double> goal_radius(const Rollout& rollout) {
  if (rollout.task_yaml.empty()) return std::nullopt;
  const YamlNode document = YamlNode::parse(rollout.task_yaml, "task of the rollout");
  if (!document.is_mapping()) return std::nullopt;
  for (const YamlNode::Entry& entry : document.entries()) {
    if (entry.key.string() != "goals" || !entry.value.is_mapping()) continue;
    for (const YamlNode::Entry& setting : entry.value.entries())
      if (setting.key.string() == "radius") return setting.value.positive();
  }
  return std::nullopt;
}

std::vector<double> drawn_goals(const RolloutEpisode& episode) {
  std::vector<double> goals;
  const auto found = episode.random_draws.find("goals");
  if (found == episode.random_draws.end() || !found->is_array()) return goals;
  for (const Json& goal : *found)
    if (goal.is_number()) goals.push_back(goal.get<double>());
  return goals;
}

}  // namespace

std::vector<double> goals_by_step(const Rollout& rollout, const RolloutEpisode& episode,
                                  std::span<const Vec2> centres) {
  const std::vector<double> goals = drawn_goals(episode);
  const std::optional<double> radius = goal_radius(rollout);
  if (goals.empty() || !radius) return {};
  std::vector<double> by_step;
  std::size_t next = 0;
  for (const Vec2& centre : centres) {
    // At the start nothing is reached yet; after the last goal, it stays.
    while (!by_step.empty() && next + 1 < goals.size() &&
           std::abs(goals[next] - centre.x) < *radius)
      ++next;
    by_step.push_back(goals[next]);
  }
  return by_step;
}

}  // namespace evo::render
