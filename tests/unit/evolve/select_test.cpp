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

TEST_CASE("tournaments choose distinct individuals, best first, better ones more often") {
  std::vector<double> scores;
  for (int i = 0; i < 20; ++i) scores.push_back(i == 7 ? failure : i);
  const Indices order = rank(scores);
  std::vector<std::size_t> place(20);
  for (std::size_t i = 0; i < 20; ++i) place[order[i]] = i;
  std::vector<int> chosen(20);
  for (std::uint64_t run = 0; run < 2000; ++run) {
    Stream stream(1, "tournament", run);
    const Indices winners = select_tournament(scores, 5, 3, stream);
    REQUIRE(std::set<std::size_t>(winners.begin(), winners.end()).size() == 5);
    REQUIRE(std::is_sorted(winners.begin(), winners.end(),
                           [&](std::size_t a, std::size_t b) { return place[a] < place[b]; }));
    for (const std::size_t w : winners) ++chosen[w];
  }
  CHECK(chosen[19] > 1000);
  CHECK(chosen[19] > chosen[12]);
  CHECK(chosen[12] > chosen[3]);
  CHECK(chosen[7] < chosen[0] + 20);

  Stream stream(1, "tournament");
  CHECK(select_tournament(scores, 100, 2, stream) == order);  // everybody wins once
  CHECK_THROWS_AS(select_tournament(scores, 5, 0, stream), Error);
}

TEST_CASE("a tournament of one is a uniform choice") {
  const std::vector<double> scores{5.0, 4.0, 3.0, 2.0};
  std::vector<int> chosen(4);
  for (std::uint64_t run = 0; run < 8000; ++run) {
    Stream stream(2, "tournament", run);
    ++chosen[select_tournament(scores, 1, 1, stream).front()];
  }
  for (const int count : chosen) CHECK(count == Approx(2000).margin(160));
}

TEST_CASE("non-dominated sorting of a hand-made set") {
  // Maximise the first, minimise the second objective.
  const Objectives objectives{{1.0, -1.0},
                              {{4, 4},        // 0: front 1
                               {1, 1},        // 1: front 1
                               {1, 2},        // 2: beaten by 1 and 4
                               {0, 5},        // 3: beaten by all of front 1 and by 2
                               {2, 2},        // 4: front 1
                               {failure, 0},  // 5: failed
                               {4, 4},        // 6: equal to 0, front 1
                               {3, 3.9}}};    // 7: front 1
  CHECK(pareto_fronts(objectives) == std::vector<Indices>{{0, 1, 4, 6, 7}, {2}, {3}, {5}});

  // Crowding on the first front, first objective 1 2 3 4 4 (range 3), second
  // 1 2 3.9 4 4 (range 3): ends infinite, 4: 2/3 + 2.9/3, 7: 2/3 + 2/3; of the
  // equal 0 and 6 the first lies inside: (4-3)/3 + (4-3.9)/3.
  const auto crowding = crowding_distances(objectives, {0, 1, 4, 6, 7});
  CHECK(crowding[0] == Approx(1.1 / 3));
  CHECK(crowding[1] == infinity);
  CHECK(crowding[2] == Approx(4.9 / 3));
  CHECK(crowding[3] == infinity);
  CHECK(crowding[4] == Approx(2.0 / 3 + 2.0 / 3));

  CHECK(select_pareto(objectives, 6) == Indices{1, 6, 4, 7, 0, 2});
  CHECK(select_pareto(objectives, 100).back() == 5);
}

TEST_CASE("with one objective Pareto selection is truncation") {
  Stream stream(3, "pareto");
  std::vector<double> scores;
  Objectives objectives{{1.0}, {}};
  for (int i = 0; i < 40; ++i) {
    scores.push_back(stream.uniform());
    objectives.rows.push_back({scores.back()});
  }
  CHECK(select_pareto(objectives, 10) == select_truncation(scores, 10));
}

TEST_CASE("no front is dominated by a later one") {
  Stream stream(4, "pareto");
  Objectives objectives{{1.0, -1.0, 1.0}, {}};
  for (int i = 0; i < 60; ++i)
    objectives.rows.push_back({stream.uniform(), stream.uniform(), stream.uniform()});
  const auto fronts = pareto_fronts(objectives);
  const auto beats = [&](std::size_t a, std::size_t b) {
    const auto& x = objectives.rows[a];
    const auto& y = objectives.rows[b];
    return x[0] > y[0] && x[1] < y[1] && x[2] > y[2];
  };
  std::size_t total = 0;
  for (std::size_t f = 0; f < fronts.size(); ++f) {
    total += fronts[f].size();
    for (const std::size_t a : fronts[f]) {
      for (const std::size_t b : fronts[f]) REQUIRE_FALSE(beats(a, b));
      if (f > 0)
        REQUIRE(std::any_of(fronts[f - 1].begin(), fronts[f - 1].end(),
                            [&](std::size_t b) { return beats(b, a); }));
    }
  }
  CHECK(total == 60);
}

TEST_CASE("rows of another length than the signs are refused") {
  CHECK_THROWS_AS(select_pareto({{1.0, 1.0}, {{1.0}}}, 1), Error);
}

TEST_CASE("without generations: what a robot knows, and how many parents it may have") {
  // Population 25, window 10: the first 25 robots know nothing.
  CHECK(known_scores(24, 10, 25) == 0);
  CHECK(known_scores(25, 10, 25) == 15);
  CHECK(known_scores(99, 10, 25) == 89);
  CHECK(known_scores(30, 40, 25) == 0);
  CHECK(known_scores(41, 40, 25) == 1);
  // With whole populations known it is the schedule of the generations.
  for (const int known : {25, 40, 100, 249, 250})
    CHECK(steady_parents(25, known, 250) == paper_survivors(25, known, 250));
  CHECK(steady_parents(25, 10, 250) == 6);  // 0.6 of ten, nearly
  CHECK(steady_parents(25, 1, 250) == 2);
}
