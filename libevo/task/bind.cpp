// From names to indices.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <utility>

#include "libevo/base/error.h"
#include "libevo/task/compiled.h"

namespace evo {
namespace {

constexpr double pi = std::numbers::pi;

// Collects what parts, terms and conditions look at, each thing once.
class Binder {
 public:
  explicit Binder(Arena::Compiled& arena) : arena_(arena) {}

  int object(const std::string& name) const {
    const int index = arena_.stage->model.object_index(name);
    if (index >= 0) return index;
    std::vector<std::string> names;
    for (const ModelObject& known : arena_.stage->model.objects()) names.push_back(known.name);
    throw error(Failure::data, "unknown object '{}'{}; the world has {}", name,
                did_you_mean(name, names), fmt::join(names, ", "));
  }

  PointRange points(const std::string& name) const {
    const ModelObject& found =
        arena_.stage->model.objects()[static_cast<std::size_t>(object(name))];
    return {found.first_point, found.points};
  }

  int centre(const std::string& name) { return slot(Measure::Kind::centre, name, centre_slots); }
  int centre(const std::string& name, Axis axis) {
    return centre(name) + (axis == Axis::x ? raw_x : raw_y);
  }
  int orientation(const std::string& name) { return slot(Measure::Kind::orientation, name, 1); }
  int hull_area(const std::string& name) { return slot(Measure::Kind::hull_area, name, 1); }
  int extent(const std::string& name, Axis axis) {
    return slot(axis == Axis::x ? Measure::Kind::width : Measure::Kind::height, name, 1);
  }

  int terrain(const std::vector<std::string>& over) {
    std::vector<int> objects;
    objects.reserve(over.size());
    for (const std::string& name : over) objects.push_back(object(name));
    if (over.empty()) {
      const int robot = object(robot_name);
      const int count = static_cast<int>(arena_.stage->model.objects().size());
      for (int i = 0; i < count; ++i)
        if (i != robot) objects.push_back(i);
    }
    auto& known = arena_.terrain_objects;
    const auto found = std::find(known.begin(), known.end(), objects);
    if (found != known.end()) return static_cast<int>(found - known.begin());
    known.push_back(std::move(objects));
    return static_cast<int>(known.size()) - 1;
  }

  double raw(double voxels) const { return voxels * arena_.voxel_length; }

  void need_goals(const char* what) const {
    if (!arena_.has_goals) throw error(Failure::data, "{} needs the task to draw goals", what);
  }

 private:
  int slot(Measure::Kind kind, const std::string& name, int width) {
    const PointRange range = points(name);
    for (const Measure& known : arena_.measures)
      if (known.kind == kind && known.points.first == range.first) return known.slot;
    Measure measure{kind, range, arena_.slots, -1};
    if (kind == Measure::Kind::orientation) {
      measure.reference = static_cast<int>(arena_.orientations.size());
      arena_.orientations.push_back(range);
    }
    arena_.measures.push_back(measure);
    arena_.slots += width;
    return measure.slot;
  }

  Arena::Compiled& arena_;
};

// ---- observation ------------------------------------------------------------

struct PartCompiler {
  Binder& bind;

  compiled::Part operator()(const observation::Velocity& part) const {
    return compiled::Velocity{bind.points(part.of)};
  }
  compiled::Part operator()(const observation::Orientation& part) const {
    return compiled::Slot{bind.orientation(part.of)};
  }
  compiled::Part operator()(const observation::RelativePositions& part) const {
    return compiled::RelativePositions{bind.points(part.of), bind.centre(part.of)};
  }
  compiled::Part operator()(const observation::Offset& part) const {
    return compiled::Offset{bind.centre(part.of), bind.centre(part.from)};
  }
  compiled::Part operator()(const observation::Floor& part) const {
    return compiled::Profile{Terrain::Side::below, bind.terrain(part.over), bind.centre(robot_name),
                             part.range};
  }
  compiled::Part operator()(const observation::Ceiling& part) const {
    return compiled::Profile{Terrain::Side::above, bind.terrain(part.over), bind.centre(robot_name),
                             part.range};
  }
  compiled::Part operator()(const observation::GoalIndex&) const {
    bind.need_goals("goal_index");
    return compiled::GoalIndex{};
  }
  compiled::Part operator()(const observation::GoalPosition&) const {
    bind.need_goals("goal_position");
    return compiled::GoalPosition{};
  }
  compiled::Part operator()(const observation::GoalOffset&) const {
    bind.need_goals("goal_offset");
    return compiled::GoalOffset{bind.centre(robot_name, Axis::x)};
  }
};

void compile_observation(Arena::Compiled& arena, Binder& bind) {
  for (const ObservationPart& part : arena.task.observation) {
    arena.parts.push_back(std::visit(PartCompiler{bind}, part));
    const std::string of = part_object(part);
    const int length = part_length(part, of.empty() ? 0 : bind.points(of).count);
    arena.layout.push_back({part_name(part), arena.observation_length, length});
    arena.observation_length += length;
  }
}

// ---- conditions ---------------------------------------------------------------

struct TestCompiler {
  Binder& bind;

