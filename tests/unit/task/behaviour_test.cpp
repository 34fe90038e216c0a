#include "libevo/task/behaviour.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "formats/task/task.h"
#include "libevo/task/env.h"
#include "tests/unit/sim/fixtures.h"

namespace evo {
namespace {

const DataFolders data{"tasks"};

// A robot of two by two voxels, its lower left corner at (4, `height`), above four cells
// of ground.
Model above_ground(int height) {
  World world;
  world.objects.push_back({"robot", Body::from_rows({"HH", "HH"}), 4, height});
  world.objects.push_back({"ground", Body::from_rows({"####"}), 3, 0});
  return Model(world, {});
}

// The points of the world with the robot's moved, voxels, and stretched about its left
// side.
std::vector<Vec2> moved(const Model& model, Vec2 by, double stretch = 1.0) {
  const double unit = model.physics().voxel_length;
  std::vector<Vec2> points = model.initial_positions();
  const ModelObject& robot = model.objects().front();
  const double left = points[static_cast<std::size_t>(robot.first_point)].x;
  for (int k = robot.first_point; k < robot.first_point + robot.points; ++k) {
    Vec2& p = points[static_cast<std::size_t>(k)];
    p = {left + stretch * (p.x - left) + by.x * unit, p.y + by.y * unit};
  }
  return points;
}

Behaviour after(const Model& model, const std::vector<std::vector<Vec2>>& steps) {
  BehaviourMeter meter;
  meter.add(model, model.initial_positions());
  for (const auto& points : steps) meter.add(model, points);
  return meter.behaviour();
}

// An episode with all targets as the clock says; the rewards are added to `total`.
template <typename Target>
Behaviour simulated(const Arena& arena, int steps, Target target, double& total) {
  VecEnv env(arena, 1);
  env.reset(0, {});
  BehaviourMeter meter;
  meter.add(env.model(0), env.positions(0));
  std::vector<double> targets(static_cast<std::size_t>(arena.action_length()));
  for (int step = 0; step < steps; ++step) {
    for (std::size_t k = 0; k < targets.size(); ++k) targets[k] = target(step, k);
    env.step(targets);
    total += env.rewards()[0];
    meter.add(env.model(0), env.positions(0));
  }
  return meter.behaviour();
}

}  // namespace

TEST_CASE("a robot at rest goes nowhere, and one that lies in the air is aloft") {
  const Model lying = above_ground(1);
  const auto still = [](const Model& model) {
    return after(model, {model.initial_positions(), model.initial_positions()});
  };
  const Behaviour rest = still(lying);
  CHECK(rest.distance == 0.0);
  CHECK(rest.rise == 0.0);
  CHECK(rest.aloft == 0.0);
  CHECK(rest.width == Approx(1.0).margin(1e-12));
  CHECK(still(above_ground(2)).aloft == 1.0);
}

TEST_CASE("what is measured of a path that is known") {
  const Model model = above_ground(1);
  const Behaviour hop = after(model, {moved(model, {0.5, 0.25}), moved(model, {1.0, 0.75}),
                                      moved(model, {1.0, 0.05}), moved(model, {-1.5, 0.0})});
  CHECK(hop.distance == Approx(-1.5).margin(1e-12));
  CHECK(hop.rise == Approx(0.75).margin(1e-12));
  CHECK(hop.aloft == 0.5);  // 0.05 voxels are within the reach of contacts
  const Behaviour stretched = after(model, {moved(model, {}, 1.5), moved(model, {}, 1.0),
                                            moved(model, {}, 0.5), moved(model, {}, 2.0)});
  CHECK(stretched.width == Approx(1.25).margin(1e-12));
  CHECK(stretched.rise == 0.0);
}

TEST_CASE("an episode without a step tells nothing") {
  const Behaviour none = BehaviourMeter().behaviour();
  CHECK(none.distance == 0.0);
  CHECK(none.width == 1.0);
}

TEST_CASE("another object touches a robot as the ground does") {
  World world;
  world.objects.push_back({"robot", Body::from_rows({"HH"}), 4, 5});
  world.objects.push_back({"package", Body::from_rows({"RR"}), 4, 6});
  const Model model(world, {});
  CHECK(after(model, {model.initial_positions()}).aloft == 0.0);
}

TEST_CASE("a robot that falls is aloft until it lands, and has not risen") {
  TaskSpec task = load_task("Walker-v0", data);
  task.robot_y += 3;
  const Arena arena(std::move(task), Body::from_rows({"HHH", "HHH"}));
  const auto still = [](int, std::size_t) { return 1.0; };
  double rewards = 0.0;
  CHECK(simulated(arena, 5, still, rewards).aloft == 1.0);
  const Behaviour landed = simulated(arena, 100, still, rewards);
  CHECK(landed.aloft > 0.05);
  CHECK(landed.aloft < 0.9);
  CHECK(landed.rise == 0.0);
  CHECK(landed.distance == Approx(0.0).margin(0.1));
}

TEST_CASE("a walker comes as far as its task says") {
  const Arena arena(load_task("Walker-v0", data), body_a());
  const auto wave = [](int step, std::size_t k) {
    return 1.1 + 0.5 * std::sin(0.3 * step + 0.7 * static_cast<double>(k));
  };
  double total = 0.0;  // the task pays the way of the centre, raw units
  const Behaviour walk = simulated(arena, 200, wave, total);
  CHECK(std::abs(total) > 0.1);
  CHECK(walk.distance * arena.model().physics().voxel_length == Approx(total).margin(1e-9));
  CHECK(walk.aloft < 1.0);
  CHECK(walk.width > 0.5);
  CHECK(walk.width < 1.5);
}

}  // namespace evo
