// What tasks measure in a snapshot: centres, orientation, area, extent of an
// object's points. Raw units unless said otherwise. See docs/tasks.md, "Points and centre" and
// "Orientation".
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libevo/sim/model.h"

namespace evo {

// The points of one object among those of the world.
struct PointRange {
  int first = 0;
  int count = 0;

  template <typename Point>
  std::span<Point> of(std::span<Point> points) const {
    return points.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count));
  }
  std::span<const Vec2> of(const std::vector<Vec2>& points) const { return of(std::span(points)); }
};

// The mean of the points, twice: with each coordinate in voxels (divided by the
// voxel length), and with each turned back into raw units, as rewards use it.
// The detour over voxels changes last bits, on which thresholds may depend.
struct Centre {
  Vec2 raw;
  Vec2 voxels;
};
Centre centre(std::span<const Vec2> points, double voxel_length);

Vec2 mean(std::span<const Vec2> points);  // running sum

// An object at time 0, prepared for comparing later shapes with it.
struct InitialShape {
  InitialShape() = default;
  explicit InitialShape(std::span<const Vec2> points);

  std::vector<Vec2> direction;  // unit vectors from the centre; NaN in the centre
  std::vector<double> radius;
  double radius_sum = 0.0;
};

// How far the object is turned, counter-clockwise, in [0, 2*3.1415926): the
// mean unsigned angle of its points, weighted by radius, reflected where the
// points turn clockwise on the whole. Exactly as released, clamps included.
double orientation(const InitialShape& initial, std::span<const Vec2> points);

// Area of the convex hull. `work` is storage that calls can share.
double hull_area(std::span<const Vec2> points, std::vector<Vec2>& work);

double width(std::span<const Vec2> points);   // max x - min x
double height(std::span<const Vec2> points);  // max y - min y

// ---- derivatives --------------------------------------------------------------------
//
// Add `by`, a derivative by the measure, times the measure's own by every point. Where it has
// an edge, as where another point becomes the outermost, that of one side.

void pull_back_mean(Vec2 by, std::span<Vec2> by_points);
// 0 for points where the released clamps hold.
void pull_back_orientation(const InitialShape& initial, std::span<const Vec2> points, double by,
                           std::span<Vec2> by_points);
void pull_back_hull_area(std::span<const Vec2> points, double by, std::span<Vec2> by_points);
void pull_back_extent(std::span<const Vec2> points, double Vec2::*axis, double by,
                      std::span<Vec2> by_points);

}  // namespace evo
