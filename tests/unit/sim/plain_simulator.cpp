#include "tests/unit/sim/plain_simulator.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libevo/base/elementary.h"
#include "libevo/sim/compiled.h"

namespace evo {
namespace {

struct Vector {
  double x = 0.0;
  double y = 0.0;
};
Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y}; }
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y}; }
Vector operator*(Vector a, double s) { return {a.x * s, a.y * s}; }
Vector operator/(Vector a, double s) { return {a.x / s, a.y / s}; }
Vector& operator+=(Vector& a, Vector b) { return a = a + b; }
Vector& operator-=(Vector& a, Vector b) { return a = a - b; }
double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y; }
double cross(Vector a, Vector b) { return a.x * b.y - a.y * b.x; }
double norm(Vector a) { return math::sqrt(dot(a, a)); }
std::size_t at(int i) { return static_cast<std::size_t>(i); }

struct Box {
  double x0, y0, x1, y1;
};
bool overlap(const Box& a, const Box& b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}

class Plain {
 public:
  Plain(const Model& model, State& state)
      : world_(model.compiled()), physics_(world_.physics), state_(state) {
    const std::size_t all = at(world_.moving_points) + world_.static_points.size();
    p_.resize(all);
    v_.resize(all);
    last_.resize(all);
    contact_.resize(all);
    for (std::size_t i = 0; i < all; ++i) {
      if (i < at(world_.moving_points)) {
        p_[i] = {state.x[i], state.y[i]};
        v_[i] = {state.vx[i], state.vy[i]};
        last_[i] = {state.previous_x[i], state.previous_y[i]};
      } else {
        const Vec2& s = world_.static_points[i - at(world_.moving_points)];
        p_[i] = last_[i] = {s.x, s.y};
      }
    }
    for (const Spring& s : world_.dynamics.springs) goal_.push_back(s.rest);
    const auto target = [&](int i) {
      return std::clamp(state.targets[at(i)], physics_.min_target, physics_.max_target);
    };
    for (const Drive& d : world_.dynamics.drives)
      goal_[at(d.spring)] = (target(d.first_actuator) + target(d.second_actuator)) / 2.0 *
                            world_.dynamics.springs[at(d.spring)].rest;
    length_.resize(goal_.size());
  }

  LaneStatus run() {
    LaneStatus result = LaneStatus::done;
    for (int i = 0; i < physics_.substeps && result == LaneStatus::done; ++i)
      if (substep()) result = LaneStatus::self_folding;
    for (std::size_t i = 0; i < at(world_.moving_points); ++i) {
      state_.x[i] = p_[i].x;
      state_.y[i] = p_[i].y;
      state_.vx[i] = v_[i].x;
      state_.vy[i] = v_[i].y;
      state_.previous_x[i] = last_[i].x;
      state_.previous_y[i] = last_[i].y;
    }
    return result;
  }

 private:
  bool substep() {
    const std::vector<Vector> start = p_;
    contacts();
    const bool folding = folds();
    for (std::size_t i = 0; i < length_.size(); ++i) {
      const Spring& s = world_.dynamics.springs[i];
      const double d = norm(p_[at(s.a)] - p_[at(s.b)]);
      length_[i] = d + physics_.actuation_rate * (goal_[i] - d);
    }
    integrate();
    limit_strain();
    limit_rigid_strain();
    last_ = start;
    return folding;
  }

  // ---- contact ----------------------------------------------------------------

  Box box(const SurfaceCell& c) const {
    Box b{p_[at(c.corners[0])].x, p_[at(c.corners[0])].y, p_[at(c.corners[0])].x,
          p_[at(c.corners[0])].y};
    for (const int corner : c.corners) {
      b.x0 = std::min(b.x0, p_[at(corner)].x);
      b.y0 = std::min(b.y0, p_[at(corner)].y);
      b.x1 = std::max(b.x1, p_[at(corner)].x);
      b.y1 = std::max(b.y1, p_[at(corner)].y);
    }
    return b;
  }

