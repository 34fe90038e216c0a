// Observation, reward and end of one step. Spec: tasks, A.4 to A.8 and C.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libevo/task/compiled.h"

namespace evo {
namespace {

constexpr double pi = std::numbers::pi;

double at(std::span<const double> slots, int slot) { return slots[static_cast<std::size_t>(slot)]; }

// The goal that counts, raw; the last one after all were reached.
double current_goal(const Arena::Compiled& arena, const Episode& episode) {
  const std::vector<int>& goals = episode.draws.goals;
  const std::size_t index = std::min(static_cast<std::size_t>(episode.goal), goals.size() - 1);
  return goals[index] * arena.voxel_length;
}

// ---- observation ------------------------------------------------------------

struct Observer {
  const Arena::Compiled& arena;
  std::span<const Terrain> terrains;
  const Episode& episode;
  const SnapshotView& now;
  std::span<const double> slots;
  std::span<double> out;  // of this part

  void operator()(const compiled::Velocity& part) const {
    const Vec2 v = mean(part.points.of(now.velocities));
    out[0] = v.x;
    out[1] = v.y;
  }
  void operator()(const compiled::Slot& part) const { out[0] = at(slots, part.slot); }
  void operator()(const compiled::RelativePositions& part) const {
    const auto points = part.points.of(now.positions);
    const double x = at(slots, part.centre + raw_x);
    const double y = at(slots, part.centre + raw_y);
    const double voxel = arena.voxel_length;
    for (std::size_t i = 0; i < points.size(); ++i) {
      out[i] = points[i].x / voxel * voxel - x;
      out[points.size() + i] = points[i].y / voxel * voxel - y;
    }
  }
  void operator()(const compiled::Offset& part) const {
    out[0] = at(slots, part.of + raw_x) - at(slots, part.from + raw_x);
    out[1] = at(slots, part.of + raw_y) - at(slots, part.from + raw_y);
  }
  void operator()(const compiled::Profile& part) const {
    const Vec2 centre{at(slots, part.centre + voxel_x), at(slots, part.centre + voxel_y)};
    terrains[static_cast<std::size_t>(part.terrain)].profile(part.side, centre, part.range,
                                                             now.positions, out);
  }
  void operator()(const compiled::GoalIndex&) const { out[0] = episode.goal; }
  void operator()(const compiled::GoalPosition&) const { out[0] = current_goal(arena, episode); }
  void operator()(const compiled::GoalOffset& part) const {
    out[0] = current_goal(arena, episode) - at(slots, part.x);
  }
};

// ---- conditions ---------------------------------------------------------------

bool holds(const compiled::Within& test, const Episode&, std::span<const double> post) {
  const double value = at(post, test.slot);
  return value > test.above && value < test.below && value >= test.at_least &&
         value <= test.at_most;
}

bool holds(const compiled::GoalsReached&, const Episode& episode, std::span<const double>) {
  return episode.goal == static_cast<int>(episode.draws.goals.size());
}

bool all_hold(const std::vector<compiled::Test>& tests, const Episode& episode,
              std::span<const double> post) {
  return std::all_of(tests.begin(), tests.end(), [&](const compiled::Test& test) {
    return std::visit([&](const auto& t) { return holds(t, episode, post); }, test);
  });
}

// ---- reward -------------------------------------------------------------------

struct Valuer {
  const Arena::Compiled& arena;
  const Episode& episode;  // goals counted already
  std::span<const double> pre;
  std::span<const double> post;

  double operator()(const compiled::Change& term) const {
    const double change = at(post, term.slot) - at(pre, term.slot);
    return term.absolute ? std::abs(change) : change;
  }
  double operator()(const compiled::ApproachPlace& term) const {
    return std::abs(term.place - at(pre, term.slot)) - std::abs(term.place - at(post, term.slot));
  }
  double operator()(const compiled::ApproachObject& term) const {
    return std::abs(at(pre, term.slot) - at(pre, term.target)) -
           std::abs(at(post, term.slot) - at(post, term.target));
  }
  // A jump from near 0 to near 2 pi, or back, is a whole turn begun (Flipper-v0).
  double operator()(const compiled::Rotation& term) const {
    const double before = at(pre, term.slot);
    const double after = at(post, term.slot);
    double turns = 0.0;
    if (before < pi / 3.0 && after > 5.0 * pi / 3.0) turns = -1.0;
    if (before > 5.0 * pi / 3.0 && after < pi / 3.0) turns = 1.0;
    return 2.0 * pi * turns + after - before;
  }
  double operator()(const compiled::GoalApproach& term) const {
    const double goal = current_goal(arena, episode);
    return std::abs(goal - at(pre, term.x)) - std::abs(goal - at(post, term.x));
  }
};

// Goes on to the first goal that is not reached.
void count_goals(const Arena::Compiled& arena, Episode& episode, std::span<const double> post) {
  const int goals = static_cast<int>(episode.draws.goals.size());
  while (episode.goal < goals) {
    const double distance = std::abs(current_goal(arena, episode) - at(post, arena.robot_x));
    if (!(distance < arena.goal_radius)) break;
    ++episode.goal;
  }
}

}  // namespace

std::vector<OrientationReference> make_references(const Arena::Compiled& arena,
                                                  std::span<const Vec2> positions) {
  std::vector<OrientationReference> references;
  for (const PointRange& points : arena.orientations) references.emplace_back(points.of(positions));
  return references;
}

void measure(const Arena::Compiled& arena, const std::vector<OrientationReference>& references,
             std::span<const Vec2> positions, std::vector<Vec2>& work, std::span<double> slots) {
  for (const Measure& measure : arena.measures) {
    const auto points = measure.points.of(positions);
    double* value = &slots[static_cast<std::size_t>(measure.slot)];
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
        *value = orientation(references[static_cast<std::size_t>(measure.reference)], points);
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

void observe(const Arena::Compiled& arena, std::span<const Terrain> terrains,
             const Episode& episode, const SnapshotView& now, std::span<const double> slots,
             std::span<double> observation) {
  for (std::size_t i = 0; i < arena.parts.size(); ++i) {
    const ObservationSlice& slice = arena.layout[i];
    const auto out = observation.subspan(static_cast<std::size_t>(slice.offset),
                                         static_cast<std::size_t>(slice.length));
    std::visit(Observer{arena, terrains, episode, now, slots, out}, arena.parts[i]);
  }
}

StepOutcome judge(const Arena::Compiled& arena, Episode& episode, std::span<const double> pre,
                  std::span<const double> post, bool folded) {
  StepOutcome outcome;
  ++episode.steps;
  if (arena.has_goals) count_goals(arena, episode, post);
  for (const compiled::WeightedTerm& term : arena.terms)
    if (all_hold(term.when, episode, post))
      outcome.reward += term.weight * std::visit(Valuer{arena, episode, pre, post}, term.term);
  if (folded) {
    outcome.reward += arena.task.folding_reward;
    outcome.terminated = true;
  }
  for (const compiled::Rule& rule : arena.rules) {
    if (!all_hold(rule.when, episode, post)) continue;
    outcome.reward += rule.reward;
    outcome.terminated = outcome.terminated || rule.terminate;
  }
  outcome.truncated = episode.steps >= arena.task.episode_steps;
  return outcome;
}

}  // namespace evo
