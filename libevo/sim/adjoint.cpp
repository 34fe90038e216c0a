// Pulling gradients back through a control step: lanes of a group side by side, in the same
// order of operations for every width and instruction set, none of them fused, so that the bits
// of a lane do not depend on them.
//
// Backward through a substep, with A for derivatives of the number in question:
//   strain limits   rigid edges in reverse order, then all springs at once
//   stages 4 .. 1   k_i = dt F(y_i), y_i = y + c_i k_(i-1): A k_i from the end of the substep and
//                   from stage i + 1, then A y_i = dt (dF/dy)^T A k_i
//   rest lengths    L = d + rate (goal - d), of the length at the start
//   contact         forces from positions at the start and those one substep before
// Constants of the physics take their share on the way.
// Stages are evaluated where the record has them; only springs are computed again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libevo/sim/adjoint.cpp"
// Highway's macros: which instruction sets; then this file once for each of them.
#include "libevo/sim/targets.h"
//
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"
#include "libevo/sim/compiled.h"
#include "libevo/sim/contact_adjoint.h"
#include "libevo/sim/step_record.h"

HWY_BEFORE_NAMESPACE();
namespace evo {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// 1 / sqrt(x) of a positive normal number to a few units in the last place: from half of the
// exponent by Newton's method, since roots and quotients would keep the divider busy.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V ReciprocalRoot(D d, V x) {
  const hn::RebindToSigned<D> bits;
  const auto guess =
      hn::Sub(hn::Set(bits, 0x5FE6EB50C7B537A9), hn::ShiftRight<1>(hn::BitCast(bits, x)));
  V y = hn::BitCast(d, guess);
  const V half = hn::Mul(hn::Set(d, 0.5), x);
  for (int i = 0; i < 4; ++i)
    y = hn::Mul(y, hn::Sub(hn::Set(d, 1.5), hn::Mul(hn::Mul(half, y), y)));
  return y;
}

// Goes back through lanes [first, first + lanes of D) of a record. A row is one value of each lane
// of the record; a pair of rows is x and y of a site.
template <class D>
class StepAdjoint {
 public:
  StepAdjoint(const StepRecord& record, std::size_t first)
      : record_(record),
        model_(record.members[0].model->compiled()),
        plan_(record.kind->plan()),
        physics_(record.kind->physics()),
        width_(record.width),
        first_(first),
        pairs_(pair_offset(plan_.sites, record.width)) {
    lay_out();
    prepare();
  }

  void run(std::span<Gradient> gradients) {
    load_from(gradients);
    for (std::size_t k = record_.substeps(); k-- > 0;) {
      limits(k);
      stages(k);
      rest_lengths(k);
      contacts(k);
    }
    store_to(gradients);
  }

 private:
  using V = hn::Vec<D>;
  using Row = StepRecord::Row;
  struct Vector {
    V x, y;
  };
  struct Ends {
    std::size_t a = 0;
    std::size_t b = 0;
  };

  // ---- rows and pairs of rows -----------------------------------------------------------

