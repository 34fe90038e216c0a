#include "libevo/evolve/select.h"

#include <array>
#include <catch2/catch.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "libevo/base/error.h"

using namespace evo;

namespace {

constexpr double failure = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// Robots created so far, survivors.
using Schedule = std::vector<std::pair<int, int>>;
Schedule schedule(int population, int max_evaluations) {
  Schedule all;
  for (const PlannedGeneration& generation : paper_plan(population, max_evaluations))
    all.emplace_back(generation.created, generation.survivors);
  return all;
}

}  // namespace

TEST_CASE("the survivor schedule is the paper's, generation by generation") {
  const Schedule of_250{{25, 14}, {36, 13}, {48, 13}, {60, 12}, {73, 11},
                        {87, 10}, {102, 9}, {118, 8}, {135, 7}, {153, 6},
                        {172, 5}, {192, 4}, {213, 3}, {235, 2}, {250, 0}};
  CHECK(schedule(25, 250) == of_250);

  const auto first = [](Schedule all, std::size_t n) {
    all.resize(n);
    return all;
  };
  const Schedule of_500{{25, 15}, {35, 14}, {46, 14}, {57, 14},
                        {68, 13}, {80, 13}, {92, 13}, {104, 12}};
  CHECK(schedule(25, 500).size() == 31);
  CHECK(first(schedule(25, 500), 8) == of_500);
  const Schedule of_750{{25, 15}, {35, 15}, {45, 15}, {55, 14}, {66, 14}};
  CHECK(schedule(25, 750).size() == 47);
  CHECK(first(schedule(25, 750), 5) == of_750);
}

TEST_CASE("the survivor schedule is exact where the product is a whole number") {
  // 20 * 0.6 * 28/48 = 7; in floating point the product is a little more than 7.
  CHECK(paper_survivors(20, 20, 49) == 7);
  CHECK(paper_survivors(3, 3, 6) == 2);
  CHECK(paper_survivors(25, 250, 250) == 2);
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
