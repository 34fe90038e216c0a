#include "libevo/sim/plan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "libevo/sim/compiled.h"

namespace evo {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// The smallest positive double for which `holds`, which is false below some
// number and true above it. Positive doubles are ordered as their bits are.
template <class Predicate>
double first_that(Predicate holds) {
  std::uint64_t low = 0;                                             // false here
  std::uint64_t high = std::bit_cast<std::uint64_t>(double{1e300});  // true here
  while (high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    (holds(std::bit_cast<double>(middle)) ? high : low) = middle;
  }
  return std::bit_cast<double>(high);
}

StrainLimit strain_limit(double rest, double limit) {
  const auto strain = [rest](double square) { return std::sqrt(square) / rest; };
  StrainLimit result;
  const double too_long = first_that([&](double square) { return strain(square) > 1.0 + limit; });
  result.longest_square = std::nextafter(too_long, 0.0);
  if (limit < 1.0)
    result.shortest_square =
        first_that([&](double square) { return strain(square) >= 1.0 - limit; });
  result.shortest = (1.0 - limit) * rest;
  result.longest = (1.0 + limit) * rest;
  return result;
}

// By rest length: springs have two, so limits are worked out once a length.
using LimitTable = std::map<double, StrainLimit>;
const StrainLimit& limit_of(double rest, double limit, LimitTable& known) {
  const auto [found, is_new] = known.try_emplace(rest);
  if (is_new) found->second = strain_limit(rest, limit);
  return found->second;
}

enum class Role : std::uint8_t { free, anchored, held };

class Planner {
 public:
  Planner(const Dynamics& dynamics, const Physics& physics)
      : dynamics_(dynamics), physics_(physics) {}

  Plan make(const std::vector<int>& first_points) {
    choose_springs();
    number_sites(first_points);
    order_points();
    mirror_springs();
    order_springs();
    list_points();
    list_strain_limits();
    list_rigid_edges();
    list_drives();
    return std::move(plan_);
  }

 private:
  // A live spring has an end that is not fixed, or that belongs to a rigid
  // cell: the second pass of strain limiting moves those even when fixed.
  void choose_springs() {
    std::vector<std::uint8_t> moves(at(dynamics_.points));
    for (std::size_t i = 0; i < moves.size(); ++i) moves[i] = dynamics_.fixed[i] ? 0 : 1;
    for (const int edge : dynamics_.rigid_edges) {
      moves[at(dynamics_.springs[at(edge)].a)] = 1;
      moves[at(dynamics_.springs[at(edge)].b)] = 1;
    }
    std::vector<std::uint8_t> felt(at(dynamics_.points));  // an end of a live spring
    for (int s = 0; s < static_cast<int>(dynamics_.springs.size()); ++s) {
      const Spring& spring = dynamics_.springs[at(s)];
      if (!moves[at(spring.a)] && !moves[at(spring.b)]) continue;
      live_.push_back(s);
      felt[at(spring.a)] = felt[at(spring.b)] = 1;
    }
    for (int s = 0; s < static_cast<int>(dynamics_.springs.size()); ++s) {
      const Spring& spring = dynamics_.springs[at(s)];
      if (moves[at(spring.a)] || moves[at(spring.b)]) continue;
      if (felt[at(spring.a)] || felt[at(spring.b)]) frozen_.push_back(s);
    }
    for (std::size_t i = 0; i < felt.size(); ++i)
      roles_.push_back(!dynamics_.fixed[i] ? Role::free : felt[i] ? Role::anchored : Role::held);
  }

  void number_sites(const std::vector<int>& first_points) {
    plan_.sites = dynamics_.points;
    plan_.site_of.resize(at(dynamics_.points));
    for (std::size_t block = 0; block + 1 < first_points.size(); ++block) {
      PlanBlock info;
      info.first = static_cast<int>(plan_.state_of.size());
      info.count = first_points[block + 1] - first_points[block];
      for (const Role role : {Role::free, Role::anchored, Role::held}) {
        for (int i = first_points[block]; i < first_points[block + 1]; ++i) {
          if (roles_[at(i)] != role) continue;
          plan_.site_of[at(i)] = static_cast<std::int32_t>(plan_.state_of.size());
          plan_.state_of.push_back(i);
          if (role != Role::held) ++info.integrated;
        }
      }
      plan_.blocks.push_back(info);
    }
  }