  static V set(double value) { return hn::Set(D(), value); }
  static V load(const double* row) { return hn::Load(D(), row); }
  static void store(V v, double* row) { hn::Store(v, D(), row); }
  static void add(double* row, V v) { store(hn::Add(load(row), v), row); }
  static void subtract(double* row, V v) { store(hn::Sub(load(row), v), row); }
  static V dot(Vector a, Vector b) { return hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)); }
  static Vector combine(V f, Vector a, V g, Vector b) {
    return {hn::Add(hn::Mul(f, a.x), hn::Mul(g, b.x)), hn::Add(hn::Mul(f, a.y), hn::Mul(g, b.y))};
  }

  HWY_INLINE Vector difference(const double* pairs, std::size_t a, std::size_t b) const {
    return {hn::Sub(load(pairs + a), load(pairs + b)),
            hn::Sub(load(pairs + a + width_), load(pairs + b + width_))};
  }
  HWY_INLINE void add_pair(double* pairs, std::size_t o, Vector v) const {
    add(pairs + o, v.x);
    add(pairs + o + width_, v.y);
  }
  HWY_INLINE void subtract_pair(double* pairs, std::size_t o, Vector v) const {
    subtract(pairs + o, v.x);
    subtract(pairs + o + width_, v.y);
  }
  // What a function of the difference a - b gives its two ends.
  HWY_INLINE void add_difference(double* pairs, Ends ends, Vector v) const {
    add_pair(pairs, ends.a, v);
    subtract_pair(pairs, ends.b, v);
  }
  template <class Visit>
  void for_each_row(Visit visit) const {
    for (std::size_t o = 0; o < pairs_; o += width_) visit(o);
  }

  std::size_t offset(std::int32_t site) const { return pair_offset(site, width_); }
  std::size_t offset_of(int point) const {
    return offset(plan_.site_of[static_cast<std::size_t>(point)]);
  }
  const double* recorded(std::size_t substep, Row which) const {
    return record_.row(substep, which) + first_;
  }

  // ---- before the first substep, after the last ---------------------------------------------

  void lay_out() {
    const std::vector<Spring>& springs = model_.dynamics.springs;
    const std::size_t of_springs = springs.size() * width_;
    const std::size_t of_edges = 2 * plan_.rigid_edges.size() * width_;
    std::vector<std::pair<double**, std::size_t>> arrays;
    for (double** pairs :
         {&position_, &velocity_, &previous_, &by_force_, &stage_position_, &stage_velocity_,
          &position_sum_, &velocity_sum_, &contact_, &second_stage_, &limited_})
      arrays.emplace_back(pairs, pairs_);
    for (double** rows : {&goal_, &rest_, &reciprocal_, &by_rest_, &by_goal_, &by_stiffness_})
      arrays.emplace_back(rows, of_springs);
    arrays.emplace_back(&edges_, of_edges);
    arrays.emplace_back(&by_constants_, gradient_constants * width_);
    std::size_t all = 0;
    for (const auto& [array, size] : arrays) all += size;
    memory_ = hwy::AllocateAligned<double>(all);
    if (!memory_) throw std::bad_alloc();
    std::fill_n(memory_.get(), all, 0.0);
    double* at = memory_.get() + first_;
    for (const auto& [array, size] : arrays) at = (*array = at) + size;

    for (const Spring& spring : springs)
      springs_.push_back({offset_of(spring.a), offset_of(spring.b)});
    free_.assign(static_cast<std::size_t>(plan_.sites), 0.0);
    moving_ = free_;
    for (const PlanBlock& block : plan_.blocks)
      for (int site = block.first; site < block.first + block.integrated; ++site) {
        const auto s = static_cast<std::size_t>(site);
        const auto point = static_cast<std::size_t>(plan_.state_of[s]);
        free_[s] = model_.dynamics.fixed[point] == 0 ? 1.0 : 0.0;
        moving_[s] = 1.0;
      }
  }

  void prepare() {
    const std::vector<Spring>& springs = model_.dynamics.springs;
    for (std::size_t s = 0; s < springs.size(); ++s)
      store(set(springs[s].rest), goal_ + s * width_);
    for_each_member([&](std::size_t i, const StepRecord::Member& member) {
      for (const Drive& drive : model_.dynamics.drives) {
        const auto s = static_cast<std::size_t>(drive.spring);
        const auto target = [&](int actuator) {
          return physics_.clip(member.targets[static_cast<std::size_t>(actuator)]);
        };
        const double mean = (target(drive.first_actuator) + target(drive.second_actuator)) / 2.0;
        goal_[s * width_ + i] = mean * springs[s].rest;
      }
    });
  }

  // Lanes that have no derivative are left out.
  template <class Visit>
  void for_each_member(Visit visit) const {
    const std::size_t last = std::min(first_ + hn::Lanes(D()), record_.members.size());
    for (std::size_t i = first_; i < last; ++i)
      if (record_.members[i].is_done) visit(i - first_, record_.members[i]);
  }

  template <class Visit>
  void for_each_derivative(State& state, std::size_t lane, Visit visit) const {
    for (std::size_t p = 0; p < plan_.site_of.size(); ++p) {
      const std::size_t o = offset(plan_.site_of[p]) + lane;
      const auto pair = [&](Vec2& outside, double* row) {
        visit(outside.x, row[o]);
        visit(outside.y, row[o + width_]);
      };
      pair(state.positions[p], position_);
      pair(state.velocities[p], velocity_);
      pair(state.previous[p], previous_);
    }
  }

  void load_from(std::span<Gradient> gradients) {
    for_each_member([&](std::size_t i, const StepRecord::Member& member) {
      with_stiffness_ = with_stiffness_ || !gradients[member.lane].stiffness.empty();
      with_constants_ = with_constants_ || !gradients[member.lane].constants.empty();
      for_each_derivative(gradients[member.lane].state, i,
                          [](double outside, double& inside) { inside = outside; });
    });
  }

  void store_to(std::span<Gradient> gradients) {
    for (std::size_t i = first_; i < record_.members.size(); ++i)
      if (!record_.members[i].is_done)
        for_each_array(gradients[record_.members[i].lane].state,
                       [](auto& values) { values.assign(values.size(), {}); });
    for_each_member([&](std::size_t i, const StepRecord::Member& member) {
      Gradient& gradient = gradients[member.lane];
      for_each_derivative(gradient.state, i,
                          [](double& outside, double inside) { outside = inside; });
      std::vector<double>& targets = gradient.state.targets;
      for (const Drive& drive : model_.dynamics.drives) {
        const auto s = static_cast<std::size_t>(drive.spring);
        const double half = 0.5 * model_.dynamics.springs[s].rest * by_goal_[s * width_ + i];
        for (const int actuator : {drive.first_actuator, drive.second_actuator}) {
          const auto a = static_cast<std::size_t>(actuator);
          if (physics_.clip(member.targets[a]) == member.targets[a]) targets[a] += half;
        }
      }
      for (std::size_t c = 0; c < gradient.constants.size(); ++c)
        gradient.constants[c] += by_constants_[c * width_ + i];
      if (gradient.stiffness.empty()) return;
      for (const VoxelSpring& part : member.model->compiled().voxel_springs)
        gradient.stiffness[static_cast<std::size_t>(part.cell)] +=
            part.stiffness * by_stiffness_[static_cast<std::size_t>(part.spring) * width_ + i];
    });
  }

  // ---- strain limits --------------------------------------------------------------------------

  // For a correction share (1 - limit/d)/2 q of the difference q of a spring's ends.
  struct Correction {
    hn::Mask<D> beyond;
    V limit, reciprocal;
  };
  static HWY_INLINE bool is_within(Vector q, const StrainLimit& limits) {
    const V square = dot(q, q);
    return hn::AllFalse(D(), hn::Or(hn::Gt(square, set(limits.longest_square)),
                                    hn::Lt(square, set(limits.shortest_square))));
  }
  static Correction correction_of(Vector q, const StrainLimit& limits) {
    const V square = dot(q, q);
    const auto is_long = hn::Gt(square, set(limits.longest_square));
    return {hn::Or(is_long, hn::Lt(square, set(limits.shortest_square))),
            hn::IfThenElse(is_long, set(limits.longest), set(limits.shortest)),
            ReciprocalRoot(D(), square)};
  }
  static Vector corrected(Vector q, const Correction& c, double share) {
    const V f = hn::IfThenElseZero(
        c.beyond, hn::Mul(set(0.5 * share), hn::Sub(set(1.0), hn::Mul(c.limit, c.reciprocal))));
    return {hn::Mul(f, q.x), hn::Mul(f, q.y)};
  }
  static Vector by_difference(Vector q, const Correction& c, double share, Vector g) {
    const V scale = hn::IfThenElseZero(c.beyond, set(0.5 * share));
    const V ratio = hn::Mul(c.limit, c.reciprocal);
    const V along = hn::Mul(hn::Mul(dot(q, g), hn::Mul(c.reciprocal, c.reciprocal)), ratio);
    return combine(hn::Mul(scale, hn::Sub(set(1.0), ratio)), g, hn::Mul(scale, along), q);
  }

  void limits(std::size_t k) {
    const double* from = recorded(k, Row::after_stages);
    const double* to = record_.after(k) + first_;
    auto same = hn::Eq(load(from), load(to));
    for_each_row(
        [&](std::size_t o) { same = hn::And(same, hn::Eq(load(from + o), load(to + o))); });
    if (hn::AllTrue(D(), same)) return;

    // Once more, to know where each edge of rigid cells was when its turn came.
    const Plan::Strain& strain = plan_.strain;
    for_each_row([&](std::size_t o) { store(load(from + o), limited_ + o); });
    long_springs_.clear();
    for (std::size_t s = 0; s < strain.springs; ++s) {
      const Ends ends{offset(strain.a[s]), offset(strain.b[s])};
      const Vector q = difference(from, ends.a, ends.b);
      if (HWY_LIKELY(is_within(q, strain.limits[s]))) continue;
      long_springs_.push_back(s);
      const Vector c = corrected(q, correction_of(q, strain.limits[s]), physics_.strain_correction);
      if (strain.a_free[s] != 0) subtract_pair(limited_, ends.a, c);
      if (strain.b_free[s] != 0) add_pair(limited_, ends.b, c);
    }
    long_edges_.clear();
    for (std::size_t e = 0; e < plan_.rigid_edges.size(); ++e) {
      const auto& [a, b, edge_limits] = plan_.rigid_edges[e];
      const Ends ends{offset(a), offset(b)};
      const Vector q = difference(limited_, ends.a, ends.b);
      if (HWY_LIKELY(is_within(q, edge_limits))) continue;
      long_edges_.push_back(e);
      store(q.x, edges_ + 2 * e * width_);
      store(q.y, edges_ + (2 * e + 1) * width_);
      const Vector c =
          corrected(q, correction_of(q, edge_limits), physics_.rigid_strain_correction);
      subtract_pair(limited_, ends.a, c);
      add_pair(limited_, ends.b, c);
    }

    for (std::size_t i = long_edges_.size(); i-- > 0;) {
      const std::size_t e = long_edges_[i];
      const auto& [a, b, edge_limits] = plan_.rigid_edges[e];
      const Ends ends{offset(a), offset(b)};
      const Vector q{load(edges_ + 2 * e * width_), load(edges_ + (2 * e + 1) * width_)};
      const Vector g = difference(position_, ends.b, ends.a);
      add_difference(
          position_, ends,
          by_difference(q, correction_of(q, edge_limits), physics_.rigid_strain_correction, g));
    }
    for_each_row([&](std::size_t o) { store(load(position_ + o), limited_ + o); });
    for (const std::size_t s : long_springs_) {
      const Ends ends{offset(strain.a[s]), offset(strain.b[s])};
      const Vector q = difference(from, ends.a, ends.b);
      const V to_b = set(strain.b_free[s] != 0 ? 1.0 : 0.0);
      const V from_a = set(strain.a_free[s] != 0 ? -1.0 : 0.0);
      const Vector g = combine(to_b, {load(limited_ + ends.b), load(limited_ + ends.b + width_)},
                               from_a, {load(limited_ + ends.a), load(limited_ + ends.a + width_)});
      add_difference(
          position_, ends,
          by_difference(q, correction_of(q, strain.limits[s]), physics_.strain_correction, g));
    }
  }

  // ---- Runge-Kutta ------------------------------------------------------------------------------

  void stages(std::size_t k) {
    const double* start = recorded(k, Row::position);
    const double* velocity = recorded(k, Row::velocity);
    for (std::size_t site = 0, o = 0; o < pairs_; ++site, o += 2 * width_) {
      const V half = set(0.5 * physics_.substep * moving_[site]);
      for (const std::size_t c : {o, o + width_})
        store(hn::Add(load(start + c), hn::Mul(half, load(velocity + c))), second_stage_ + c);
    }
    for (std::size_t s = 0; s < springs_.size(); ++s) {
      const Vector q = difference(start, springs_[s].a, springs_[s].b);
      const V square = dot(q, q);
      const V reciprocal = ReciprocalRoot(D(), square);
      const V length = hn::Mul(square, reciprocal);
      const V goal = load(goal_ + s * width_);
      const V rest = hn::Add(length, hn::Mul(set(physics_.actuation_rate), hn::Sub(goal, length)));
      store(rest, rest_ + s * width_);
      store(reciprocal, reciprocal_ + s * width_);
      store(hn::Zero(D()), by_rest_ + s * width_);
    }
    stage<4>(k, recorded(k, Row::fourth_stage));
    stage<3>(k, recorded(k, Row::third_stage));
    stage<2>(k, second_stage_);
    stage<1>(k, start);
    for_each_row([&](std::size_t o) {
      const V sum = hn::Add(load(position_sum_ + o), load(stage_position_ + o));
      add(position_ + o, hn::Add(sum, load(previous_ + o)));
      add(velocity_ + o, hn::Add(load(velocity_sum_ + o), load(stage_velocity_ + o)));
      store(hn::Zero(D()), previous_ + o);
    });
  }

  template <int n>
  void stage(std::size_t k, const double* at) {
    const double share = (n == 1 || n == 4 ? 1.0 / 6.0 : 1.0 / 3.0) * physics_.substep;
    const double next = (n == 3 ? 1.0 : 0.5) * physics_.substep;
    const V drag = set(physics_.drag);
    for (std::size_t site = 0, o = 0; o < pairs_; ++site, o += 2 * width_) {
      const V of_end = set(share * free_[site]);
      const V of_next = set(next * moving_[site]);
      for (const std::size_t c : {o, o + width_}) {
        V by_position = hn::Mul(of_end, load(position_ + c));  // A k_n, times dt
        V by_velocity = hn::Mul(of_end, load(velocity_ + c));
        if constexpr (n < 4) {
          const V p = load(stage_position_ + c);
          const V v = load(stage_velocity_ + c);
          by_position = hn::Add(by_position, hn::Mul(of_next, p));
          by_velocity = hn::Add(by_velocity, hn::Mul(of_next, v));
          store(n == 3 ? p : hn::Add(load(position_sum_ + c), p), position_sum_ + c);
          store(n == 3 ? v : hn::Add(load(velocity_sum_ + c), v), velocity_sum_ + c);
        }
        store(by_velocity, by_force_ + c);
        store(n == 4 ? by_velocity : hn::Add(load(contact_ + c), by_velocity), contact_ + c);
        store(hn::Zero(D()), stage_position_ + c);
        store(hn::Sub(by_position, hn::Mul(drag, by_velocity)), stage_velocity_ + c);
      }
      if (with_constants_) gravity_and_drag<n>(k, o);
      const V y = load(at + o + width_);
      if (HWY_UNLIKELY(!hn::AllFalse(D(), hn::Lt(y, hn::Zero(D()))))) floor<n>(k, at, o);
    }
    for (std::size_t s = 0; s < springs_.size(); ++s) spring<n == 1>(at, s);
  }

  // The force on end a is -stiffness (1 - rest/d) q, on end b the opposite.
  template <bool first_stage>
  HWY_INLINE void spring(const double* at, std::size_t s) {
    const auto [a, b] = springs_[s];
    const Vector q = difference(at, a, b);
    const Vector g = difference(by_force_, b, a);
    const V square = dot(q, q);
    const V reciprocal = first_stage ? load(reciprocal_ + s * width_) : ReciprocalRoot(D(), square);
    const V stiffness = set(model_.dynamics.springs[s].stiffness);
    const V ratio = hn::Mul(load(rest_ + s * width_), reciprocal);
    const V along = hn::Mul(dot(q, g), reciprocal);
    const V of_rest = hn::Mul(stiffness, ratio);
    add_difference(
        stage_position_, springs_[s],
        combine(hn::Sub(stiffness, of_rest), g, hn::Mul(of_rest, hn::Mul(along, reciprocal)), q));
    subtract(by_rest_ + s * width_, hn::Mul(stiffness, along));
    if (!with_stiffness_) return;
    const V strain = hn::Sub(hn::Mul(square, reciprocal), load(rest_ + s * width_));
    add(by_stiffness_ + s * width_, hn::Mul(strain, along));
  }

  double* by_constant(GradientConstant which) const {
    return by_constants_ + static_cast<std::size_t>(which) * width_;
  }
  template <int n>
  HWY_NOINLINE void gravity_and_drag(std::size_t k, std::size_t o) {
    double* by_gravity = by_constant(GradientConstant::gravity);
    double* by_drag = by_constant(GradientConstant::drag);
    for (std::size_t i = 0; i < hn::Lanes(D()); ++i) {
      const std::size_t x = o + i;
      const std::size_t y = x + width_;
      by_gravity[i] -= by_force_[y];
      by_drag[i] -= by_force_[x] * velocity_in<n>(k, x) + by_force_[y] * velocity_in<n>(k, y);
    }
  }

  // The world's floor, where a lane is below it.
  template <int n>
  HWY_NOINLINE void floor(std::size_t k, const double* at, std::size_t o) {
    for (std::size_t x = o; x < o + hn::Lanes(D()); ++x) {
      const std::size_t y = x + width_;
      if (!(at[y] < 0.0)) continue;
      const double up = -physics_.floor_stiffness * at[y];
      const double c = physics_.floor_friction_coefficient;
      const double multiplier = physics_.floor_friction_multiplier * c;
      const double velocity = velocity_in<n>(k, x);
      const double grip = math::reference_tanh(velocity * up * c);
      const double slope = 1.0 - grip * grip;
      const double by_up =
          by_force_[y] - multiplier * by_force_[x] * (grip + up * slope * velocity * c);
      stage_position_[y] -= physics_.floor_stiffness * by_up;
      stage_velocity_[x] -= multiplier * by_force_[x] * up * slope * up * c;
    }
  }

  // Velocity in a stage, from where the next one evaluates.
  template <int n>
  double velocity_in(std::size_t k, std::size_t o) const {
    const double v = recorded(k, Row::velocity)[o];
    const double start = recorded(k, Row::position)[o];
    const double second = (recorded(k, Row::third_stage)[o] - start) * 2.0 / physics_.substep;
    const double third = (recorded(k, Row::fourth_stage)[o] - start) / physics_.substep;
    if constexpr (n == 1) return v;
    if constexpr (n == 2) return second;
    if constexpr (n == 3) return third;
    const double all = (recorded(k, Row::after_stages)[o] - start) * 6.0 / physics_.substep;
    return all - v - 2.0 * second - 2.0 * third;
  }

  // ---- what follows from the start of the substep -----------------------------------------------

  void rest_lengths(std::size_t k) {
    const double* start = recorded(k, Row::position);
    for (std::size_t s = 0; s < springs_.size(); ++s) {
      const auto [a, b] = springs_[s];
      const V by_rest = load(by_rest_ + s * width_);
      const Vector q = difference(start, a, b);
      const V f = hn::Mul(hn::Mul(set(1.0 - physics_.actuation_rate), by_rest),
                          load(reciprocal_ + s * width_));
      add_difference(position_, springs_[s], {hn::Mul(f, q.x), hn::Mul(f, q.y)});
      add(by_goal_ + s * width_, hn::Mul(set(physics_.actuation_rate), by_rest));
    }
  }

  void contacts(std::size_t k) {
    const std::size_t first = record_.first_touch[k];
    const std::size_t last =
        k + 1 < record_.substeps() ? record_.first_touch[k + 1] : record_.touches.size();
    for (std::size_t t = first; t < last; ++t) {
      const Touch& touch = record_.touches[t];
      if (touch.lane < first_ || touch.lane >= first_ + hn::Lanes(D())) continue;
      const StepRecord::Member& member = record_.members[touch.lane];
      if (!member.is_done) continue;
      const std::size_t i = touch.lane - first_;
      const PointView view{.position = recorded(k, Row::position) + i,
                           .previous = record_.before(k) + first_ + i,
                           .stride = width_};
      pull_back_touch(member.model->compiled(), touch, view, record_.onset,
                      {contact_ + i, position_ + i, previous_ + i, by_constants_ + i});
    }
  }

  const StepRecord& record_;
  const Model::Compiled& model_;  // of any lane, for what they share
  const Plan& plan_;
  const Physics& physics_;
  std::size_t width_;
  std::size_t first_;
  std::size_t pairs_;  // values of an array of pairs

  hwy::AlignedFreeUniquePtr<double[]> memory_;
  // Derivatives, [N pairs]: by the state after the substep, or before it when that is done;
  double* position_ = nullptr;
  double* velocity_ = nullptr;
  double* previous_ = nullptr;
  // by forces of a stage, by where it evaluates, sums of those of later ones; by contact forces.
  double* by_force_ = nullptr;
  double* stage_position_ = nullptr;
  double* stage_velocity_ = nullptr;
  double* position_sum_ = nullptr;
  double* velocity_sum_ = nullptr;
  double* contact_ = nullptr;
  // Positions: of stage 2, and under strain limits.
  double* second_stage_ = nullptr;
  double* limited_ = nullptr;
  double* edges_ = nullptr;  // [rigid edges pairs] differences of their ends, in turn
  // [springs] x W: lengths, of rest 1/length at the start; derivatives.
  double* goal_ = nullptr;
  double* rest_ = nullptr;
  double* reciprocal_ = nullptr;
  double* by_rest_ = nullptr;
  double* by_goal_ = nullptr;
  double* by_stiffness_ = nullptr;
  double* by_constants_ = nullptr;  // [gradient_constants] x W

  bool with_stiffness_ = false;
  bool with_constants_ = false;
  std::vector<Ends> springs_;   // offsets, in the order of Dynamics
  std::vector<double> free_;    // [N] 1 for points that substeps move, else 0
  std::vector<double> moving_;  // [N] and those that only stages move
  std::vector<std::size_t> long_springs_;
  std::vector<std::size_t> long_edges_;
};

