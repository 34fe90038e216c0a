#include "libevo/sim/contact_push.h"

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

namespace evo {
namespace {

using contact::Meeting;
using contact::Points;
using contact::SearchOrder;

// ---- pushing -------------------------------------------------------------------------

// For voxels of 0.1 (Model::Compiled::length_scale).
constexpr double parallel_determinant = 1e-4;  // raw area: edges nearer to parallel never cross
constexpr double shortest_edge = 1e-6;         // raw length
constexpr double far_away = 1000.0;            // distance to an edge that is shorter

class Pusher {
 public:
  using Candidates = std::span<const ContactCandidate* const>;

  Pusher(const Model::Compiled& world, const PointView& view, ContactLists& lists,
         ContactPushes& memory)
      : world_(world),
        physics_(world.physics),
        points_(world, view),
        lists_(lists),
        pushes_(memory.all),
        of_cells_(memory.of_cells),
        meetings_(memory.meetings),
        forces_(memory.forces),
        touches_(memory.touches),
        parallel_determinant_(parallel_determinant * world.length_scale * world.length_scale) {}

  void push(Candidates inside) const {
    ++lists_.looks;
    while (!inside.empty()) {
      const Candidates between = inside.first(count_of_first(inside, &Pusher::objects));
      push_objects(between);
      inside = inside.subspan(between.size());
    }
  }

 private:
  using Edge = std::array<std::int32_t, 2>;
  using Push = ContactPushes::Push;

  std::pair<std::int32_t, std::int32_t> objects(const ContactCandidate& candidate) const {
    return std::minmax(world_.surface[candidate.corner / 4].object,
                       world_.surface[candidate.cell].object);
  }
  std::pair<std::uint32_t, std::uint32_t> cells(const ContactCandidate& candidate) const {
    return std::minmax(candidate.corner / 4, candidate.cell);
  }

  // How many of the first belong to one pair.
  template <class Pair>
  std::size_t count_of_first(Candidates inside, Pair pair) const {
    std::size_t count = 1;
    const auto first = (this->*pair)(*inside.front());
    while (count < inside.size() && (this->*pair)(*inside[count]) == first) ++count;
    return count;
  }

  // For one pair of objects, or one with itself: there the search meets a pair of cells
  // twice, once either way round.
  void push_objects(Candidates inside) const {
    pushes_.clear();
    of_cells_.clear();
    meetings_.clear();
    const auto [i, j] = objects(*inside.front());
    while (!inside.empty()) {
      const Candidates between = inside.first(count_of_first(inside, &Pusher::cells));
      add_cells(between, i, j);
      inside = inside.subspan(between.size());
    }
    if (touches_ != nullptr)
      for (const Push& push : pushes_) touches_->push_back({0, push.point, push.edge, i == j});
    if (meetings_.size() > 1) SearchOrder(world_, points_, lists_, i, j).sort(meetings_);
    for (const Meeting& meeting : meetings_) {
      const auto& [first, middle, last] = of_cells_[meeting.pushes / 2];
      const bool is_turned = meeting.pushes % 2 != 0;
      if (is_turned) apply(middle, last);
      apply(first, middle);
      if (!is_turned) apply(middle, last);
    }
  }

  // `inside` are corners of two cells, those of one before those of the other. With two objects
  // the first cell is that of the first one.
  void add_cells(Candidates inside, int i, int j) const {
    const std::uint32_t one = inside.front()->corner / 4;
    const std::uint32_t other = inside.front()->cell;
    const auto first = static_cast<std::uint32_t>(pushes_.size());
    std::uint32_t middle = first;
    for (const ContactCandidate* candidate : inside) {
      const std::optional<Push> push = push_of(*candidate);
      if (!push) continue;
      pushes_.push_back(*push);
      for (const std::int32_t site : {push->point, push->edge[0], push->edge[1]})
        if (points_.moves(site)) forces_.push_back(points_.force(site));
      if (candidate->corner / 4 == one) ++middle;
    }
    const auto last = static_cast<std::uint32_t>(pushes_.size());
    if (first == last) return;
    const auto leaf = [&](std::uint32_t cell, int object) {
      const auto o = static_cast<std::size_t>(object);
      return world_.trees[o]
          .leaf_of[cell - static_cast<std::uint32_t>(world_.surface_ranges[o].first)];
    };
    const auto pair = static_cast<std::uint32_t>(2 * of_cells_.size());
    of_cells_.push_back({first, middle, last});
    if (i == j) {
      meetings_.push_back({leaf(one, i), leaf(other, i), pair});
      meetings_.push_back({leaf(other, i), leaf(one, i), pair + 1});
    } else if (world_.surface[one].object == i) {
      meetings_.push_back({leaf(one, i), leaf(other, j), pair});
    } else {
      meetings_.push_back({leaf(other, i), leaf(one, j), pair + 1});
    }
  }

