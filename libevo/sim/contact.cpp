#include "libevo/sim/contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "libevo/base/elementary.h"
#include "libevo/sim/contact_geometry.h"
#include "libevo/sim/contact_order.h"

namespace evo {
namespace {

using contact::cell_of;
using contact::Points;
using contact::SearchOrder;
using contact::TouchingCells;
using contact::Vector;

// ---- pushing -------------------------------------------------------------------------

// For voxels of 0.1 (Model::Compiled::length_scale).
constexpr double parallel_determinant = 1e-4;  // raw area: edges nearer to parallel never cross
constexpr double shortest_edge = 1e-6;         // raw length
constexpr double far_away = 1000.0;            // distance to an edge that is shorter

class Pusher {
 public:
  using Candidates = std::span<const ContactCandidate* const>;

  Pusher(const Model::Compiled& world, const PointView& view)
      : world_(world),
        physics_(world.physics),
        points_(world, view),
        as_package_(world.physics.contact_rounding == ContactRounding::package),
        parallel_determinant_(parallel_determinant * world.length_scale * world.length_scale) {}

  // Whether any of them pushed.
  bool push(Candidates inside) const {
    if (as_package_) return push_as_package(inside);
    bool any = false;
    while (!inside.empty()) {
      const ContactCandidate& candidate = *inside.front();
      std::size_t count = 1;
      if (is_within_object(candidate)) {
        count = of_first_cells(inside);
        any |= push_twice(inside.first(count));
      } else if (const std::optional<Push> push = push_of(candidate)) {
        apply(*push);
        any = true;
      }
      inside = inside.subspan(count);
    }
    return any;
  }

 private:
  using Edge = std::array<std::int32_t, 2>;

  // Forces of a contact: on a point, and, the other way, on the ends of the edge it crossed.
  struct Push {
    std::int32_t point = 0;
    Edge edge{};
    Vector on_point;
    std::array<Vector, 2> on_edge;
    Vector friction;  // on the point; half of it on either end
  };

  bool is_within_object(const ContactCandidate& candidate) const {
    return world_.surface[candidate.corner / 4].object == world_.surface[candidate.cell].object;
  }

  const SurfaceCell& cell_with(const ContactCandidate& candidate) const {
    return world_.surface[candidate.corner / 4];
  }
  const SurfaceCell& cell_hit(const ContactCandidate& candidate) const {
    return world_.surface[candidate.cell];
  }

  // How many of the first belong to one pair of objects.
  std::size_t of_first_objects(Candidates inside) const {
    const auto objects = [&](const ContactCandidate& candidate) {
      return std::minmax(cell_with(candidate).object, cell_hit(candidate).object);
    };
    std::size_t count = 1;
    while (count < inside.size() && objects(*inside[count]) == objects(*inside.front())) ++count;
    return count;
  }

  // How many of the first belong to one pair of cells.
  static std::size_t of_first_cells(Candidates inside) {
    const auto cells = [](const ContactCandidate& candidate) {
      return std::minmax({candidate.corner / 4, candidate.cell});
    };
    std::size_t count = 1;
    while (count < inside.size() && cells(*inside[count]) == cells(*inside.front())) ++count;
    return count;
  }

  // Within an object a pair of cells pushes as (later, earlier) cell, then as (earlier, later);
  // `inside` are its corners, those of the later cell first.
  bool push_twice(Candidates inside) const {
    std::array<Push, 8> pushes;  // as many corners as two cells have
    std::size_t later = 0;       // of them, those of corners of the later cell
    std::size_t count = 0;
    for (const ContactCandidate* candidate : inside)
      if (const std::optional<Push> push = push_of(*candidate)) {
        pushes[count++] = *push;
        if (candidate->corner / 4 > candidate->cell) later = count;
      }
    for (std::size_t i = 0; i < count; ++i) apply(pushes[i]);
    for (std::size_t i = later; i < count; ++i) apply(pushes[i]);
    for (std::size_t i = 0; i < later; ++i) apply(pushes[i]);
    return count > 0;
  }

  // Pushes between two cells: those of corners of `first`, then those of the other's.
  struct PairPushes {
    std::uint32_t first = 0;
    std::uint32_t second = 0;
    std::vector<Push> of_first;
    std::vector<Push> of_second;
  };

  bool push_as_package(Candidates inside) const {
    bool any = false;
    while (!inside.empty()) {
      const std::size_t count = of_first_objects(inside);
      any |= push_objects_as_package(inside.first(count));
      inside = inside.subspan(count);
    }
    return any;
  }

