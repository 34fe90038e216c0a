// A task bound to a robot's world: names turned into indices, once. Private to
// libevo/task.
//
// What a task looks at in a snapshot is measured once, as numbered quantities;
// reward terms and conditions compare quantities before and after a step.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "libevo/task/env.h"
#include "libevo/task/measure.h"
#include "libevo/task/step_tape.h"
#include "libevo/task/terrain.h"

namespace evo {

// ---- measurements -----------------------------------------------------------

struct Measure {
  // `centre` is four quantities: x, y raw; x, y in voxels. The others are one.
  enum class Kind { centre, orientation, hull_area, width, height };
  Kind kind = Kind::centre;
  PointRange points;
  std::size_t first = 0;   // of its quantities
  int initial_shape = -1;  // orientation: which InitialShape
};

// Quantities of a centre, counted from its first.
enum CentreQuantity : std::size_t { raw_x, raw_y, voxel_x, voxel_y, centre_quantities };

// ---- the pieces of a task, bound ------------------------------------------------
//
// Every observation part, condition and reward term becomes a function that has
// its indices with it (observation.cpp, conditions.cpp, reward.cpp).

namespace compiled {

struct SnapshotView {
  std::span<const Vec2> positions;
  std::span<const Vec2> velocities;
};

// What a part of the observation sees.
struct View {
  const Episode& episode;
  SnapshotView now;
  std::span<const double> quantities;  // measured in `now`
  std::span<const Terrain> terrains;
};

// What conditions and reward terms see: quantities before and after the step, and its targets.
struct Step {
  const Episode& episode;  // goals counted already
  std::span<const double> pre;
  std::span<const double> post;
  std::span<const double> targets;  // [A], clipped
};

// Derivatives of one number by what a part of the observation sees, to be added to.
struct ViewSlopes {
  std::span<Vec2> positions;
  std::span<Vec2> velocities;
  std::span<double> quantities;
};

// The same by what reward terms see; `targets_before`: of the step before.
struct StepSlopes {
  std::span<double> pre;
  std::span<double> post;
  std::span<double> targets;
  std::span<double> targets_before;
};

struct Part {
  std::function<void(const View&, std::span<double> numbers)> write;
  // From derivatives by its numbers; none: it does not change with the simulation.
  std::function<void(const View&, std::span<const double> by_part, ViewSlopes&)> pull_back;
};
using Test = std::function<bool(const Step&)>;
struct Term {
  std::function<double(const Step&)> value;  // without its weight
  // Adds `share` times its derivatives, one-sided ones where it has an edge.
  std::function<void(const Step&, double share, StepSlopes&)> pull_back;
};

struct WeightedTerm {
  double weight = 1.0;
  Term term;
  std::vector<Test> when;
};

struct Rule {
  std::vector<Test> when;
  double reward = 0.0;
  bool terminate = true;
};

}  // namespace compiled

// ---- the whole ----------------------------------------------------------------

// A world an episode plays in. Tasks that draw where objects stand have one per
// episode, all others one in all.
struct EpisodeWorld {
  Model model;
  std::vector<Terrain> terrains;  // by Arena::Compiled::terrain_objects
};

struct Arena::Compiled {
  TaskSpec task;
  Body robot;
  std::shared_ptr<const EpisodeWorld> world;  // with all draws at their lowest value

  std::vector<Measure> measures;
  std::size_t quantities = 0;
  std::vector<PointRange> orientations;           // whose initial shapes are compared
  std::vector<std::vector<int>> terrain_objects;  // model objects, one list per Terrain

  std::vector<compiled::Part> parts;
  std::vector<ObservationSlice> layout;
  int observation_length = 0;
  std::vector<compiled::WeightedTerm> terms;
  std::vector<compiled::Rule> rules;

  double voxel_length = 0.1;
  bool has_goals = false;
  double goal_radius = 0.0;  // raw
  std::size_t robot_x = 0;   // the robot's raw x, where the task has goals
};

// The task's world with the robot in it.
World make_world(const TaskSpec& task, const Body& robot, const Draws& draws);
std::vector<Terrain> make_terrains(const Arena::Compiled& arena, const Model& model);
std::shared_ptr<const EpisodeWorld> make_episode_world(const Arena::Compiled& arena,
                                                       const Draws& draws);
// Names turned into indices; throws Error(data).
Arena::Compiled bind_task(TaskSpec task, Body robot);

// ---- one step, on quantities ------------------------------------------------------

// One per orientation of the task, at time 0 of the episode.
std::vector<InitialShape> make_initial_shapes(const Arena::Compiled& arena,
                                              std::span<const Vec2> positions);

void measure(const Arena::Compiled& arena, const std::vector<InitialShape>& initial_shapes,
             std::span<const Vec2> positions, std::vector<Vec2>& work,
             std::span<double> quantities);

// From derivatives by quantities to those by positions, which are added to.
void pull_back_measures(const Arena::Compiled& arena,
                        const std::vector<InitialShape>& initial_shapes,
                        std::span<const Vec2> positions, std::span<const double> by_quantities,
                        std::span<Vec2> by_positions);

// Whether all conditions of a rule or a reward term hold.
bool all_hold(const std::vector<compiled::Test>& tests, const compiled::Step& step);

void observe(const Arena::Compiled& arena, std::span<const Terrain> terrains,
             const Episode& episode, const compiled::SnapshotView& now,
             std::span<const double> quantities, std::span<double> observation);

StepOutcome judge(const Arena::Compiled& arena, Episode& episode, std::span<const double> pre,
                  std::span<const double> post, std::span<const double> targets, bool folded);

// What a StepTape keeps.
struct StepTape::Impl {
  struct Step {
    bool is_active = false;
    bool is_done = true;  // neither folded nor unstable
    const Arena* arena = nullptr;
    std::shared_ptr<const EpisodeWorld> world;
    std::size_t observation_offset = 0;
    std::size_t action_offset = 0;
    std::vector<InitialShape> initial_shapes;
    Episode episode;              // as the observation sees it
    int goal = 0;                 // as rewards see it
    std::vector<double> targets;  // as given
    std::vector<Vec2> before, after;
    std::vector<double> quantities_before, quantities_after;
  };

  explicit Impl(double onset) : simulation(onset) {}

  Tape simulation;
  std::vector<Step> steps;  // [E]
};

}  // namespace evo