  std::optional<Push> push_of(const ContactCandidate& candidate) const {
    const SurfaceCell& cell = world_.surface[candidate.cell];
    const SurfaceCell& owner = world_.surface[candidate.corner / 4];
    const std::uint32_t corner = candidate.corner % 4;
    const std::int32_t point = owner.corners[corner];
    const Vec2 p = points_(point);
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
    const Vec2 a1 = points_(probe[0]);
    const Vec2 a2 = points_(edge[0]);
    const Vec2 d1 = points_(probe[1]) - a1;
    const Vec2 d2 = points_(edge[1]) - a2;
    const double det = -d1.x * d2.y + d2.x * d1.y;
    if (std::abs(det) < parallel_determinant_) return false;
    const Vec2 d = a2 - a1;
    const double t = (-d2.y * d.x + d2.x * d.y) / det;
    const double s = (-d1.y * d.x + d1.x * d.y) / det;
    return t >= 0.0 && t <= 1.0 && s >= 0.0 && s <= 1.0;
  }

  double distance_to_line(Vec2 p, const Edge& edge) const {
    const Vec2 a = points_(edge[0]);
    const Vec2 along = points_(edge[1]) - a;
    const double length = norm(along);
    if (length < shortest_edge * world_.length_scale) return far_away * world_.length_scale;
    return std::abs(cross(along, p - a)) / length;
  }

  // Velocity as friction and damping feel it: strain limiting included.
  Vec2 true_velocity(std::int32_t site) const {
    return (points_(site) - points_.previous(site)) / physics_.substep;
  }

  // Roundings as in docs/physics.md, "Forces": every product in this order.
  Push push_of(std::int32_t point, const Edge& edge, double depth) const {
    const auto [a, b] = edge;
    const Vec2 along = points_(b) - points_(a);
    const Vec2 n = Vec2{-along.y, along.x} / norm(along);
    const Vec2 force = n * physics_.contact_stiffness * (depth + physics_.contact_margin);
    const Vec2 velocity = true_velocity(point);
    const Vec2 direction = n / norm(n);  // rounded twice
    const auto damping = [&](Vec2 v) {
      return direction * dot(direction, v) * physics_.contact_damping;
    };

    Vec2 t{-n.y, n.x};
    t = t / norm(t);
    double slip = dot(t, velocity);
    if (slip < 0.0) {
      slip = -slip;
      t = t * -1.0;
    }
    const double pressure = norm(force);
    const double sliding = slip / (physics_.friction_coefficient * pressure);
    const double grip = math::reference_tanh(sliding);
    return {
        point,
        edge,
        force - damping(velocity),
        {force / 2.0 + damping(true_velocity(a)) / 2.0,
         force / 2.0 + damping(true_velocity(b)) / 2.0},
        t * -1.0 * physics_.friction_multiplier * physics_.friction_coefficient * pressure * grip};
  }

  void apply(std::uint32_t first, std::uint32_t last) const {
    for (; first < last; ++first) apply(pushes_[first]);
  }
  void apply(const Push& push) const {
    points_.add_force(push.point, push.on_point);
    push_back(push.edge[0], push.on_edge[0]);
    push_back(push.edge[1], push.on_edge[1]);
    points_.add_force(push.point, push.friction);
    push_back(push.edge[0], push.friction / 2.0);
    push_back(push.edge[1], push.friction / 2.0);
  }

  void push_back(std::int32_t site, Vec2 f) const { points_.add_force(site, f * -1.0); }

  const Model::Compiled& world_;
  const Physics& physics_;
  Points points_;
  ContactLists& lists_;
  std::vector<Push>& pushes_;
  std::vector<ContactPushes::OfCells>& of_cells_;
  std::vector<Meeting>& meetings_;
  std::vector<double*>& forces_;
  std::vector<Touch>* touches_;
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
  for (std::size_t block = 0; block < lists.self.size(); ++block)
    lists.self[block].boxes.resize(
        world.trees[static_cast<std::size_t>(world.object_of_block[block])].nodes.size());
  lists.pairs.all.clear();
  lists.groups.clear();
  lists.first_group.assign(world.objects.size() + 1, 0);
  lists.invalidate();
}

void push_contacts(const Model::Compiled& world, std::span<const ContactCandidate* const> inside,
                   const PointView& view, ContactLists& lists, ContactPushes& memory) {
  Pusher(world, view, lists, memory).push(inside);
}

}  // namespace evo