  // Of one pair of objects, or of one with itself: there the search meets a pair of cells
  // twice, once either way round.
  bool push_objects_as_package(Candidates inside) const {
    std::vector<PairPushes> pairs;
    while (!inside.empty()) {
      const std::size_t count = of_first_cells(inside);
      if (PairPushes pushes = pushes_of_cells(inside.first(count));
          !pushes.of_first.empty() || !pushes.of_second.empty())
        pairs.push_back(std::move(pushes));
      inside = inside.subspan(count);
    }
    if (pairs.empty()) return false;

    const int i = world_.surface[pairs.front().first].object;
    const int j = world_.surface[pairs.front().second].object;
    const auto place = [&](std::uint32_t cell, int object) {
      return static_cast<std::int32_t>(cell) -
             world_.surface_ranges[static_cast<std::size_t>(object)].first;
    };
    std::vector<TouchingCells> touching;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const std::int32_t a = place(pairs[k].first, i);
      const std::int32_t b = place(pairs[k].second, j);
      touching.push_back({a, b, 2 * k});
      if (i == j) touching.push_back({b, a, 2 * k + 1});
    }
    SearchOrder(world_, points_, i, j).sort(touching);
    for (const TouchingCells& cells : touching) {
      const PairPushes& pair = pairs[cells.number / 2];
      const bool is_turned = cells.number % 2 != 0;
      for (const Push& push : is_turned ? pair.of_second : pair.of_first) apply(push);
      for (const Push& push : is_turned ? pair.of_first : pair.of_second) apply(push);
    }
    return true;
  }

  // `inside` are the corners of one pair of cells: the first is of the earlier object.
  PairPushes pushes_of_cells(Candidates inside) const {
    const ContactCandidate& one = *inside.front();
    PairPushes pair{one.corner / 4, one.cell, {}, {}};
    if (cell_with(one).object > cell_hit(one).object) std::swap(pair.first, pair.second);
    // Round the cell: the package's order of corners.
    for (const Corner corner : {top_left, top_right, bottom_right, bottom_left})
      for (const ContactCandidate* candidate : inside)
        if (candidate->corner % 4 == static_cast<std::uint32_t>(corner))
          if (const std::optional<Push> push = push_of(*candidate))
            (candidate->corner / 4 == pair.first ? pair.of_first : pair.of_second).push_back(*push);
    return pair;
  }

  std::optional<Push> push_of(const ContactCandidate& candidate) const {
    const ContactCell& cell = cell_of(world_, candidate.cell);
    const ContactCell& owner = cell_of(world_, candidate.corner / 4);
    const std::uint32_t corner = candidate.corner % 4;
    const std::int32_t point = owner.corners[corner];
    const Vector p = points_(point);
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
    if (nearest == nullptr) return std::nullopt;
    return push_of(point, *nearest, depth);
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

  // Roundings as in docs/physics.md, "Forces": every product in this order.
  Push push_of(std::int32_t point, const Edge& edge, double depth) const {
    const auto [a, b] = edge;
    const Vector along = points_(b) - points_(a);
    const Vector n = Vector{-along.y, along.x} / norm(along);
    const Vector force = n * physics_.contact_stiffness * (depth + physics_.contact_margin);
    const Vector velocity = true_velocity(point);
    const Vector direction = as_package_ ? n / norm(n) : n;  // the package rounds it twice
    const auto damping = [&](Vector v) {
      return direction * dot(direction, v) * physics_.contact_damping;
    };

    Vector t{-n.y, n.x};
    t = t / norm(t);
    double slip = dot(t, velocity);
    if (slip < 0.0) {
      slip = -slip;
      t = t * -1.0;
    }
    const double pressure = norm(force);
    const double sliding = slip / (physics_.friction_coefficient * pressure);
    const double grip = as_package_ ? math::reference_tanh(sliding) : math::tanh(sliding);
    return {
        point,
        edge,
        force - damping(velocity),
        {force / 2.0 + damping(true_velocity(a)) / 2.0,
         force / 2.0 + damping(true_velocity(b)) / 2.0},
        t * -1.0 * physics_.friction_multiplier * physics_.friction_coefficient * pressure * grip};
  }

  void apply(const Push& push) const {
    points_.add_force(push.point, push.on_point);
    push_back(push.edge[0], push.on_edge[0]);
    push_back(push.edge[1], push.on_edge[1]);
    points_.add_force(push.point, push.friction);
    push_back(push.edge[0], push.friction / 2.0);
    push_back(push.edge[1], push.friction / 2.0);
  }

  void push_back(std::int32_t site, Vector f) const { points_.add_force(site, f * -1.0); }

  const Model::Compiled& world_;
  const Physics& physics_;
  Points points_;
  bool as_package_;
  double parallel_determinant_;
};

}  // namespace

void prepare_lists(const Model::Compiled& world, ContactLists& lists) {
  lists.self.resize(world.plan.blocks.size());
  for (ContactLists::Self& self : lists.self) {
    self.candidates.all.clear();
    self.folding.clear();
    self.group = {};
  }
  lists.pairs.all.clear();
  lists.groups.clear();
  lists.first_group.assign(world.objects.size() + 1, 0);
  lists.invalidate();
}

bool push_contacts(const Model::Compiled& world, std::span<const ContactCandidate* const> inside,
                   const PointView& view) {
  return Pusher(world, view).push(inside);
}

}  // namespace evo