  compiled::Test operator()(const condition::Position& position) const {
    compiled::Within within;
    within.slot = bind.centre(position.of, position.axis);
    if (position.above) within.above = bind.raw(*position.above);
    if (position.below) within.below = bind.raw(*position.below);
    if (position.at_least) within.at_least = bind.raw(*position.at_least);
    if (position.at_most) within.at_most = bind.raw(*position.at_most);
    return within;
  }
  compiled::Test operator()(const condition::Tilt& tilt) const {
    const double lean = pi * (90.0 - tilt.degrees) / 180.0;
    compiled::Within within;
    within.slot = bind.orientation(tilt.of);
    within.above = pi / 2.0 - lean;
    within.below = 3.0 * pi / 2.0 + lean;
    return within;
  }
  compiled::Test operator()(const condition::GoalsReached&) const {
    bind.need_goals("goals_reached");
    return compiled::GoalsReached{};
  }
};

std::vector<compiled::Test> compile_tests(const std::vector<Condition>& conditions, Binder& bind) {
  std::vector<compiled::Test> tests;
  tests.reserve(conditions.size());
  for (const Condition& condition : conditions)
    tests.push_back(std::visit(TestCompiler{bind}, condition));
  return tests;
}

// ---- reward -------------------------------------------------------------------

struct TermCompiler {
  Binder& bind;

  compiled::Term operator()(const reward::Displacement& term) const {
    return compiled::Change{bind.centre(term.of, term.axis), false};
  }
  compiled::Term operator()(const reward::Distance& term) const {
    return compiled::Change{bind.centre(term.of, term.axis), true};
  }
  compiled::Term operator()(const reward::Approach& term) const {
    const int slot = bind.centre(term.of, term.axis);
    if (const auto* object = std::get_if<std::string>(&term.to))
      return compiled::ApproachObject{slot, bind.centre(*object, term.axis)};
    return compiled::ApproachPlace{slot, bind.raw(std::get<double>(term.to))};
  }
  compiled::Term operator()(const reward::HullArea& term) const {
    return compiled::Change{bind.hull_area(term.of), false};
  }
  compiled::Term operator()(const reward::Extent& term) const {
    return compiled::Change{bind.extent(term.of, term.axis), false};
  }
  compiled::Term operator()(const reward::Rotation& term) const {
    return compiled::Rotation{bind.orientation(term.of)};
  }
  compiled::Term operator()(const reward::GoalApproach&) const {
    bind.need_goals("goal_approach");
    return compiled::GoalApproach{bind.centre(robot_name, Axis::x)};
  }
};

// ---- draws and world ----------------------------------------------------------

int drawn(const Draws& draws, const std::string& name) {
  return name.empty() ? 0 : draws.integers.at(name);
}

Draws lowest_draws(const TaskSpec& task) {
  Draws draws;
  for (const DrawnInteger& integer : task.draws) draws.integers[integer.name] = integer.low;
  return draws;
}

void check_placements(const TaskSpec& task) {
  const Draws draws = lowest_draws(task);
  for (const Placement& placement : task.objects) {
    for (const std::string& name : {placement.offset_x, placement.offset_y})
      if (!name.empty() && draws.integers.count(name) == 0)
        throw error(Failure::data, "object '{}' is offset by '{}', which the task does not draw",
                    placement.object.name, name);
    if (count_actuators(placement.object.body) > 0)
      throw error(Failure::data, "object '{}' has actuators, which only the robot may have",
                  placement.object.name);
  }
  if (task.goals && task.goals->high <= task.goals->low)
    throw error(Failure::data, "goals need a range of at least two places, found {} to {}",
                task.goals->low, task.goals->high);
}

}  // namespace

World make_world(const TaskSpec& task, const Body& robot, const Draws& draws) {
  World world;
  world.objects.push_back({robot_name, robot, task.robot_x, task.robot_y});
  for (const Placement& placement : task.objects) {
    Object object = placement.object;
    object.x += drawn(draws, placement.offset_x);
    object.y += drawn(draws, placement.offset_y);
    world.objects.push_back(std::move(object));
  }
  return world;
}

std::vector<Terrain> make_terrains(const Arena::Compiled& arena, const Model& model) {
  std::vector<Terrain> terrains;
  for (const std::vector<int>& objects : arena.terrain_objects)
    terrains.emplace_back(model, objects);
  return terrains;
}

std::shared_ptr<const Stage> make_stage(const Arena::Compiled& arena, const Draws& draws) {
  Model model(make_world(arena.task, arena.robot, draws), arena.task.physics);
  std::vector<Terrain> terrains = make_terrains(arena, model);
  return std::make_shared<const Stage>(Stage{std::move(model), std::move(terrains)});
}

Arena::Compiled bind_task(TaskSpec task, Body robot) {
  Arena::Compiled arena;
  arena.task = std::move(task);
  arena.robot = std::move(robot);
  if (const auto problem = defect(arena.robot, true))
    throw error(Failure::data, "the robot cannot be used: {}", *problem);
  check_placements(arena.task);

  const Draws draws = lowest_draws(arena.task);
  arena.stage = make_stage(arena, draws);  // without terrains, which are not known yet
  arena.voxel_length = arena.task.physics.voxel_length;
  arena.has_goals = arena.task.goals.has_value();

  Binder bind(arena);
  compile_observation(arena, bind);
  for (const RewardTerm& term : arena.task.reward)
    arena.terms.push_back(
        {term.weight, std::visit(TermCompiler{bind}, term.term), compile_tests(term.when, bind)});
  for (const Rule& rule : arena.task.rules)
    arena.rules.push_back({compile_tests(rule.when, bind), rule.reward, rule.terminate});
  if (arena.has_goals) {
    arena.goal_radius = bind.raw(arena.task.goals->radius);
    arena.robot_x = bind.centre(robot_name, Axis::x);
  }
  arena.stage = make_stage(arena, draws);
  return arena;
}

}  // namespace evo
