#include "tests/unit/sim/reference_case.h"

#include <algorithm>
#include <filesystem>

#include "formats/rollout/rollout.h"
#include "formats/task/task.h"

namespace evo {
namespace {

const std::filesystem::path folder = std::filesystem::path(EVO_TEST_DATA) / "reference";

// The objects of a task where they stand before any draw, and the robot's place.
World task_world(const std::string& task) {
  const TaskSpec spec = load_task(task, {std::filesystem::path(EVO_SOURCE_DIR) / "tasks"});
  World world;
  for (const Placement& placement : spec.objects) world.objects.push_back(placement.object);
  world.objects.push_back({robot_name, {}, spec.robot_x, spec.robot_y});
  return world;
}

}  // namespace

std::span<const double> ReferenceCase::action(int step) const {
  const std::size_t n = actions.size() / static_cast<std::size_t>(steps);
  return std::span(actions).subspan(static_cast<std::size_t>(step) * n, n);
}

std::span<const Vec2> ReferenceCase::positions_after(int step) const {
  const auto n = static_cast<std::size_t>(points);
  return std::span(positions).subspan(static_cast<std::size_t>(step) * n, n);
}

std::vector<std::string> reference_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".h5") continue;
    std::filesystem::path name = std::filesystem::relative(entry.path(), folder);
    names.push_back(name.replace_extension().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

ReferenceCase read_reference(const std::string& name) {
  const Rollout rollout = read_rollout(folder / (name + ".h5"));
  const RolloutEpisode& episode = rollout.episodes.at(0);
  ReferenceCase c;
  c.name = name;
  c.steps = episode.steps();
  c.points = rollout.points;
  c.actions = episode.actions;
  c.positions = episode.positions;
  c.world = name == "extra/floor" ? World{{{robot_name, {}, 2, 3}}} : task_world(rollout.task);
  c.world.objects.back().body = rollout.robot.value().body;
  if (rollout.task == "Catcher-v0") {  // the only task that draws places
    const Json& draws = episode.random_draws;
    for (Object& object : c.world.objects) {
      if (object.name == "ground" || object.name == robot_name) continue;
      object.x += draws.at("ox").get<int>();
      object.y += draws.at("oy").get<int>();
    }
  }
  return c;
}

}  // namespace evo
