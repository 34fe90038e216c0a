#include "tests/unit/render/example.h"

#include <cmath>

#include "formats/task/task.h"
#include "libevo/sim/batch.h"
#include "libevo/task/measure.h"

namespace evo::example {

const std::vector<std::string> walker{"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"};
const std::vector<std::string> small_box{"HSH", "VRV", "V.V"};

TaskSpec task(const std::string& name) { return load_task(name, {"tasks"}); }

Model build(const TaskSpec& task, const std::vector<std::string>& body) {
  World world;
  world.objects.push_back({robot_name, Body::from_rows(body), task.robot_x, task.robot_y});
  for (const Placement& placement : task.objects) world.objects.push_back(placement.object);
  return {world, task.physics};
}

Rollout simulate(const std::string& name, const std::vector<std::string>& body, int steps) {
  const TaskSpec spec = task(name);
  const Model model = build(spec, body);
  Rollout rollout;
  rollout.task = spec.name;
  rollout.task_yaml = spec.source;
  rollout.robot = Robot(Body::from_rows(body));
  rollout.action_length = model.actuators();
  rollout.points = model.points();
  rollout.world = {model.objects(), model.cells()};
  RolloutEpisode& episode = rollout.episodes.emplace_back();
  Batch batch(1);
  batch.place(0, model);
  std::vector<Vec2> positions = model.initial_positions();
  std::vector<Vec2> velocities(positions.size());
  episode.positions = positions;
  for (int t = 0; t < steps; ++t) {
    const std::span<double> targets = batch.targets(0);
    for (std::size_t k = 0; k < targets.size(); ++k) {
      constexpr double amplitude = 0.5;
      constexpr double period = 20;  // steps
      constexpr double phase = 0.7;  // between neighbours
      targets[k] = 1.1 + amplitude * std::sin(6.283185307179586 * t / period +
                                              phase * static_cast<double>(k));
    }
    episode.actions.insert(episode.actions.end(), targets.begin(), targets.end());
    batch.step();
    const PointRange robot{model.objects().front().first_point, model.objects().front().points};
    const double before = mean(robot.of(positions)).x;
    batch.read_moving(0, positions, velocities);
    episode.positions.insert(episode.positions.end(), positions.begin(), positions.end());
    episode.rewards.push_back(mean(robot.of(positions)).x - before);
    episode.terminations.push_back(0);
    episode.truncations.push_back(0);
  }
  return rollout;
}

Rollout moved(Rollout rollout, const Place& place) {
  const ModelObject& robot = rollout.world.objects.front();
  auto& positions = rollout.episodes[0].positions;
  const auto points = static_cast<std::size_t>(rollout.points);
  const std::vector<Vec2> start(positions.begin(),
                                positions.begin() + static_cast<std::ptrdiff_t>(points));
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const auto point = static_cast<int>(k % points);
    if (point < robot.first_point || point >= robot.first_point + robot.points) continue;
    positions[k] = place(start[k % points], positions[k], static_cast<int>(k / points));
  }
  return rollout;
}

Rollout carried(Rollout rollout, Vec2 a_step) {
  return moved(std::move(rollout), [&](Vec2 /*start*/, Vec2 now, int step) {
    return Vec2{now.x + a_step.x * step, now.y + a_step.y * step};
  });
}

}  // namespace evo::example
