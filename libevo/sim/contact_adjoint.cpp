#include "libevo/sim/contact_adjoint.h"

#include <algorithm>
#include <cmath>

#include "libevo/base/elementary.h"
#include "libevo/sim/adjoint.h"
#include "libevo/sim/contact_geometry.h"

namespace evo {

using contact::Points;

// A corner that is not due for longer than `reach` is farther away than that.
void find_missed(const Model::Compiled& world, const ContactLists& lists, const PointView& view,
                 double reach, std::vector<Touch>& touches) {
  const Points points(world, view);
  for (const ContactGroup& group : lists.groups) {
    const double within = points.travel(group.blocks[0]) + points.travel(group.blocks[1]) + reach;
    if (within < group.due) continue;
    for (std::uint32_t i = group.first; i < group.last; ++i) {
      if (within < lists.pairs.due[i]) continue;
      const auto& [corner, other] = lists.pairs.all[i];
      const SurfaceCell& cell = world.surface[other];
      const std::int32_t point = world.surface[corner / 4].corners[corner % 4];
      for (std::size_t side = 0; side < 4; ++side) {
        if (!cell.surface[side]) continue;
        const Vec2 a = points(cell.edges[side][0]);
        const Vec2 along = points(cell.edges[side][1]) - a;
        const Vec2 from_a = points(point) - a;
        const double foot = dot(along, from_a);
        if (foot < 0.0 || foot > dot(along, along)) continue;
        const double height = cross(along, from_a) / norm(along);
        if (height > 0.0 && height < reach)
          touches.push_back({0, point, cell.edges[side], false, true});
      }
    }
  }
}

namespace {

// Derivatives of sum_i (force on i) . (derivative by it), by where the three points are.
class TouchAdjoint {
 public:
  TouchAdjoint(const Model::Compiled& world, const PointView& view, const ContactAdjoint& adjoint)
      : physics_(world.physics), points_(world, view), stride_(view.stride), adjoint_(adjoint) {}

  // n is the edge's normal, t its direction; the corner is pushed by N n, damped, and rubbed
  // along t, and each end of the edge by half of that, the other way.
  void pull_back(const Touch& touch, double onset) const {
    const auto [a, b] = touch.edge;
    const std::int32_t p = touch.point;
    const double times = touch.is_within ? 2.0 : 1.0;
    const Vec2 along = points_(b) - points_(a);
    const double length = norm(along);
    const Vec2 n = Vec2{-along.y, along.x} / length;
    const Vec2 t{-n.y, n.x};
    const Vec2 from_a = points_(p) - points_(a);
    const double height = dot(n, from_a);
    const double depth = touch.is_missed ? 0.0 : std::abs(height);

    const double damping = physics_.contact_damping;
    const double rub = physics_.friction_multiplier * physics_.friction_coefficient;
    const double normal_force = physics_.contact_stiffness * (depth + physics_.contact_margin);
    const Vec2 up = velocity(p), ua = velocity(a), ub = velocity(b);
    const Vec2 gp = by_force(p) * times, ga = by_force(a) * times, gb = by_force(b) * times;
    const Vec2 g = gp - (ga + gb) * 0.5;
    const double slip = dot(t, up);
    const double sliding = slip / (physics_.friction_coefficient * normal_force);
    const double grip = math::reference_tanh(sliding);
    const double friction = -rub * normal_force * grip;
    const double n_up = dot(n, up), n_ua = dot(n, ua), n_ub = dot(n, ub);
    const double n_gp = dot(n, gp), n_ga = dot(n, ga), n_gb = dot(n, gb);
    const double n_g = dot(n, g), t_g = dot(t, g);

    // What there would be less without this touch, spread over depths of -onset to onset.
    if (onset > 0.0 && !touch.is_within && depth < onset) {
      const double all = normal_force * n_g - damping * n_up * n_gp -
                         0.5 * damping * (n_ua * n_ga + n_ub * n_gb) + friction * t_g;
      const Vec2 by_depth = n * (all / (2.0 * onset));
      add(p, by_depth * -1.0);
      add(a, by_depth * 0.5);
      add(b, by_depth * 0.5);
    }
    if (touch.is_missed) return;

    const double slope = 1.0 - grip * grip;
    const double by_normal_force = n_g - t_g * rub * (grip - sliding * slope);
    add(GradientConstant::contact_stiffness, by_normal_force * (depth + physics_.contact_margin));
    add(GradientConstant::contact_damping, -n_up * n_gp - 0.5 * (n_ua * n_ga + n_ub * n_gb));
    add(GradientConstant::friction_multiplier,
        -t_g * physics_.friction_coefficient * normal_force * grip);
    const double by_slip = -t_g * physics_.friction_multiplier * slope;
    const double by_height =
        physics_.contact_stiffness * by_normal_force * (height < 0.0 ? -1.0 : 1.0);
    const Vec2 by_t = g * friction + up * by_slip;
    Vec2 by_n = g * normal_force - (up * n_gp + gp * n_up) * damping -
                (ua * n_ga + ga * n_ua + ub * n_gb + gb * n_ub) * (0.5 * damping);
    by_n = by_n + Vec2{by_t.y, -by_t.x} + from_a * by_height;
    const Vec2 across = (by_n - n * dot(by_n, n)) / length;
    const Vec2 by_along{across.y, -across.x};
    add(p, n * by_height);
    add(a, n * -by_height - by_along);
    add(b, by_along);
    add_velocity(p, n * (-damping * n_gp) + t * by_slip);
    add_velocity(a, n * (-0.5 * damping * n_ga));
    add_velocity(b, n * (-0.5 * damping * n_gb));
  }

 private:
  Vec2 velocity(std::int32_t site) const {
    return (points_(site) - points_.previous(site)) / physics_.substep;
  }
  Vec2 by_force(std::int32_t site) const {
    if (!points_.moves(site)) return {};
    const double* at = adjoint_.by_force + pair_offset(site, stride_);
    return {at[0], at[stride_]};
  }
  void add_to(double* pairs, std::int32_t site, Vec2 v) const {
    if (!points_.moves(site)) return;
    double* const at = pairs + pair_offset(site, stride_);
    at[0] += v.x;
    at[stride_] += v.y;
  }
  void add(GradientConstant which, double by) const {
    adjoint_.by_constants[static_cast<std::size_t>(which) * stride_] += by;
  }
  void add(std::int32_t site, Vec2 v) const { add_to(adjoint_.by_position, site, v); }
  void add_velocity(std::int32_t site, Vec2 v) const {
    add_to(adjoint_.by_position, site, v / physics_.substep);
    add_to(adjoint_.by_previous, site, v / -physics_.substep);
  }

  const Physics& physics_;
  Points points_;
  std::size_t stride_;
  ContactAdjoint adjoint_;
};

}  // namespace

void pull_back_touch(const Model::Compiled& world, const Touch& touch, const PointView& view,
                     double onset, const ContactAdjoint& adjoint) {
  TouchAdjoint(world, view, adjoint).pull_back(touch, onset);
}

}  // namespace evo
