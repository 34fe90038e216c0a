#include "render/scene/goals.h"

#include <algorithm>
#include <cmath>

#include "formats/rollout/ending.h"

namespace evo::render {
namespace {

// How near a goal is reached, voxels; nothing for a task without goals.
std::optional<double> goal_radius(const Rollout& rollout) {
  const auto goals = task_value(rollout, "goals");
  const auto radius = goals ? goals->find("radius") : std::nullopt;
  return radius ? std::optional(radius->positive()) : std::nullopt;
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

std::vector<GoalOfStep> goals_by_step(const Rollout& rollout, const RolloutEpisode& episode,
                                      std::span<const Vec2> centres) {
  const std::vector<double> goals = drawn_goals(episode);
  const std::optional<double> radius = goal_radius(rollout);
  if (goals.empty() || !radius) return {};
  std::vector<GoalOfStep> by_step;
  std::size_t reached = 0;
  for (const Vec2& centre : centres) {
    // At the start nothing is reached yet; after the last goal, it stays.
    while (!by_step.empty() && reached < goals.size() &&
           std::abs(goals[reached] - centre.x) < *radius)
      ++reached;
    by_step.push_back({goals[std::min(reached, goals.size() - 1)], reached});
  }
  return by_step;
}

}  // namespace evo::render