  void contacts() {
    std::fill(contact_.begin(), contact_.end(), Vector{});
    boxes_.clear();
    for (const SurfaceCell& c : world_.surface) boxes_.push_back(box(c));
    find_node_boxes();
    const int objects = static_cast<int>(world_.objects.size());
    for (int i = 0; i < objects; ++i)
      for (int j = i; j < objects; ++j) search(i, root(i), j, root(j));
  }

  const BoundingTree& tree(int object) const { return world_.trees[at(object)]; }
  int root(int object) const { return static_cast<int>(tree(object).nodes.size()) - 1; }

  // Of all nodes, anew for each substep.
  void find_node_boxes() {
    node_boxes_.assign(world_.objects.size(), {});
    for (int object = 0; object < static_cast<int>(world_.objects.size()); ++object) {
      std::vector<Box>& boxes = node_boxes_[at(object)];
      boxes.resize(tree(object).nodes.size());
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        const BoundingTree::Node& node = tree(object).nodes[i];
        if (node.left < 0) {
          boxes[i] = boxes_[at(leaf(object, node))];
          continue;
        }
        const Box& l = boxes[at(node.left)];
        const Box& r = boxes[at(node.right)];
        boxes[i] = {std::min(l.x0, r.x0), std::min(l.y0, r.y0), std::max(l.x1, r.x1),
                    std::max(l.y1, r.y1)};
      }
    }
  }

  int leaf(int object, const BoundingTree::Node& node) const {
    return world_.surface_ranges[at(object)].first + tree(object).leaves[at(node.first)];
  }

  void search(int i, int a, int j, int b) {
    const Box& box_a = node_boxes_[at(i)][at(a)];
    const Box& box_b = node_boxes_[at(j)][at(b)];
    if (!overlap(box_a, box_b)) return;
    const BoundingTree::Node& of_a = tree(i).nodes[at(a)];
    const BoundingTree::Node& of_b = tree(j).nodes[at(b)];
    if (of_a.left < 0 && of_b.left < 0) {
      if (i != j || a != b) pair(leaf(i, of_a), leaf(j, of_b));
      return;
    }
    const auto area = [](const Box& box) { return (box.x1 - box.x0) * (box.y1 - box.y0); };
    if (of_a.left < 0 || (of_b.left >= 0 && area(box_a) < area(box_b))) {
      search(i, a, j, of_b.left);
      search(i, a, j, of_b.right);
    } else {
      search(i, of_a.left, j, b);
      search(i, of_a.right, j, b);
    }
  }

  void pair(int m, int n) {
    if (!overlap(boxes_[at(m)], boxes_[at(n)])) return;
    cell_against_cell(world_.surface[at(m)], world_.surface[at(n)]);
    cell_against_cell(world_.surface[at(n)], world_.surface[at(m)]);
  }

  void cell_against_cell(const SurfaceCell& a, const SurfaceCell& b) {
    static constexpr int probes[4][2] = {
        {top, left}, {top, right}, {bottom, left}, {bottom, right}};
    for (const std::size_t k : {top_left, top_right, bottom_right, bottom_left})  // round the cell
      point_against_cell(a.corners[k], a.edges[at(probes[k][0])], a.edges[at(probes[k][1])], b);
  }

  bool is_inside(Vector p, const SurfaceCell& cell) const {
    const Vector tl = p_[at(cell.corners[top_left])] - p;
    const Vector tr = p_[at(cell.corners[top_right])] - p;
    const Vector br = p_[at(cell.corners[bottom_right])] - p;
    const Vector bl = p_[at(cell.corners[bottom_left])] - p;
    const double a = cross(tl, tr), b = cross(tr, br), c = cross(br, tl);
    if (c * a >= 0.0 && c * b >= 0.0) return true;
    const double d = cross(tl, bl), e = cross(bl, br);
    return c * d >= 0.0 && c * e >= 0.0;
  }

  bool cross_each_other(const std::array<int, 2>& probe, const std::array<int, 2>& edge) const {
    const Vector a1 = p_[at(probe[0])], b1 = p_[at(probe[1])];
    const Vector a2 = p_[at(edge[0])], b2 = p_[at(edge[1])];
    const Vector d1 = b1 - a1, d2 = b2 - a2;
    const double det = -d1.x * d2.y + d2.x * d1.y;
    if (std::abs(det) < 1e-4 * world_.length_scale * world_.length_scale) return false;
    const double dx = a2.x - a1.x, dy = a2.y - a1.y;
    const double t = (-d2.y * dx + d2.x * dy) / det;
    const double s = (-d1.y * dx + d1.x * dy) / det;
    return t >= 0.0 && t <= 1.0 && s >= 0.0 && s <= 1.0;
  }

  double distance_to_line(Vector p, const std::array<int, 2>& edge) const {
    const Vector d = p_[at(edge[1])] - p_[at(edge[0])];
    const double length = norm(d);
    if (length < 1e-6 * world_.length_scale) return 1000.0 * world_.length_scale;
    return std::abs(cross(d, p - p_[at(edge[0])])) / length;
  }

  void point_against_cell(int point, const std::array<int, 2>& probe1,
                          const std::array<int, 2>& probe2, const SurfaceCell& cell) {
    for (const int corner : cell.corners)
      if (corner == point) return;
    const Vector p = p_[at(point)];
    if (!is_inside(p, cell)) return;
    int best = -1;
    double depth = 0.0;
    for (int side = 0; side < 4; ++side) {
      if (!cell.surface[at(side)]) continue;
      const auto& edge = cell.edges[at(side)];
      if (!cross_each_other(probe1, edge) && !cross_each_other(probe2, edge)) continue;
      const double delta = distance_to_line(p, edge);
      if (best < 0 || delta < depth) {
        best = side;
        depth = delta;
      }
    }
    if (best >= 0) push(point, cell.edges[at(best)], depth);
  }

  Vector true_velocity(int point) const {
    return (p_[at(point)] - last_[at(point)]) / physics_.substep;
  }

  void push(int point, const std::array<int, 2>& edge, double depth) {
    const auto [a, b] = edge;
    const Vector along = p_[at(b)] - p_[at(a)];
    const Vector n = Vector{-along.y, along.x} / norm(along);
    const Vector force = n * physics_.contact_stiffness * (depth + physics_.contact_margin);
    const Vector direction = n / norm(n);
    const auto damping = [&](int i) {
      return direction * dot(direction, true_velocity(i)) * physics_.contact_damping;
    };
    contact_[at(point)] += force - damping(point);
    contact_[at(a)] -= force / 2.0 + damping(a) / 2.0;
    contact_[at(b)] -= force / 2.0 + damping(b) / 2.0;

    Vector t{-n.y, n.x};
    t = t / norm(t);
    double slip = dot(t, true_velocity(point));
    if (slip < 0.0) {
      slip = -slip;
      t = t * -1.0;
    }
    const double pressure = norm(force);
    const double sliding = slip / (physics_.friction_coefficient * pressure);
    const double grip = math::reference_tanh(sliding);
    const Vector friction =
        t * -1.0 * physics_.friction_multiplier * physics_.friction_coefficient * pressure * grip;
    contact_[at(point)] += friction;
    contact_[at(a)] -= friction / 2.0;
    contact_[at(b)] -= friction / 2.0;
  }

  bool folds() const {
    for (std::size_t o = 0; o < world_.objects.size(); ++o) {
      if (!world_.is_robot[o]) continue;
      const SurfaceRange range = world_.surface_ranges[o];
      int count = 0;
      for (int m = range.first; m < range.first + range.count; ++m) {
        for (int n = range.first; n < range.first + range.count; ++n) {
          const SurfaceCell& a = world_.surface[at(m)];
          const SurfaceCell& b = world_.surface[at(n)];
          const bool near = std::abs(a.row - b.row) <= 1 && std::abs(a.col - b.col) <= 1;
          if (!near && overlap(boxes_[at(m)], boxes_[at(n)])) ++count;
        }
      }
      if (count > range.count) return true;
    }
    return false;
  }

  // ---- integration ------------------------------------------------------------

  std::vector<Vector> forces(const std::vector<Vector>& p, const std::vector<Vector>& v) const {
    const std::vector<Spring>& springs = world_.dynamics.springs;
    std::vector<Vector> f(springs.size());
    for (std::size_t i = 0; i < springs.size(); ++i) {
      const Vector q = p[at(springs[i].a)] - p[at(springs[i].b)];
      const double d = norm(q);
      f[i] = q * ((springs[i].stiffness * (d - length_[i])) / d);
    }
    std::vector<Vector> total(at(world_.moving_points));
    for (std::size_t i = 0; i < springs.size(); ++i) total[at(springs[i].a)] -= f[i];
    for (std::size_t i = 0; i < springs.size(); ++i) total[at(springs[i].b)] += f[i];
    for (std::size_t i = 0; i < total.size(); ++i) {
      total[i] += v[i] * -physics_.drag;
      total[i].y += -physics_.gravity;
      total[i] += contact_[i];
      if (p[i].y < 0.0) {
        const double up = -physics_.floor_stiffness * p[i].y;
        total[i].y += up;
        total[i].x -= physics_.floor_friction_multiplier * physics_.floor_friction_coefficient *
                      up * math::reference_tanh(v[i].x * up * physics_.floor_friction_coefficient);
      }
    }
    return total;
  }

  void integrate() {
    const std::size_t n = at(world_.moving_points);
    const double dt = physics_.substep;
    std::vector<Vector> p(n), v(n), p_sum(n), v_sum(n);
    std::copy_n(p_.begin(), n, p.begin());
    std::copy_n(v_.begin(), n, v.begin());
    constexpr double weight[4] = {1.0, 2.0, 2.0, 1.0};
    constexpr double next[4] = {0.5, 0.5, 1.0, 0.0};
    for (std::size_t stage = 0; stage < 4; ++stage) {
      const std::vector<Vector> f = forces(p, v);
      for (std::size_t i = 0; i < n; ++i) {
        const Vector kp = v[i] * dt, kv = f[i] * dt;
        p_sum[i] = stage == 0 ? kp : p_sum[i] + kp * weight[stage];
        v_sum[i] = stage == 0 ? kv : v_sum[i] + kv * weight[stage];
        p[i] = p_[i] + kp * next[stage];
        v[i] = v_[i] + kv * next[stage];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (world_.dynamics.fixed[i]) continue;
      p_[i] += p_sum[i] / 6.0;
      v_[i] += v_sum[i] / 6.0;
    }
  }

  Vector correction(const Spring& s, double limit) const {
    const Vector q = p_[at(s.a)] - p_[at(s.b)];
    const double d = norm(q);
    const double strain = d / s.rest;
    if (strain > 1.0 + limit) return q * ((d - (1.0 + limit) * s.rest) / (2.0 * d));
    if (strain < 1.0 - limit) return q * ((d - (1.0 - limit) * s.rest) / (2.0 * d));
    return {};
  }

  void limit_strain() {
    const std::vector<Spring>& springs = world_.dynamics.springs;
    std::vector<Vector> c;
    for (const Spring& s : springs) c.push_back(correction(s, physics_.strain_limit));
    for (std::size_t i = 0; i < springs.size(); ++i)
      if (!world_.dynamics.fixed[at(springs[i].a)])
        p_[at(springs[i].a)] -= c[i] * physics_.strain_correction;
    for (std::size_t i = 0; i < springs.size(); ++i)
      if (!world_.dynamics.fixed[at(springs[i].b)])
        p_[at(springs[i].b)] += c[i] * physics_.strain_correction;
  }

  void limit_rigid_strain() {
    for (const int edge : world_.dynamics.rigid_edges) {
      const Spring& s = world_.dynamics.springs[at(edge)];
      const Vector c =
          correction(s, physics_.rigid_strain_limit) * physics_.rigid_strain_correction;
      p_[at(s.a)] -= c;
      p_[at(s.b)] += c;
    }
  }

  const Model::Compiled& world_;
  const Physics& physics_;
  State& state_;
  std::vector<Vector> p_, v_, last_, contact_;  // by reference, static points included
  std::vector<double> goal_, length_;           // of every spring
  std::vector<Box> boxes_;                      // of every surface cell, at the substep's start
  std::vector<std::vector<Box>> node_boxes_;    // of every object's tree, the same
};

}  // namespace

LaneStatus plain_step(const Model& model, State& state) { return Plain(model, state).run(); }

}  // namespace evo
