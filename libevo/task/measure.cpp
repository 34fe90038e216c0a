#include "libevo/task/measure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "libevo/base/elementary.h"

namespace evo {

Centre centre(std::span<const Vec2> points, double voxel_length) {
  Centre sum;
  for (const Vec2& p : points) {
    const double x = p.x / voxel_length;
    const double y = p.y / voxel_length;
    sum.voxels.x += x;
    sum.voxels.y += y;
    sum.raw.x += x * voxel_length;
    sum.raw.y += y * voxel_length;
  }
  const auto n = static_cast<double>(points.size());
  return {{sum.raw.x / n, sum.raw.y / n}, {sum.voxels.x / n, sum.voxels.y / n}};
}

Vec2 mean(std::span<const Vec2> points) {
  Vec2 sum;
  for (const Vec2& p : points) {
    sum.x += p.x;
    sum.y += p.y;
  }
  const auto n = static_cast<double>(points.size());
  return {sum.x / n, sum.y / n};
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
  for (; i + 4 <= p.size(); i += 4) {
    sum.x += (p[i].x + p[i + 1].x) + (p[i + 2].x + p[i + 3].x);
    sum.y += (p[i].y + p[i + 1].y) + (p[i + 2].y + p[i + 3].y);
  }
  for (; i < p.size(); ++i) {
    sum.x += p[i].x;
    sum.y += p[i].y;
  }
  const auto n = static_cast<double>(p.size());
  return {sum.x / n, sum.y / n};
}

}  // namespace

InitialShape::InitialShape(std::span<const Vec2> points) {
  const Vec2 c = blocked_mean(points);
  direction.reserve(points.size());
  radius.reserve(points.size());
  for (const Vec2& p : points) {
    const Vec2 w{p.x - c.x, p.y - c.y};
    const double b = math::sqrt(w.x * w.x + w.y * w.y);
    direction.push_back({w.x / b, w.y / b});
    radius.push_back(b);
    radius_sum += b;
  }
}

double orientation(const InitialShape& initial, std::span<const Vec2> points) {
  const Vec2 c = blocked_mean(points);
  double angles = 0.0;
  double turning = 0.0;  // > 0: clockwise; NaN, so not > 0, for a point in the centre
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2 u{points[i].x - c.x, points[i].y - c.y};
    const double a = math::sqrt(u.x * u.x + u.y * u.y);
    const double b = initial.radius[i];
    const Vec2 U{u.x / a, u.y / a};
    const Vec2 W = initial.direction[i];
    double cosine = U.x * W.x + U.y * W.y;
    if (a * b < tiny_lengths) cosine = clamped_cosine;
    if (cosine > 1.0) cosine = clamped_cosine;
    if (cosine < -1.0) cosine = -clamped_cosine;
    angles += b * math::acos(cosine);
    turning += U.x * W.y - U.y * W.x;
  }
  const double angle = angles / initial.radius_sum;
  return turning > 0.0 ? 2.0 * released_pi - angle : angle;
}

// ---- shape --------------------------------------------------------------------

namespace {

// Twice the area of the triangle o, a, b; positive counter-clockwise.
double cross(const Vec2& o, const Vec2& a, const Vec2& b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

}  // namespace

// Andrew's monotone chain; as each hull point is settled, so is its triangle
// with the leftmost point.
double hull_area(std::span<const Vec2> points, std::vector<Vec2>& work) {
  const std::size_t n = points.size();
  if (n < 3) return 0.0;
  work.assign(points.begin(), points.end());
  std::sort(work.begin(), work.end(),
            [](const Vec2& a, const Vec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  work.resize(n + 2 * n);  // sorted points, then the hull
  Vec2* hull = work.data() + n;
  std::size_t size = 0;
  const auto add = [&](const Vec2& p, std::size_t chain) {
    while (size >= chain + 2 && cross(hull[size - 2], hull[size - 1], p) <= 0.0) --size;
    hull[size++] = p;
  };
  for (std::size_t i = 0; i < n; ++i) add(work[i], 0);
  const std::size_t upper = size - 1;  // the upper chain starts at the rightmost point
  for (std::size_t i = n - 1; i-- > 0;) add(work[i], upper);

  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < size; ++i) twice += cross(hull[0], hull[i], hull[i + 1]);
  return 0.5 * twice;
}

double width(std::span<const Vec2> points) {
  double low = points[0].x;
  double high = points[0].x;
  for (const Vec2& p : points) {
    low = std::min(low, p.x);
    high = std::max(high, p.x);
  }
  return high - low;
}

double height(std::span<const Vec2> points) {
  double low = points[0].y;
  double high = points[0].y;
  for (const Vec2& p : points) {
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  }
  return high - low;
}

}  // namespace evo