  // Regular points before irregular ones, free before anchored ones, by site.
  void order_points() {
    a_ends_.resize(at(dynamics_.points));
    b_ends_.resize(at(dynamics_.points));
    std::vector<int> chosen = live_;
    chosen.insert(chosen.end(), frozen_.begin(), frozen_.end());
    std::sort(chosen.begin(), chosen.end());  // the order of summation
    for (const int s : chosen) {
      a_ends_[at(dynamics_.springs[at(s)].a)].push_back(s);
      b_ends_[at(dynamics_.springs[at(s)].b)].push_back(s);
    }
    for (const std::int32_t i : plan_.state_of)
      if (roles_[at(i)] != Role::held) order_.push_back(i);
    std::stable_sort(order_.begin(), order_.end(), [&](int i, int j) { return turn(i) < turn(j); });
    const auto first_of = [&](int t) {
      const auto comes_before = [&](int i) { return turn(i) < t; };
      return static_cast<std::size_t>(
          std::partition_point(order_.begin(), order_.end(), comes_before) - order_.begin());
    };
    plan_.free_regular = first_of(1);
    plan_.regular = first_of(2);
    plan_.free_irregular = first_of(3);
    rank_.assign(at(dynamics_.points), static_cast<int>(order_.size()));
    for (std::size_t k = 0; k < order_.size(); ++k) rank_[at(order_[k])] = static_cast<int>(k);
  }

  bool is_regular(int i) const {
    return a_ends_[at(i)].size() + b_ends_[at(i)].size() <= 2UL * Plan::regular_ends;
  }
  int turn(int i) const {
    return (is_regular(i) ? 0 : 2) + (roles_[at(i)] == Role::anchored ? 1 : 0);
  }

  // Moves what is too much for one list of a regular point to the other one.
  void mirror_springs() {
    const std::size_t few = Plan::regular_ends;
    for (const int i : order_) {
      if (!is_regular(i)) continue;
      std::vector<int>& a = a_ends_[at(i)];
      std::vector<int>& b = b_ends_[at(i)];
      while (a.size() > few) {  // the last a becomes the first b
        b.insert(b.begin(), mirror(a.back()));
        a.pop_back();
      }
      while (b.size() > few) {  // the first b becomes the last a
        a.push_back(mirror(b.front()));
        b.erase(b.begin());
      }
    }
  }

  // A spring of Dynamics, or, numbered from their count on, a mirror image.
  Spring spring(int s) const {
    const int count = static_cast<int>(dynamics_.springs.size());
    Spring result = dynamics_.springs[at(s < count ? s : s - count)];
    if (s >= count) std::swap(result.a, result.b);
    return result;
  }
  int mirror(int s) {
    const int image = s + static_cast<int>(dynamics_.springs.size());
    const bool is_frozen = std::find(frozen_.begin(), frozen_.end(), s) != frozen_.end();
    std::vector<int>& images = is_frozen ? frozen_images_ : live_images_;
    if (std::find(images.begin(), images.end(), image) == images.end()) images.push_back(image);
    return image;
  }

  int first_rank(int s) const { return std::min(rank_[at(spring(s).a)], rank_[at(spring(s).b)]); }

  // Springs follow the points: whichever end is integrated first decides, so
  // that a point can be integrated soon after its last spring is computed.
  void order_springs() {
    std::vector<int> live = live_;
    live.insert(live.end(), live_images_.begin(), live_images_.end());
    std::stable_sort(live.begin(), live.end(),
                     [&](int s, int t) { return first_rank(s) < first_rank(t); });
    std::vector<int> frozen = frozen_;
    frozen.insert(frozen.end(), frozen_images_.begin(), frozen_images_.end());
    number_.assign(2 * dynamics_.springs.size(), -1);
    list_springs(live);
    plan_.live_springs = static_cast<int>(live.size());
    plan_.first_frozen = static_cast<int>(plan_.a.size());
    list_springs(frozen);
    plan_.springs = plan_.first_frozen + static_cast<int>(frozen.size());
    plan_.null_spring = static_cast<int>(plan_.a.size());
    list_springs_before(live);
    list_points_before(live);
  }

