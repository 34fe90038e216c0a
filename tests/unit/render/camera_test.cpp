#include "render/scene/camera.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/base/random.h"

namespace evo::render {
namespace {

// Two single cells: a robot that runs and a package that is thrown.
Mesh two_cells() {
  RolloutWorld world;
  world.objects = {{"robot", 0, 4, 0, 1, false}, {"package", 4, 4, 1, 1, false}};
  world.cells = {{0, Voxel::soft, {0, 1, 2, 3}}, {1, Voxel::soft, {4, 5, 6, 7}}};
  return make_mesh(world);
}

void add_cell(std::vector<Vec2>& points, double x, double y) {
  points.insert(points.end(), {{x, y + 1}, {x + 1, y + 1}, {x, y}, {x + 1, y}});
}

std::vector<Vec2> motion(int steps) {
  std::vector<Vec2> points;
  for (int t = 0; t <= steps; ++t) {
    add_cell(points, 0.05 * t + 0.3 * std::sin(0.6 * t), 1 + std::abs(std::sin(0.3 * t)));
    add_cell(points, 0.3 * t, 1 + std::max(0.0, 0.4 * t - 0.002 * t * t));
  }
  return points;
}

bool inside(const ViewRect& view, Vec2 p) {
  return std::abs(p.x - view.centre_x) <= view.width / 2 &&
         std::abs(p.y - view.centre_y) <= view.height / 2;
}

TEST_CASE("followed objects are in view at every step, the camera moves smoothly") {
  const int steps = 300;
  const auto points = motion(steps);
  const std::vector<int> follow = GENERATE(std::vector<int>{0}, std::vector<int>{0, 1});
  const double aspect = GENERATE(16.0 / 9.0, 1.0, 0.5);
  const auto path = camera_path(two_cells(), points, {}, follow, aspect);
  REQUIRE(path.size() == static_cast<std::size_t>(steps) + 1);
  for (std::size_t t = 0; t < path.size(); ++t) {
    CHECK(path[t].width / path[t].height == Approx(aspect));
    for (const int object : follow)
      for (std::size_t k = 0; k < 4; ++k)
        CHECK(inside(path[t], points[8 * t + 4 * static_cast<std::size_t>(object) + k]));
  }
  // The robot shakes by 0.3 voxels at ten times this acceleration.
  for (std::size_t t = 1; t + 1 < path.size(); ++t)
    CHECK(std::abs(path[t + 1].centre_x - 2 * path[t].centre_x + path[t - 1].centre_x) < 0.02);
}

TEST_CASE("earth takes a small part of the picture") {
  const auto points = motion(50);
  const ViewRect view = camera_path(two_cells(), points, {}, {0}, 16.0 / 9.0).front();
  const double low = view.centre_y - view.height / 2;
  CHECK(low < 0);
  CHECK(-low / view.height == Approx(0.14).epsilon(0.01));
}

TEST_CASE("the world camera stands still and sees everything") {
  const auto points = motion(200);
  Camera camera;
  camera.mode = CameraMode::world;
  const auto path = camera_path(two_cells(), points, camera, {0}, 1.5);
  for (const Vec2& p : points) CHECK(inside(path.front(), p));
  CHECK(path.front().centre_x == path.back().centre_x);
}

TEST_CASE("a fixed camera shows at least its window") {
  Camera camera;
  camera.mode = CameraMode::fixed;
  camera.window = {12, 4, 40, 20};
  const auto path = camera_path(two_cells(), motion(2), camera, {0}, 1.0);
  REQUIRE(path.size() == 3);
  CHECK(path[1].centre_x == 12);
  CHECK(path[1].width == 40);
  CHECK(path[1].height == 40);
}

TEST_CASE("zoom brings the robot closer") {
  Camera near;
  near.zoom = 2;
  const auto points = motion(10);
  const double far_width = camera_path(two_cells(), points, {}, {0}, 1.0).front().width;
  CHECK(camera_path(two_cells(), points, near, {0}, 1.0).front().width < 0.7 * far_width);
}

}  // namespace
}  // namespace evo::render
