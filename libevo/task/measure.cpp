#include "libevo/task/measure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "libevo/base/elementary.h"

namespace evo {

Centre centre(std::span<const Vec2> points, double voxel_length) {
  Centre sum;
  for (const Vec2& p : points) {
    const Vec2 at = p / voxel_length;
    sum.voxels += at;
    sum.raw += at * voxel_length;
  }
  const auto n = static_cast<double>(points.size());
  return {sum.raw / n, sum.voxels / n};
}

Vec2 mean(std::span<const Vec2> points) {
  Vec2 sum;
  for (const Vec2& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

// ---- orientation ------------------------------------------------------------

namespace {

constexpr double released_pi = 3.1415926;  // seven decimals
constexpr double clamped_cosine = 0.99999;
constexpr double tiny_lengths = 1e-7;

// The mean with the released build's order of summation: the first value, then
// blocks of four as (v1+v2)+(v3+v4), then what is left.
Vec2 blocked_mean(std::span<const Vec2> p) {
  Vec2 sum = p[0];
  std::size_t i = 1;
  for (; i + 4 <= p.size(); i += 4) sum += (p[i] + p[i + 1]) + (p[i + 2] + p[i + 3]);
  for (; i < p.size(); ++i) sum += p[i];
  return sum / static_cast<double>(p.size());
}

}  // namespace

InitialShape::InitialShape(std::span<const Vec2> points) {
  const Vec2 c = blocked_mean(points);
  direction.reserve(points.size());
  radius.reserve(points.size());
  for (const Vec2& p : points) {
    const Vec2 w = p - c;
    const double b = norm(w);
    direction.push_back(w / b);
    radius.push_back(b);
    radius_sum += b;
  }
}

double orientation(const InitialShape& initial, std::span<const Vec2> points) {
  const Vec2 c = blocked_mean(points);
  double angles = 0.0;
  double turning = 0.0;  // > 0: clockwise; NaN, so not > 0, for a point in the centre
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 u = points[i] - c;
    const double a = norm(u);
    const double b = initial.radius[i];
    const Vec2 U = u / a;
    const Vec2 W = initial.direction[i];
    double cosine = dot(U, W);
    if (a * b < tiny_lengths) cosine = clamped_cosine;
    if (cosine > 1.0) cosine = clamped_cosine;
    if (cosine < -1.0) cosine = -clamped_cosine;
    angles += b * math::acos(cosine);
    turning += cross(U, W);
  }
  const double angle = angles / initial.radius_sum;
  return turning > 0.0 ? 2.0 * released_pi - angle : angle;
}

// ---- shape --------------------------------------------------------------------

namespace {

// Of the triangle o, a, b; positive counter-clockwise.
double twice_area(Vec2 o, Vec2 a, Vec2 b) { return cross(a - o, b - o); }

// Andrew's monotone chain: counter-clockwise from the leftmost point. `work` holds the hull.
std::span<const Vec2> convex_hull(std::span<const Vec2> points, std::vector<Vec2>& work) {
  const std::size_t n = points.size();
  work.assign(points.begin(), points.end());
  std::sort(work.begin(), work.end(),
            [](const Vec2& a, const Vec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  work.resize(n + 2 * n);  // sorted points, then the hull
  Vec2* hull = work.data() + n;
  std::size_t size = 0;
  const auto add = [&](const Vec2& p, std::size_t chain) {
    while (size >= chain + 2 && twice_area(hull[size - 2], hull[size - 1], p) <= 0.0) --size;
    hull[size++] = p;
  };
  for (std::size_t i = 0; i < n; ++i) add(work[i], 0);
  const std::size_t upper = size - 1;  // the upper chain starts at the rightmost point
  for (std::size_t i = n - 1; i-- > 0;) add(work[i], upper);
  return {hull, size};  // the first point is its last, too
}

double extent(std::span<const Vec2> points, double Vec2::*axis) {
  double low = points[0].*axis;
  double high = low;
  for (const Vec2& p : points) {
    low = std::min(low, p.*axis);
    high = std::max(high, p.*axis);
  }
  return high - low;
}

}  // namespace

// The sum of the triangles that hull points make with the leftmost one.
double hull_area(std::span<const Vec2> points, std::vector<Vec2>& work) {
  if (points.size() < 3) return 0.0;
  const std::span<const Vec2> hull = convex_hull(points, work);
  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i)
    twice += twice_area(hull[0], hull[i], hull[i + 1]);
  return 0.5 * twice;
}

double width(std::span<const Vec2> points) { return extent(points, &Vec2::x); }
double height(std::span<const Vec2> points) { return extent(points, &Vec2::y); }

// ---- derivatives --------------------------------------------------------------------

void pull_back_mean(Vec2 by, std::span<Vec2> by_points) {
  const auto n = static_cast<double>(by_points.size());
  for (Vec2& p : by_points) p += by / n;
}

// The angle of a point grows as it moves away from its first direction, square to its own.
void pull_back_orientation(const InitialShape& initial, std::span<const Vec2> points, double by,
                           std::span<Vec2> by_points) {
  if (by == 0.0) return;
  const Vec2 c = blocked_mean(points);
  std::vector<Vec2> by_offset(points.size());
  Vec2 by_centre;
  double turning = 0.0;  // as in orientation()
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 u = points[i] - c;
    const Vec2 w = initial.direction[i];
    const double a = norm(u);
    const double across = cross(w, u);
    turning -= across / a;
    const double cosine = dot(u, w) / a;
    if (a * initial.radius[i] < tiny_lengths || !(std::abs(cosine) <= 1.0)) continue;
    const double share =
        (across < 0.0 ? -by : by) * initial.radius[i] / (initial.radius_sum * a * a);
    by_offset[i] = {-u.y * share, u.x * share};
    by_centre = by_centre - by_offset[i];
  }
  const double sign = turning > 0.0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < points.size(); ++i) by_points[i] += by_offset[i] * sign;
  pull_back_mean(by_centre * sign, by_points);
}

void pull_back_hull_area(std::span<const Vec2> points, double by, std::span<Vec2> by_points) {
  if (points.size() < 3 || by == 0.0) return;
  std::vector<Vec2> work;
  const std::span<const Vec2> hull = convex_hull(points, work);
  const std::size_t corners = hull.size() - 1;
  for (std::size_t i = 0; i < corners; ++i) {
    const Vec2 before = hull[(i + corners - 1) % corners];
    const Vec2 after = hull[i + 1];
    const auto at = std::find(points.begin(), points.end(), hull[i]);
    Vec2& by_point = by_points[static_cast<std::size_t>(at - points.begin())];
    by_point.x += 0.5 * by * (after.y - before.y);
    by_point.y += 0.5 * by * (before.x - after.x);
  }
}

void pull_back_extent(std::span<const Vec2> points, double Vec2::*axis, double by,
                      std::span<Vec2> by_points) {
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(),
                          [&](const Vec2& a, const Vec2& b) { return a.*axis < b.*axis; });
  by_points[static_cast<std::size_t>(high - points.begin())].*axis += by;
  by_points[static_cast<std::size_t>(low - points.begin())].*axis -= by;
}

}  // namespace evo
