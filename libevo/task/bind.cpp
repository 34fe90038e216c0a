// From names to indices.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "libevo/base/error.h"
#include "libevo/base/join.h"
#include "libevo/task/binder.h"

namespace evo {

// ---- binder ---------------------------------------------------------------------

int Binder::object(const std::string& name) const {
  const int index = arena_.world->model.object_index(name);
  if (index >= 0) return index;
  std::vector<std::string> names;
  for (const ModelObject& known : arena_.world->model.objects()) names.push_back(known.name);
  throw error(Failure::data, "unknown object '{}'{}; the world has {}", name,
              did_you_mean(name, names), joined(names));
}

PointRange Binder::points(const std::string& name) const {
  const ModelObject& found = arena_.world->model.objects()[static_cast<std::size_t>(object(name))];
  return {found.first_point, found.points};
}

std::size_t Binder::centre(const std::string& name) {
  return measured(Measure::Kind::centre, name, centre_quantities);
}

std::size_t Binder::centre(const std::string& name, Axis axis) {
  return centre(name) + (axis == Axis::x ? raw_x : raw_y);
}

std::size_t Binder::orientation(const std::string& name) {
  return measured(Measure::Kind::orientation, name, 1);
}

std::size_t Binder::hull_area(const std::string& name) {
  return measured(Measure::Kind::hull_area, name, 1);
}

std::size_t Binder::extent(const std::string& name, Axis axis) {
  return measured(axis == Axis::x ? Measure::Kind::width : Measure::Kind::height, name, 1);
}

std::size_t Binder::terrain(const std::vector<std::string>& over) {
  std::vector<int> objects;
  objects.reserve(over.size());
  for (const std::string& name : over) objects.push_back(object(name));
  if (over.empty()) {
    const int robot = object(robot_name);
    const int count = static_cast<int>(arena_.world->model.objects().size());
    for (int i = 0; i < count; ++i)
      if (i != robot) objects.push_back(i);
  }
  auto& known = arena_.terrain_objects;
  const auto found = std::find(known.begin(), known.end(), objects);
  if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
  known.push_back(std::move(objects));
  return known.size() - 1;
}

void Binder::need_goals(const char* what) const {
  if (!arena_.has_goals) throw error(Failure::data, "{} needs the task to draw goals", what);
}

std::size_t Binder::measured(Measure::Kind kind, const std::string& name, std::size_t quantities) {
  const PointRange range = points(name);
  for (const Measure& known : arena_.measures)
    if (known.kind == kind && known.points.first == range.first) return known.first;
  Measure measure{kind, range, arena_.quantities, -1};
  if (kind == Measure::Kind::orientation) {
    measure.initial_shape = static_cast<int>(arena_.orientations.size());
    arena_.orientations.push_back(range);
  }
  arena_.measures.push_back(measure);
  arena_.quantities += quantities;
  return measure.first;
}

namespace {

// ---- pieces -----------------------------------------------------------------------

void bind_observation(Arena::Compiled& arena, Binder& bind) {
  for (const ObservationPart& part : arena.task.observation) {
    arena.parts.push_back(bind_part(part, bind));
    const std::string of = part_object(part);
    const int length = part_length(part, of.empty() ? 0 : bind.points(of).count);
    arena.layout.push_back({part_name(part), arena.observation_length, length});
    arena.observation_length += length;
  }
}

std::vector<compiled::Test> bind_conditions(const std::vector<Condition>& conditions,
                                            Binder& bind) {
  std::vector<compiled::Test> tests;
  tests.reserve(conditions.size());
  for (const Condition& condition : conditions) tests.push_back(bind_condition(condition, bind));
  return tests;
}

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

std::shared_ptr<const EpisodeWorld> make_episode_world(const Arena::Compiled& arena,
                                                       const Draws& draws) {
  Physics physics = arena.task.physics;
  physics.substeps *= arena.task.hold;
  Model model(make_world(arena.task, arena.robot, draws), physics);
  std::vector<Terrain> terrains = make_terrains(arena, model);
  return std::make_shared<const EpisodeWorld>(EpisodeWorld{std::move(model), std::move(terrains)});
}

Arena::Compiled bind_task(TaskSpec task, Body robot) {
  Arena::Compiled arena;
  arena.task = std::move(task);
  arena.robot = std::move(robot);
  if (const auto problem = defect(arena.robot, true))
    throw error(Failure::data, "the robot cannot be used: {}", *problem);
  check_placements(arena.task);

  const Draws draws = lowest_draws(arena.task);
  arena.world = make_episode_world(arena, draws);  // without terrains, which are not known yet
  arena.voxel_length = arena.task.physics.voxel_length;
  arena.has_goals = arena.task.goals.has_value();

  Binder bind(arena);
  bind_observation(arena, bind);
  for (const RewardTerm& term : arena.task.reward)
    arena.terms.push_back(
        {term.weight, bind_term(term.term, bind), bind_conditions(term.when, bind)});
  for (const Rule& rule : arena.task.rules)
    arena.rules.push_back({bind_conditions(rule.when, bind), rule.reward, rule.terminate});
  if (arena.has_goals) {
    arena.goal_radius = bind.raw(arena.task.goals->radius);
    arena.robot_x = bind.centre(robot_name, Axis::x);
  }
  arena.world = make_episode_world(arena, draws);
  return arena;
}

}  // namespace evo
