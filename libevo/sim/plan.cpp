#include "libevo/sim/plan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <tuple>

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

// Springs have two rest lengths, so limits are worked out once a length.
class LimitTable {
 public:
  explicit LimitTable(double limit) : limit_(limit) {}
  const StrainLimit& of(double rest) {
    for (const auto& [known, found] : known_)
      if (known == rest) return found;
    known_.emplace_back(rest, strain_limit(rest, limit_));
    return known_.back().second;
  }

 private:
  double limit_;
  std::vector<std::pair<double, StrainLimit>> known_;
};

enum class Role : std::uint8_t { free, anchored, held };

class Planner {
 public:
  Planner(const Dynamics& dynamics, const Physics& physics)
      : dynamics_(dynamics), physics_(physics) {}

  Plan make(const std::vector<int>& first_points) {
    choose_springs();
    gather_ends();
    choose_roles();
    number_slots(first_points);
    list_springs();
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
    felt_.assign(at(dynamics_.points), 0);
    for (int s = 0; s < static_cast<int>(dynamics_.springs.size()); ++s) {
      const Spring& spring = dynamics_.springs[at(s)];
      if (!moves[at(spring.a)] && !moves[at(spring.b)]) continue;
      chosen_.push_back(s);
      felt_[at(spring.a)] = felt_[at(spring.b)] = 1;
    }
    plan_.live_springs = static_cast<int>(chosen_.size());
    for (int s = 0; s < static_cast<int>(dynamics_.springs.size()); ++s) {
      const Spring& spring = dynamics_.springs[at(s)];
      if (moves[at(spring.a)] || moves[at(spring.b)]) continue;
      if (felt_[at(spring.a)] || felt_[at(spring.b)]) chosen_.push_back(s);
    }
    plan_.springs = static_cast<int>(chosen_.size());
    number_.assign(dynamics_.springs.size(), -1);
    for (int n = 0; n < plan_.springs; ++n) number_[at(chosen_[at(n)])] = n;
  }

  void gather_ends() {
    a_ends_.resize(at(dynamics_.points));
    b_ends_.resize(at(dynamics_.points));
    for (std::size_t s = 0; s < dynamics_.springs.size(); ++s) {  // the order of summation
      if (number_[s] < 0) continue;
      a_ends_[at(dynamics_.springs[s].a)].push_back(number_[s]);
      b_ends_[at(dynamics_.springs[s].b)].push_back(number_[s]);
    }
  }

  void choose_roles() {
    for (std::size_t i = 0; i < at(dynamics_.points); ++i)
      roles_.push_back(!dynamics_.fixed[i] ? Role::free : felt_[i] ? Role::anchored : Role::held);
  }

  void number_slots(const std::vector<int>& first_points) {
    plan_.slots = dynamics_.points;
    plan_.slot_of.resize(at(dynamics_.points));
    for (std::size_t block = 0; block + 1 < first_points.size(); ++block) {
      std::vector<int> points;
      for (int i = first_points[block]; i < first_points[block + 1]; ++i) points.push_back(i);
      const auto key = [&](int i) {
        return std::tuple(roles_[at(i)], a_ends_[at(i)].size(), b_ends_[at(i)].size());
      };
      std::stable_sort(points.begin(), points.end(), [&](int i, int j) {
        if (roles_[at(i)] == Role::held && roles_[at(j)] == Role::held) return false;
        return key(i) < key(j);
      });
      PlanBlock info;
      info.first = static_cast<int>(plan_.state_of.size());
      info.count = static_cast<int>(points.size());
      for (std::size_t k = 0; k < points.size(); ++k) {
        const int i = points[k];
        const int slot = static_cast<int>(plan_.state_of.size());
        plan_.slot_of[at(i)] = slot;
        plan_.state_of.push_back(i);
        if (roles_[at(i)] == Role::held) continue;
        ++info.integrated;
        if (k == 0 || key(points[k - 1]) != key(i)) {
          PlanRun run;
          run.first = slot;
          run.a_ends = static_cast<int>(a_ends_[at(i)].size());
          run.b_ends = static_cast<int>(b_ends_[at(i)].size());
          run.first_end = static_cast<int>(plan_.ends.size());
          run.anchored = roles_[at(i)] == Role::anchored;
          plan_.runs.push_back(run);
        }
        ++plan_.runs.back().count;
        plan_.ends.insert(plan_.ends.end(), a_ends_[at(i)].begin(), a_ends_[at(i)].end());
        plan_.ends.insert(plan_.ends.end(), b_ends_[at(i)].begin(), b_ends_[at(i)].end());
      }
      plan_.blocks.push_back(info);
    }
  }

  void list_springs() {
    LimitTable limits(physics_.strain_limit);
    const auto padded =
        (chosen_.size() + Plan::spring_padding - 1) / Plan::spring_padding * Plan::spring_padding;
    for (std::size_t n = 0; n < padded; ++n) {
      const Spring& s = dynamics_.springs[at(chosen_[std::min(n, chosen_.size() - 1)])];
      plan_.a.push_back(plan_.slot_of[at(s.a)]);
      plan_.b.push_back(plan_.slot_of[at(s.b)]);
      plan_.a_free.push_back(dynamics_.fixed[at(s.a)] ? 0 : 1);
      plan_.b_free.push_back(dynamics_.fixed[at(s.b)] ? 0 : 1);
      plan_.rest.push_back(s.rest);
      plan_.stiffness.push_back(s.stiffness);
      plan_.limits.push_back(limits.of(s.rest));
      plan_.shortest_square.push_back(plan_.limits.back().shortest_square);
      plan_.longest_square.push_back(plan_.limits.back().longest_square);
    }
  }

  void list_rigid_edges() {
    LimitTable limits(physics_.rigid_strain_limit);
    for (const int edge : dynamics_.rigid_edges) {
      plan_.rigid_edges.push_back(number_[at(edge)]);
      plan_.rigid_limits.push_back(limits.of(dynamics_.springs[at(edge)].rest));
    }
  }

  void list_drives() {
    for (const Drive& d : dynamics_.drives)
      if (number_[at(d.spring)] >= 0)
        plan_.drives.push_back({number_[at(d.spring)], d.first_actuator, d.second_actuator});
  }

  const Dynamics& dynamics_;
  const Physics& physics_;
  Plan plan_;
  std::vector<int> chosen_;           // springs of Dynamics in plan order
  std::vector<std::int32_t> number_;  // spring of Dynamics -> of the plan, or -1
  std::vector<std::uint8_t> felt_;    // a point: it is an end of a live spring
  std::vector<std::vector<std::int32_t>> a_ends_, b_ends_;
  std::vector<Role> roles_;
};

}  // namespace

Plan make_plan(const Dynamics& dynamics, const std::vector<int>& first_points,
               const Physics& physics) {
  return Planner(dynamics, physics).make(first_points);
}

}  // namespace evo
