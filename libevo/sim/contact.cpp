#include "libevo/sim/contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "libevo/base/elementary.h"
#include "libevo/sim/contact_geometry.h"

namespace evo {
namespace {

using contact::cell_of;
using contact::Points;
using contact::Quad;
using contact::reach_slack;
using contact::Vector;

// ---- inside a cell, or how far from it ----------------------------------------------

// One value for either triangle of a cell: the upper one, which has its top right
// corner, and the lower one, which has its bottom left. (Of GCC and Clang.)
using Two [[gnu::vector_size(2 * sizeof(double))]] = double;
Two smaller(Two a, Two b) { return a < b ? a : b; }
Two larger(Two a, Two b) { return a > b ? a : b; }

// How far the points may move relative to each other before the sign of the cross
// product of u and v can change, but for roundings: x = |u x v| changes by at most
// r (|u| + |v| + r) when both change by r, and r <= x / (|u| + |v|). `size` is that
// sum, or more.
Two reach(Two product, Two size) {
  const Two x = larger(product, -product);
  return x * size / (size * size + x);
}

// Whether p is inside: in one of the two triangles of the cell, borders included.
// The benchmark's test, which only looks at signs. If not, by how much the points
// may move relative to each other, by any path, before it can become true.
struct Clearance {
  bool inside = false;
  double distance = 0.0;
};
// Both triangles at once: which one comes to matter is more than a branch can guess.
Clearance clearance(Vector p, const Quad& q) {
  const auto size = [](Vector v) { return std::abs(v.x) + std::abs(v.y); };
  const Vector tl = q.top_left - p;
  const Vector tr = q.top_right - p;
  const Vector bl = q.bottom_left - p;
  const Vector br = q.bottom_right - p;
  const Two side_x{tr.x, bl.x};
  const Two side_y{tr.y, bl.y};
  const Two first = tl.x * side_y - tl.y * side_x;
  const Two second = side_x * br.y - side_y * br.x;
  const double c = cross(br, tl);
  const auto first_alike = c * first >= 0.0;
  const auto second_alike = c * second >= 0.0;
  const auto inside = first_alike & second_alike;
  if ((inside[0] | inside[1]) != 0) return {true, 0.0};
  const Two none{};
  const Two side_size{size(tr), size(bl)};
  const Two beside = larger(first_alike ? none : reach(first, size(tl) + side_size),
                            second_alike ? none : reach(second, size(br) + side_size));
  const Two all = smaller(beside, reach(none + c, none + (size(tl) + size(br))));
  return {false, std::min(all[0], all[1]) - reach_slack};
}

// ---- pushing -------------------------------------------------------------------------

// For voxels of 0.1 (Model::Compiled::length_scale).
constexpr double parallel_determinant = 1e-4;  // raw area: edges nearer to parallel never cross
constexpr double shortest_edge = 1e-6;         // raw length
constexpr double far_away = 1000.0;            // distance to an edge that is shorter

class Pusher {
 public:
  Pusher(const Model::Compiled& world, const PointView& view)
      : world_(world),
        physics_(world.physics),
        points_(world, view),
        parallel_determinant_(parallel_determinant * world.length_scale * world.length_scale) {}

  // Of the candidates of a group, those that are inside.
  bool push(ContactGroup& group, std::vector<ContactCandidate>& candidates) const {
    const double travel = points_.travel(group.blocks[0]) + points_.travel(group.blocks[1]);
    if (travel < group.due) return false;
    bool any = false;
    group.due = HUGE_VAL;
    for (std::uint32_t i = group.first; i < group.last; ++i) {
      ContactCandidate& candidate = candidates[i];
      if (!(travel < candidate.due)) any |= push(candidate, travel);
      group.due = std::min(group.due, candidate.due);
    }
    return any;
  }

 private:
  using Edge = std::array<std::int32_t, 2>;

