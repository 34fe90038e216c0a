// Observation, reward and end of one step. See docs/tasks.md, "A step".
#include <algorithm>
#include <cmath>

#include "libevo/task/binder.h"

namespace evo {
double current_goal(const Episode& episode, double voxel_length) {
  const std::vector<int>& goals = episode.draws.goals;
  const std::size_t index = std::min(static_cast<std::size_t>(episode.goal), goals.size() - 1);
  return goals[index] * voxel_length;
}

bool all_hold(const std::vector<compiled::Test>& tests, const compiled::Step& step) {
  return std::all_of(tests.begin(), tests.end(),
                     [&](const compiled::Test& test) { return test(step); });
}

namespace {

// Goes on to the first goal that is not reached.
void count_goals(const Arena::Compiled& arena, Episode& episode, std::span<const double> post) {
  const int goals = static_cast<int>(episode.draws.goals.size());
  while (episode.goal < goals) {
    const double distance =
        std::abs(current_goal(episode, arena.voxel_length) - post[arena.robot_x]);
    if (!(distance < arena.goal_radius)) break;
    ++episode.goal;
  }
}

}  // namespace

std::vector<InitialShape> make_initial_shapes(const Arena::Compiled& arena,
                                              std::span<const Vec2> positions) {
  std::vector<InitialShape> initial_shapes;
  for (const PointRange& points : arena.orientations)
    initial_shapes.emplace_back(points.of(positions));
  return initial_shapes;
}

void measure(const Arena::Compiled& arena, const std::vector<InitialShape>& initial_shapes,
             std::span<const Vec2> positions, std::vector<Vec2>& work,
             std::span<double> quantities) {
  for (const Measure& measure : arena.measures) {
    const auto points = measure.points.of(positions);
    double* value = &quantities[measure.first];
    switch (measure.kind) {
      case Measure::Kind::centre: {
        const Centre c = centre(points, arena.voxel_length);
        value[raw_x] = c.raw.x;
        value[raw_y] = c.raw.y;
        value[voxel_x] = c.voxels.x;
        value[voxel_y] = c.voxels.y;
        break;
      }
      case Measure::Kind::orientation:
        *value =
            orientation(initial_shapes[static_cast<std::size_t>(measure.initial_shape)], points);
        break;
      case Measure::Kind::hull_area:
        *value = hull_area(points, work);
        break;
      case Measure::Kind::width:
        *value = width(points);
        break;
      case Measure::Kind::height:
        *value = height(points);
        break;
    }
  }
}

void pull_back_measures(const Arena::Compiled& arena,
                        const std::vector<InitialShape>& initial_shapes,
                        std::span<const Vec2> positions, std::span<const double> by_quantities,
                        std::span<Vec2> by_positions) {
  for (const Measure& measure : arena.measures) {
    const auto points = measure.points.of(positions);
    const auto by_points = measure.points.of(by_positions);
    const double* by = &by_quantities[measure.first];
    switch (measure.kind) {
      case Measure::Kind::centre:
        pull_back_mean({by[raw_x] + by[voxel_x] / arena.voxel_length,
                        by[raw_y] + by[voxel_y] / arena.voxel_length},
                       by_points);
        break;
      case Measure::Kind::orientation:
        pull_back_orientation(initial_shapes[static_cast<std::size_t>(measure.initial_shape)],
                              points, *by, by_points);
        break;
      case Measure::Kind::hull_area:
        pull_back_hull_area(points, *by, by_points);
        break;
      case Measure::Kind::width:
        pull_back_extent(points, &Vec2::x, *by, by_points);
        break;
      case Measure::Kind::height:
        pull_back_extent(points, &Vec2::y, *by, by_points);
        break;
    }
  }
}

void observe(const Arena::Compiled& arena, std::span<const Terrain> terrains,
             const Episode& episode, const compiled::SnapshotView& now,
             std::span<const double> quantities, std::span<double> observation) {
  const compiled::View view{episode, now, quantities, terrains};
  for (std::size_t i = 0; i < arena.parts.size(); ++i) {
    const auto& [name, offset, length] = arena.layout[i];
    arena.parts[i].write(view, observation.subspan(static_cast<std::size_t>(offset),
                                                   static_cast<std::size_t>(length)));
  }
}

StepOutcome judge(const Arena::Compiled& arena, Episode& episode, std::span<const double> pre,
                  std::span<const double> post, std::span<const double> targets, bool folded) {
  StepOutcome outcome;
  ++episode.steps;
  if (arena.has_goals) count_goals(arena, episode, post);
  const compiled::Step step{episode, pre, post, targets};
  for (const compiled::WeightedTerm& term : arena.terms)
    if (all_hold(term.when, step)) outcome.reward += term.weight * term.term.value(step);
  if (folded) {
    outcome.reward += arena.task.folding_reward;
    outcome.terminated = true;
  }
  for (const compiled::Rule& rule : arena.rules) {
    if (!all_hold(rule.when, step)) continue;
    outcome.reward += rule.reward;
    outcome.terminated = outcome.terminated || rule.terminate;
  }
  outcome.reward -= arena.task.step_cost;
  episode.targets.assign(targets.begin(), targets.end());
  outcome.truncated = episode.steps >= arena.task.episode_steps;
  return outcome;
}

}  // namespace evo
