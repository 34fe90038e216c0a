#include "formats/task/draft.h"

#include <algorithm>
#include <vector>

#include "formats/task/world.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

// What the benchmark's simple tasks have.
constexpr int episode_steps = 500;
constexpr int floor_width = 5;
constexpr int usual_width = 5;  // of a robot

// The lowest cell above all that stands in the first columns.
int free_row(const std::vector<Placement>& scenery) {
  int row = 0;
  for (const Placement& placement : scenery) {
    const Object& object = placement.object;
    if (object.x < usual_width) row = std::max(row, object.y + object.body.rows);
  }
  return row;
}

// As a task may be called: in one word.
std::string one_word(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c <= ' ' && c >= 0; }, '-');
  return name;
}

}  // namespace

std::string draft_task(const World& world, const std::string& name) {
  const Object* robot = nullptr;
  std::vector<Placement> scenery;
  for (const Object& object : world.objects) {
    if (count_actuators(object.body) == 0) {
      scenery.emplace_back().object = object;
    } else if (robot != nullptr) {
      throw error(Failure::data, "objects '{}' and '{}' both have actuators; a task has one robot",
                  robot->name, object.name);
    } else {
      robot = &object;
    }
  }
  return fmt::format(
      "format: evo/task\nversion: 1\nname: {}\nsteps: {}\n\n"
      "robot: {{at: [{}, {}]}}\n\nworld:\n{}\n"
      "observation:\n  - velocity: robot\n  - relative_positions: robot\n  - floor: {{width: "
      "{}}}\n\n"
      "reward:\n  - displacement: {{of: robot, axis: x}}\n\nfollow: [robot]\n",
      yaml_scalar(one_word(name)), episode_steps, robot != nullptr ? robot->x : 0,
      robot != nullptr ? robot->y : free_row(scenery), world_to_yaml(scenery), floor_width);
}

}  // namespace evo
