#include "libevo/task/terrain.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace evo {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

// The bins around a centre, filled with the y nearest to it.
class Bins {
 public:
  Bins(Terrain::Side side, const Vec2& centre, std::span<double> bins)
      : below_(side == Terrain::Side::below),
        centre_(centre),
        width_(0.5 * static_cast<double>(bins.size() - 1)),
        bins_(bins) {
    std::fill(bins.begin(), bins.end(), below_ ? -none : none);
  }

  double left() const { return centre_.x - (width_ + 0.5); }
  double right() const { return centre_.x + (width_ + 0.5); }

  // The bin with x strictly inside, or -1: on an edge there is none. Which it is
  // follows from the released comparisons, not from rounding x - centre.
  int bin(double x) const {
    const double guess = std::floor(x - centre_.x + 0.5);
    for (const double i : {guess, guess - 1.0, guess + 1.0})
      if (std::abs(i) <= width_ && x > centre_.x + (i - 0.5) && x < centre_.x + (i + 0.5))
        return static_cast<int>(i + width_);
    return -1;
  }

  void add(int bin, double y) {
    double& nearest = bins_[static_cast<std::size_t>(bin)];
    if (below_) {
      if (y < centre_.y) nearest = std::max(nearest, y);
    } else {
      if (y > centre_.y) nearest = std::min(nearest, y);
    }
  }

 private:
  bool below_;
  Vec2 centre_;
  double width_;
  std::span<double> bins_;
};

}  // namespace

Terrain::Terrain(const Model& model, const std::vector<int>& objects, const std::vector<int>& drawn)
    : voxel_length_(model.physics().voxel_length) {
  std::vector<Vec2> points;
  for (const int index : objects) {
    const ModelObject& object = model.objects()[static_cast<std::size_t>(index)];
    const PointRange range{object.first_point, object.points};
    if (!object.is_static || std::find(drawn.begin(), drawn.end(), index) != drawn.end()) {
      moving_.push_back(range);
      continue;
    }
    for (const Vec2& p : range.of(model.initial_positions())) points.push_back(p / voxel_length_);
  }
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  for (const Vec2& p : points) {
    if (columns_.empty() || columns_.back().x != p.x)
      columns_.push_back({p.x, y_.size(), y_.size()});
    y_.push_back(p.y);
    columns_.back().last = y_.size();
  }
}

void Terrain::clearance(Side side, const Vec2& centre, double range,
                        std::span<const Vec2> positions, std::span<double> distances) const {
  Bins bins(side, centre, distances);

  const auto begin = std::upper_bound(columns_.begin(), columns_.end(), bins.left(),
                                      [](double x, const Column& column) { return x < column.x; });
  for (auto column = begin; column != columns_.end() && column->x < bins.right(); ++column) {
    const int bin = bins.bin(column->x);
    if (bin < 0) continue;
    const double* first = y_.data() + column->first;
    const double* last = y_.data() + column->last;
    // The neighbours of centre.y in the column: the largest y below, the
    // smallest above.
    const double* at = side == Side::below ? std::lower_bound(first, last, centre.y)
                                           : std::upper_bound(first, last, centre.y);
    if (side == Side::below && at != first) bins.add(bin, *(at - 1));
    if (side == Side::above && at != last) bins.add(bin, *at);
  }

  for (const PointRange& object : moving_) {
    for (const Vec2& p : object.of(positions)) {
      const double x = p.x / voxel_length_;
      if (!(x > bins.left() && x < bins.right())) continue;
      const int bin = bins.bin(x);
      if (bin >= 0) bins.add(bin, p.y / voxel_length_);
    }
  }

  for (double& value : distances) {
    const bool below = side == Side::below;
    if (std::isinf(value)) value = below ? (0.0 - range) + centre.y : (0.0 + range) + centre.y;
    const double distance = below ? centre.y - value : value - centre.y;
    value = std::clamp(distance, 0.0, range) * voxel_length_;
  }
}

double Terrain::pull_back(Side side, const Vec2& centre, double range,
                          std::span<const Vec2> positions, std::span<const double> by_bins,
                          std::span<Vec2> by_positions) const {
  std::vector<double> distances(by_bins.size());
  clearance(side, centre, range, positions, distances);
  const double up = side == Side::below ? 1.0 : -1.0;  // does it grow as the robot rises?
  const auto ends_within = [&](double distance) {
    return distance > 0.0 && distance < range * voxel_length_;
  };
  double by_height = 0.0;
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (ends_within(distances[i])) by_height += up * voxel_length_ * by_bins[i];

  // The point that a bin ends at, if it moves.
  std::vector<double> unused(distances.size());
  const Bins bins(side, centre, unused);
  constexpr double rounding = 1e-12;
  for (const PointRange& object : moving_)
    for (int p = object.first; p < object.first + object.count; ++p) {
      const auto at = static_cast<std::size_t>(p);
      const double x = positions[at].x / voxel_length_;
      if (!(x > bins.left() && x < bins.right())) continue;
      const int bin = bins.bin(x);
      if (bin < 0) continue;
      const auto i = static_cast<std::size_t>(bin);
      const double distance = up * (centre.y - positions[at].y / voxel_length_) * voxel_length_;
      if (ends_within(distances[i]) && std::abs(distance - distances[i]) < rounding)
        by_positions[at].y -= up * by_bins[i];
    }
  return by_height;
}

}  // namespace evo