  bool push(ContactCandidate& candidate, double travel) const {
    const ContactCell& cell = cell_of(world_, candidate.cell);
    const ContactCell& owner = cell_of(world_, candidate.corner / 4);
    const std::uint32_t corner = candidate.corner % 4;
    const std::int32_t point = owner.corners[corner];
    const Vector p = points_(point);
    const Clearance clear = clearance(p, points_.quad(cell));
    candidate.due = travel + clear.distance;
    if (!clear.inside) return false;

    static constexpr std::array<std::array<Side, 2>, 4> probes{
        {{top, left}, {top, right}, {bottom, left}, {bottom, right}}};
    const Edge& probe1 = owner.edges[probes[corner][0]];
    const Edge& probe2 = owner.edges[probes[corner][1]];
    const Edge* nearest = nullptr;
    double depth = 0.0;
    for (const Side side : {top, right, bottom, left}) {
      if (!cell.surface[side]) continue;
      const Edge& edge = cell.edges[side];
      if (!cross_each_other(probe1, edge) && !cross_each_other(probe2, edge)) continue;
      const double distance = distance_to_line(p, edge);
      if (nearest == nullptr || distance < depth) {
        nearest = &edge;
        depth = distance;
      }
    }
    if (nearest == nullptr) return false;
    apply(point, *nearest, depth);
    return true;
  }

  bool cross_each_other(const Edge& probe, const Edge& edge) const {
    const Vector a1 = points_(probe[0]);
    const Vector a2 = points_(edge[0]);
    const Vector d1 = points_(probe[1]) - a1;
    const Vector d2 = points_(edge[1]) - a2;
    const double det = -d1.x * d2.y + d2.x * d1.y;
    if (std::abs(det) < parallel_determinant_) return false;
    const Vector d = a2 - a1;
    const double t = (-d2.y * d.x + d2.x * d.y) / det;
    const double s = (-d1.y * d.x + d1.x * d.y) / det;
    return t >= 0.0 && t <= 1.0 && s >= 0.0 && s <= 1.0;
  }

  double distance_to_line(Vector p, const Edge& edge) const {
    const Vector a = points_(edge[0]);
    const Vector along = points_(edge[1]) - a;
    const double length = norm(along);
    if (length < shortest_edge * world_.length_scale) return far_away * world_.length_scale;
    return std::abs(cross(along, p - a)) / length;
  }

  // Velocity as friction and damping feel it: strain limiting included.
  Vector true_velocity(std::int32_t site) const {
    return (points_(site) - points_.previous(site)) / physics_.substep;
  }

  // Roundings as in the specification: every product in this order.
  void apply(std::int32_t point, const Edge& edge, double depth) const {
    const auto [a, b] = edge;
    const Vector along = points_(b) - points_(a);
    const Vector n = Vector{-along.y, along.x} / norm(along);
    const Vector force = n * physics_.contact_stiffness * (depth + physics_.contact_margin);
    const Vector velocity = true_velocity(point);
    const auto damping = [&](Vector v) { return n * dot(n, v) * physics_.contact_damping; };
    points_.add_force(point, force - damping(velocity));
    push_back(a, force / 2.0 + damping(true_velocity(a)) / 2.0);
    push_back(b, force / 2.0 + damping(true_velocity(b)) / 2.0);

    Vector t{-n.y, n.x};
    t = t / norm(t);
    double slip = dot(t, velocity);
    if (slip < 0.0) {
      slip = -slip;
      t = t * -1.0;
    }
    const double pressure = norm(force);
    const double grip = math::tanh(slip / (physics_.friction_coefficient * pressure));
    const Vector friction =
        t * -1.0 * physics_.friction_multiplier * physics_.friction_coefficient * pressure * grip;
    points_.add_force(point, friction);
    push_back(a, friction / 2.0);
    push_back(b, friction / 2.0);
  }

  void push_back(std::int32_t site, Vector f) const { points_.add_force(site, f * -1.0); }

  const Model::Compiled& world_;
  const Physics& physics_;
  Points points_;
  double parallel_determinant_;
};

}  // namespace

void prepare_lists(const Model::Compiled& world, ContactLists& lists) {
  lists.self.resize(world.plan.blocks.size());
  for (ContactLists::Self& self : lists.self) {
    self.candidates.clear();
    self.folding.clear();
    self.group = {};
  }
  lists.pairs.clear();
  lists.groups.clear();
  lists.first_group.assign(world.objects.size() + 1, 0);
  lists.invalidate();
}

bool push_contacts(const Model::Compiled& world, ContactLists& lists, const PointView& view) {
  const Pusher pusher(world, view);
  bool any = false;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (world.block[i] >= 0) {
      ContactLists::Self& self = lists.self[static_cast<std::size_t>(world.block[i])];
      any |= pusher.push(self.group, self.candidates);
    }
    for (std::uint32_t g = lists.first_group[i]; g < lists.first_group[i + 1]; ++g)
      any |= pusher.push(lists.groups[g], lists.pairs);
  }
  return any;
}

}  // namespace evo