template <class D>
void PullBackLanes(const StepRecord& record, std::span<Gradient> gradients) {
  for (std::size_t first = 0; first < record.members.size(); first += hn::Lanes(D()))
    StepAdjoint<D>(record, first).run(gradients);
}

// A record's width is that of the instruction set that made it.
void PullBack(const StepRecord& record, std::span<Gradient> gradients) {
  using Several = hn::ScalableTag<double>;
  if (record.width % hn::Lanes(Several()) == 0)
    PullBackLanes<Several>(record, gradients);
  else
    PullBackLanes<hn::CappedTag<double, 1>>(record, gradients);
}

}  // namespace HWY_NAMESPACE
}  // namespace evo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace evo {
namespace {

HWY_EXPORT(PullBack);

}  // namespace

void pull_back(const StepRecord& record, std::span<Gradient> gradients) {
  HWY_DYNAMIC_DISPATCH(PullBack)(record, gradients);
}

// ---- tapes -------------------------------------------------------------------------------

Gradient zero_gradient(const Model& model, GradientParts wanted) {
  Gradient gradient;
  const auto points = static_cast<std::size_t>(model.compiled().moving_points);
  for_each_array(gradient.state, [&](auto& values) { values.resize(points); });
  gradient.state.targets.resize(static_cast<std::size_t>(model.compiled().dynamics.actuators));
  if (wanted.stiffness) gradient.stiffness.assign(model.cells().size(), 0.0);
  if (wanted.constants) gradient.constants.assign(gradient_constants, 0.0);
  return gradient;
}

Tape::Tape(double onset) : impl_(std::make_unique<Impl>()) {
  constexpr double widest_onset = 0.1;
  if (!(onset >= 0.0 && onset <= widest_onset))
    throw error(Failure::usage, "the onset of contact is spread over 0 to {} voxels, not {}",
                widest_onset, onset);
  impl_->onset = onset;
}
Tape::~Tape() = default;
Tape::Tape(Tape&&) noexcept = default;

void Tape::pull_back(std::span<Gradient> gradients, ThreadPool* pool) const {
  const std::span records = std::span(impl_->records).first(impl_->used);
  const auto run = [&](std::size_t i, int) { evo::pull_back(records[i], gradients); };
  if (pool != nullptr && pool->threads() > 1 && records.size() > 1) {
    pool->run(records.size(), run);
  } else {
    for (std::size_t i = 0; i < records.size(); ++i) run(i, 0);
  }
}

}  // namespace evo
#endif  // HWY_ONCE
