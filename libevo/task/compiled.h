// A task bound to a robot's world: names turned into indices, once. Private to
// libevo/task.
//
// What a task looks at in a snapshot is measured once and kept in numbered
// slots; reward terms and conditions compare slots before and after a step.
#pragma once

#include <limits>
#include <memory>
#include <variant>
#include <vector>

#include "libevo/task/env.h"
#include "libevo/task/measure.h"
#include "libevo/task/terrain.h"

namespace evo {

// ---- measurements -----------------------------------------------------------

struct Measure {
  // `centre` fills four slots: x, y raw; x, y in voxels. The others fill one.
  enum class Kind { centre, orientation, hull_area, width, height };
  Kind kind = Kind::centre;
  PointRange points;
  int slot = 0;
  int reference = -1;  // orientation: which OrientationReference
};

// Slots of a centre, after its first.
enum CentreSlot { raw_x, raw_y, voxel_x, voxel_y, centre_slots };

// ---- observation ------------------------------------------------------------

namespace compiled {

struct Velocity {
  PointRange points;
};
struct Slot {
  int slot = 0;
};
struct RelativePositions {
  PointRange points;
  int centre = 0;
};
struct Offset {
  int of = 0;  // first slots of centres
  int from = 0;
};
struct Profile {
  Terrain::Side side = Terrain::Side::below;
  int terrain = 0;
  int centre = 0;
  double range = 5;
};
struct GoalIndex {};
struct GoalPosition {};
struct GoalOffset {
  int x = 0;
};
using Part = std::variant<Velocity, Slot, RelativePositions, Offset, Profile, GoalIndex,
                          GoalPosition, GoalOffset>;

// ---- conditions ---------------------------------------------------------------

// above < slot < below and at_least <= slot <= at_most. Raw units, radians.
struct Within {
  int slot = 0;
  double above = -std::numeric_limits<double>::infinity();
  double below = std::numeric_limits<double>::infinity();
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
};
struct GoalsReached {};
using Test = std::variant<Within, GoalsReached>;

// ---- reward -------------------------------------------------------------------

struct Change {
  int slot = 0;
  bool absolute = false;
};
struct ApproachPlace {
  int slot = 0;
  double place = 0.0;
};
struct ApproachObject {
  int slot = 0;
  int target = 0;
};
struct Rotation {
  int slot = 0;
};
struct GoalApproach {
  int x = 0;
};
using Term = std::variant<Change, ApproachPlace, ApproachObject, Rotation, GoalApproach>;

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

// A world an episode plays in. Tasks that draw where objects stand have one an
// episode, all others one in all.
struct Stage {
  Model model;
  std::vector<Terrain> terrains;  // by Arena::Compiled::terrain_objects
};

struct Arena::Compiled {
  TaskSpec task;
  Body robot;
  std::shared_ptr<const Stage> stage;  // with all draws at their lowest value

  std::vector<Measure> measures;
  int slots = 0;
  std::vector<PointRange> orientations;           // objects that need a reference
  std::vector<std::vector<int>> terrain_objects;  // model objects, one list a Terrain

  std::vector<compiled::Part> parts;
  std::vector<ObservationSlice> layout;
  int observation_length = 0;
  std::vector<compiled::WeightedTerm> terms;
  std::vector<compiled::Rule> rules;

  double voxel_length = 0.1;
  bool has_goals = false;
  double goal_radius = 0.0;  // raw
  int robot_x = 0;           // slot of the robot's raw x, where the task has goals
};

// The task's world with the robot in it.
World make_world(const TaskSpec& task, const Body& robot, const Draws& draws);
std::vector<Terrain> make_terrains(const Arena::Compiled& arena, const Model& model);
std::shared_ptr<const Stage> make_stage(const Arena::Compiled& arena, const Draws& draws);
// Names turned into indices; throws Error(data).
Arena::Compiled bind_task(TaskSpec task, Body robot);

// ---- one step, on slots ---------------------------------------------------------

struct SnapshotView {
  std::span<const Vec2> positions;
  std::span<const Vec2> velocities;
};

// One an orientation of the task, at time 0 of the episode.
std::vector<OrientationReference> make_references(const Arena::Compiled& arena,
                                                  std::span<const Vec2> positions);

void measure(const Arena::Compiled& arena, const std::vector<OrientationReference>& references,
             std::span<const Vec2> positions, std::vector<Vec2>& work, std::span<double> slots);

void observe(const Arena::Compiled& arena, std::span<const Terrain> terrains,
             const Episode& episode, const SnapshotView& now, std::span<const double> slots,
             std::span<double> observation);

StepOutcome judge(const Arena::Compiled& arena, Episode& episode, std::span<const double> pre,
                  std::span<const double> post, bool folded);

}  // namespace evo
