#include "libevo/task/measure.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libevo/base/random.h"

using namespace evo;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double released_pi = 3.1415926;

std::vector<Vec2> random_points(int n, std::uint64_t index) {
  Stream stream(5, "test/measure", index);
  std::vector<Vec2> points;
  for (int i = 0; i < n; ++i) points.push_back({stream.uniform(), stream.uniform()});
  return points;
}

std::vector<Vec2> turned(const std::vector<Vec2>& points, double angle, Vec2 shift = {}) {
  std::vector<Vec2> result;
  for (const Vec2& p : points)
    result.push_back({std::cos(angle) * p.x - std::sin(angle) * p.y + shift.x,
                      std::sin(angle) * p.x + std::cos(angle) * p.y + shift.y});
  return result;
}

}  // namespace

TEST_CASE("the centre is the mean, in voxels and through voxels") {
  const auto points = random_points(7, 0);
  Vec2 voxels, raw;
  for (const Vec2& p : points) {
    voxels.x += p.x / 0.1;
    voxels.y += p.y / 0.1;
    raw.x += p.x / 0.1 * 0.1;
    raw.y += p.y / 0.1 * 0.1;
  }
  const Centre c = centre(points, 0.1);
  CHECK(c.voxels.x == voxels.x / 7.0);
  CHECK(c.voxels.y == voxels.y / 7.0);
  CHECK(c.raw.x == raw.x / 7.0);
  CHECK(c.raw.y == raw.y / 7.0);
}

TEST_CASE("a rigid turn is its own orientation") {
  const auto points = random_points(9, 1);
  const InitialShape initial(points);
  for (const double angle : {0.01, 0.5, 1.5, 3.0}) {
    const Vec2 shift{3.0, -1.0};
    CHECK(orientation(initial, turned(points, angle, shift)) == Approx(angle).margin(1e-9));
    CHECK(orientation(initial, turned(points, -angle, shift)) ==
          Approx(2.0 * released_pi - angle).margin(1e-9));
  }
  CHECK(orientation(initial, turned(points, 1.5 * pi)) ==
        Approx(2.0 * released_pi - 0.5 * pi).margin(1e-9));
}

TEST_CASE("the clamps make the orientation at the start a little more than 0") {
  const double clamp = std::acos(0.99999);
  for (std::uint64_t index = 0; index < 50; ++index) {
    const auto points = random_points(11, 100 + index);
    const double angle = orientation(InitialShape(points), points);
    CHECK(angle >= 0.0);
    CHECK(angle <= clamp + 1e-12);
  }
}

TEST_CASE("a point in the centre switches the reflection off") {
  // Exact numbers, so that the centre is hit exactly.
  const std::vector<Vec2> square{{0, 0}, {4, 0}, {0, 4}, {4, 4}, {2, 2}};
  const InitialShape initial(square);
  const std::vector<Vec2> clockwise{{0, 4}, {0, 0}, {4, 4}, {4, 0}, {2, 2}};  // a quarter turn
  CHECK(orientation(initial, clockwise) == Approx(pi / 2.0));
  const std::vector<Vec2> corners(square.begin(), square.end() - 1);
  const std::vector<Vec2> turned_corners(clockwise.begin(), clockwise.end() - 1);
  CHECK(orientation(InitialShape(corners), turned_corners) == Approx(2.0 * released_pi - pi / 2.0));
}

TEST_CASE("opposite directions are clamped, too") {
  const std::vector<Vec2> points{{-1, 0}, {1, 0}, {0, 0.5}};
  const InitialShape initial(points);
  const double angle = orientation(initial, turned(points, pi));
  CHECK(angle == Approx(pi).margin(0.01));
}

TEST_CASE("the hull area of simple shapes") {
  std::vector<Vec2> work;
  std::vector<Vec2> grid;
  for (int i = 0; i <= 5; ++i)
    for (int j = 0; j <= 3; ++j) grid.push_back({0.1 * i, 0.1 * j});
  CHECK(hull_area(grid, work) == Approx(0.15).epsilon(1e-14));
  CHECK(hull_area(std::vector<Vec2>{{0, 0}, {1, 1}, {2, 2}, {3, 3}}, work) == 0.0);
  CHECK(hull_area(std::vector<Vec2>{{1, 1}, {1, 1}, {1, 1}, {1, 1}}, work) == 0.0);
  CHECK(hull_area(std::vector<Vec2>{{0, 0}, {1, 0}}, work) == 0.0);
}