  void list_springs(const std::vector<int>& springs) {
    for (std::size_t n = 0; n < padded(springs.size()); ++n) {
      const int name = springs[std::min(n, springs.size() - 1)];
      if (n < springs.size()) number_[at(name)] = static_cast<std::int32_t>(plan_.a.size());
      const Spring s = spring(name);
      plan_.a.push_back(plan_.site_of[at(s.a)]);
      plan_.b.push_back(plan_.site_of[at(s.b)]);
      plan_.rest.push_back(s.rest);
      plan_.stiffness.push_back(s.stiffness);
    }
  }

  static std::size_t padded(std::size_t springs) {
    return (springs + Plan::spring_padding - 1) / Plan::spring_padding * Plan::spring_padding;
  }

  void list_springs_before(const std::vector<int>& live) {
    std::size_t springs = 0;
    for (std::size_t k = 0; k < plan_.regular; ++k) {
      while (springs < live.size() && first_rank(live[springs]) <= static_cast<int>(k)) ++springs;
      plan_.springs_before.push_back(static_cast<std::int32_t>(springs));
    }
  }

  void list_points_before(const std::vector<int>& live) {
    int points = 0;
    for (const int s : live) {
      for (const int end : {spring(s).a, spring(s).b})
        if (roles_[at(end)] != Role::held) points = std::max(points, rank_[at(end)] + 1);
      plan_.points_before.push_back(points);
    }
  }

  void list_points() {
    for (const int i : order_) {
      PlanPoint point{plan_.site_of[at(i)], static_cast<std::int32_t>(plan_.ends.size()), 0, 0};
      point.a_ends = list_ends(a_ends_[at(i)], is_regular(i));
      point.b_ends = list_ends(b_ends_[at(i)], is_regular(i));
      plan_.points.push_back(point);
    }
  }

  std::int32_t list_ends(const std::vector<int>& springs, bool regular) {
    const std::size_t count = regular ? Plan::regular_ends : springs.size();
    for (std::size_t k = 0; k < count; ++k)
      plan_.ends.push_back(k < springs.size() ? number_[at(springs[k])] : plan_.null_spring);
    return static_cast<std::int32_t>(count);
  }

  void list_strain_limits() {
    LimitTable known;
    Plan::Strain& strain = plan_.strain;
    strain.springs = live_.size();
    for (std::size_t n = 0; n < padded(live_.size()); ++n) {
      const Spring& s = dynamics_.springs[at(live_[std::min(n, live_.size() - 1)])];
      strain.a.push_back(plan_.site_of[at(s.a)]);
      strain.b.push_back(plan_.site_of[at(s.b)]);
      strain.a_free.push_back(dynamics_.fixed[at(s.a)] ? 0 : 1);
      strain.b_free.push_back(dynamics_.fixed[at(s.b)] ? 0 : 1);
      strain.limits.push_back(limit_of(s.rest, physics_.strain_limit, known));
      strain.shortest_square.push_back(strain.limits.back().shortest_square);
      strain.longest_square.push_back(strain.limits.back().longest_square);
    }
  }

  void list_rigid_edges() {
    LimitTable known;
    for (const int edge : dynamics_.rigid_edges) {
      const Spring& s = dynamics_.springs[at(edge)];
      plan_.rigid_edges.push_back({plan_.site_of[at(s.a)], plan_.site_of[at(s.b)],
                                   limit_of(s.rest, physics_.rigid_strain_limit, known)});
    }
  }

  void list_drives() {
    for (const Drive& d : dynamics_.drives)
      for (const std::int32_t n :
           {number_[at(d.spring)], number_[dynamics_.springs.size() + at(d.spring)]})
        if (n >= 0) plan_.drives.push_back({n, d.first_actuator, d.second_actuator});
  }

  const Dynamics& dynamics_;
  const Physics& physics_;
  Plan plan_;
  std::vector<int> live_, frozen_;  // springs, in the order of Dynamics
  std::vector<int> live_images_, frozen_images_;
  std::vector<std::int32_t> number_;  // a spring or image -> its place in the plan, or -1
  std::vector<Role> roles_;
  std::vector<std::vector<int>> a_ends_, b_ends_;  // by point: its springs
  std::vector<int> order_;                         // points as they are integrated
  std::vector<int> rank_;                          // by point: its place in that order
};

}  // namespace

Plan make_plan(const Dynamics& dynamics, const std::vector<int>& first_points,
               const Physics& physics) {
  return Planner(dynamics, physics).make(first_points);
}

}  // namespace evo
