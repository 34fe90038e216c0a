#include "libevo/evolve/select.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <limits>
#include <ostream>
#include <set>

#include "libevo/base/error.h"

using namespace evo;

namespace {

constexpr double failure = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

struct Generation {
  int created;
  int survivors;
  bool operator==(const Generation&) const = default;
};

std::ostream& operator<<(std::ostream& out, const Generation& g) {
  return out << g.created << ':' << g.survivors;
}

// The loop of the genetic algorithm (robots.md 2.3), counting only.
std::vector<Generation> schedule(int population, int max_evaluations) {
  std::vector<Generation> generations;
  for (int created = population;;) {
    const int survivors = paper_survivors(population, created, max_evaluations);
    generations.push_back({created, survivors});
    if (created == max_evaluations) return generations;
    created = std::min(created + population - survivors, max_evaluations);
  }
}

}  // namespace

TEST_CASE("the survivor schedule is the paper's, generation by generation") {
  const std::vector<Generation> expected250{{25, 14}, {36, 13}, {48, 13}, {60, 12}, {73, 11},
                                            {87, 10}, {102, 9}, {118, 8}, {135, 7}, {153, 6},
                                            {172, 5}, {192, 4}, {213, 3}, {235, 2}, {250, 2}};
  CHECK(schedule(25, 250) == expected250);
  CHECK(schedule(25, 250).size() == 15);

  const auto first = [](std::vector<Generation> all, std::size_t n) {
    all.resize(n);
    return all;
  };
  CHECK(schedule(25, 500).size() == 31);
  CHECK(first(schedule(25, 500), 8) ==
        std::vector<Generation>{
            {25, 15}, {35, 14}, {46, 14}, {57, 14}, {68, 13}, {80, 13}, {92, 13}, {104, 12}});
  CHECK(schedule(25, 750).size() == 47);
  CHECK(first(schedule(25, 750), 5) ==
        std::vector<Generation>{{25, 15}, {35, 15}, {45, 15}, {55, 14}, {66, 14}});
}

TEST_CASE("the survivor schedule is exact where the product is a whole number") {
  // 20 * 0.6 * 28/48 = 7; in floating point the product is a little more than 7.
  CHECK(paper_survivors(20, 20, 49) == 7);
  CHECK(paper_survivors(3, 3, 6) == 2);
  CHECK(paper_survivors(1'000'000, 1'000'000, 1'000'000'000) == 599'400);
}

TEST_CASE("counts that make no schedule are refused") {
  for (const auto& [p, e, m] : {std::array{0, 1, 10}, std::array{25, 0, 10}, std::array{1, 1, 1},
                                std::array{25, 251, 250}}) {
    CHECK_THROWS_AS(paper_survivors(p, e, m), Error);
  }
}

TEST_CASE("truncation keeps the best, stable, failures last") {
  const std::vector<double> scores{1.0, failure, 3.0, 1.0, -infinity, 3.0, failure};
  CHECK(rank(scores) == Indices{2, 5, 0, 3, 4, 1, 6});
  CHECK(select_truncation(scores, 3) == Indices{2, 5, 0});
  CHECK(select_truncation(scores, 100).size() == 7);
  CHECK(select_truncation({}, 3).empty());
}

TEST_CASE("without generations: how many parents a robot may have") {
  // With whole populations known it is the schedule of the generations.
  for (const int known : {25, 40, 100, 249, 250})
    CHECK(steady_parents(25, known, 250) == paper_survivors(25, known, 250));
  CHECK(steady_parents(25, 10, 250) == 6);  // 0.6 of ten, nearly
  CHECK(steady_parents(25, 1, 250) == 2);
}
