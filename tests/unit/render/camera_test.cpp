#include "render/scene/camera.h"

#include <catch2/catch.hpp>
#include <cmath>

namespace evo::render {
namespace {

Bounds cell(double x, double y) { return {x, x + 1, y, y + 1}; }

// Around a robot that runs, and around it and a package that is thrown.
std::vector<Bounds> motion(int steps, bool package = false) {
  std::vector<Bounds> boxes;
  for (int t = 0; t <= steps; ++t) {
    boxes.push_back(cell(0.05 * t + 0.3 * std::sin(0.6 * t), 1 + std::abs(std::sin(0.3 * t))));
    if (package) boxes.back().cover(cell(0.3 * t, 1 + std::max(0.0, 0.4 * t - 0.002 * t * t)));
  }
  return boxes;
}

bool inside(const ViewRect& view, const Bounds& box) {
  return box.x0 >= view.centre_x - view.width / 2 && box.x1 <= view.centre_x + view.width / 2 &&
         box.y0 >= view.centre_y - view.height / 2 && box.y1 <= view.centre_y + view.height / 2;
}

TEST_CASE("followed objects are in view at every step, the camera moves smoothly") {
  const int steps = 300;
  const auto boxes = motion(steps, GENERATE(false, true));
  const double aspect = GENERATE(16.0 / 9.0, 1.0, 0.5);
  const auto path = camera_path(boxes, {}, aspect);
  REQUIRE(path.size() == static_cast<std::size_t>(steps) + 1);
  for (std::size_t t = 0; t < path.size(); ++t) {
    CHECK(path[t].width / path[t].height == Approx(aspect));
    CHECK(inside(path[t], boxes[t]));
  }
  // The robot shakes by 0.3 voxels at ten times this acceleration.
  for (std::size_t t = 1; t + 1 < path.size(); ++t)
    CHECK(std::abs(path[t + 1].centre_x - 2 * path[t].centre_x + path[t - 1].centre_x) < 0.02);
}

TEST_CASE("earth takes a small part of the picture") {
  const ViewRect view = camera_path(motion(50), {}, 16.0 / 9.0).front();
  const double low = view.centre_y - view.height / 2;
  CHECK(low < 0);
  CHECK(-low / view.height == Approx(0.14).epsilon(0.01));
}

TEST_CASE("the world camera stands still and sees everything") {
  const auto boxes = motion(200, true);
  Camera camera;
  camera.mode = CameraMode::world;
  const auto path = camera_path(boxes, camera, 1.5);
  for (const Bounds& box : boxes) CHECK(inside(path.front(), box));
  CHECK(path.front().centre_x == path.back().centre_x);
}

TEST_CASE("a fixed camera shows at least its window") {
  Camera camera;
  camera.mode = CameraMode::fixed;
  camera.window = {12, 4, 40, 20};
  const auto path = camera_path(motion(2), camera, 1.0);
  REQUIRE(path.size() == 3);
  CHECK(path[1].centre_x == 12);
  CHECK(path[1].width == 40);
  CHECK(path[1].height == 40);
}

TEST_CASE("zoom brings the robot closer") {
  Camera near;
  near.zoom = 2;
  const double far_width = camera_path(motion(10), {}, 1.0).front().width;
  CHECK(camera_path(motion(10), near, 1.0).front().width < 0.7 * far_width);
}

}  // namespace
}  // namespace evo::render
