// The geometry that contact is about: points and cells of one environment. Private to
// libevo/sim.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "libevo/sim/contact.h"

namespace evo::contact {

// ---- small geometry --------------------------------------------------------------

inline constexpr double reach_slack = 1e-9;  // raw length, far above all roundings

// Boxes that touch overlap.
inline bool within(const Box& a, const Box& b, double gap) {
  return a.low.x - gap <= b.high.x && b.low.x - gap <= a.high.x && a.low.y - gap <= b.high.y &&
         b.low.y - gap <= a.high.y;
}
// Along the axis on which they are farther apart; 0 for what is not a number.
inline double gap(const Box& a, const Box& b) {
  const double x = std::max(a.low.x - b.high.x, b.low.x - a.high.x);
  const double y = std::max(a.low.y - b.high.y, b.low.y - a.high.y);
  return std::max({0.0, x, y});
}
inline bool within(Vec2 p, const Box& b, double gap) {
  return b.low.x - gap <= p.x && p.x <= b.high.x + gap && b.low.y - gap <= p.y &&
         p.y <= b.high.y + gap;
}

// ---- points of the world -----------------------------------------------------------

class Points {
 public:
  Points(const Model::Compiled& world, const PointView& view)
      : view_(view), sites_(world.plan.sites), terrain_(world.static_points.data()) {}

  bool moves(std::int32_t site) const { return site < sites_; }
  Vec2 operator()(std::int32_t site) const {
    if (!moves(site)) return terrain_[site - sites_];
    const double* p = view_.position + pair_offset(site, view_.stride);
    return {p[0], p[view_.stride]};
  }
  Vec2 previous(std::int32_t site) const {
    if (!moves(site)) return (*this)(site);
    const double* p = view_.previous + pair_offset(site, view_.stride);
    return {p[0], p[view_.stride]};
  }
  void add_force(std::int32_t site, Vec2 f) const {
    if (!moves(site)) return;
    double* const at = force(site);
    at[0] += f.x;
    at[view_.stride] += f.y;
  }
  double* force(std::int32_t site) const {
    return view_.force + pair_offset(site, view_.stride);
  }  // of one that moves
  double travel(std::uint32_t block) const { return view_.travel[block * view_.stride]; }
  Box box(const SurfaceCell& c) const {
    const Vec2 tl = (*this)(c.corners[top_left]);
    const Vec2 tr = (*this)(c.corners[top_right]);
    const Vec2 bl = (*this)(c.corners[bottom_left]);
    const Vec2 br = (*this)(c.corners[bottom_right]);
    const auto [x0, x1] = std::minmax({tl.x, tr.x, bl.x, br.x});
    const auto [y0, y1] = std::minmax({tl.y, tr.y, bl.y, br.y});
    return {{x0, y0}, {x1, y1}};
  }

 private:
  PointView view_;
  std::int32_t sites_;
  const Vec2* terrain_;
};

}  // namespace evo::contact
