#include "libevo/evolve/suggest.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "libevo/body/operators.h"
#include "tests/unit/expect.h"

using namespace evo;

namespace {

constexpr double failure = std::numeric_limits<double>::quiet_NaN();

// A cheap stand-in for training: every voxel has a worth by kind, and so does
// every pair of kinds side by side. Drawn anew for each seed.
class Landscape {
 public:
  Landscape(int rows, int cols, std::uint64_t seed) {
    Stream stream(seed, "test/landscape");
    for (int i = 0; i < rows * cols * 5; ++i) voxel_.push_back(stream.gaussian());
    for (double& value : pair_) value = stream.gaussian();
  }
  double operator()(const Body& body) const {
    double sum = 0.0;
    for (int row = 0; row < body.rows; ++row)
      for (int col = 0; col < body.cols; ++col) {
        const auto kind = static_cast<std::size_t>(body.at(row, col));
        sum += voxel_[static_cast<std::size_t>(body.index(row, col)) * 5 + kind];
        if (col + 1 < body.cols)
          sum += pair_[kind * 5 + static_cast<std::size_t>(body.at(row, col + 1))];
      }
    return sum;
  }

 private:
  std::vector<double> voxel_;
  std::array<double, 25> pair_{};
};

SuggestSettings quick() {
  SuggestSettings settings;
  settings.candidates = 500;
  settings.fit.restarts = 2;
  return settings;
}

// The best value after `batches` batches of ten, the first one random.
double optimise(const Landscape& landscape, int rows, int cols, int batches,
                const SuggestSettings& settings, std::uint64_t seed) {
  std::vector<Observation> observations;
  double best = -1e9;
  for (int b = 0; b < batches; ++b)
    for (const Suggestion& s : suggest(rows, cols, observations, {}, 10, settings, seed).designs) {
      observations.push_back({s.body.cells, landscape(s.body)});
      best = std::max(best, observations.back().fitness);
    }
  return best;
}

double random_search(const Landscape& landscape, int rows, int cols, int evaluations,
                     std::uint64_t seed) {
  double best = -1e9;
  Stream stream(seed, "test/random-search");
  for (int k = 0; k < evaluations; ++k)
    best = std::max(best, landscape(sample_body(rows, cols, {1, 1, 1, 1, 1}, stream)));
  return best;
}

// How often, of the seeds 1 .. runs, the model's batches beat as many random bodies.
int wins_over_random(int runs, int rows, int cols, int batches, const SuggestSettings& settings) {
  int wins = 0;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(runs); ++seed) {
    const Landscape landscape(rows, cols, seed);
    wins += optimise(landscape, rows, cols, batches, settings, seed) >
            random_search(landscape, rows, cols, 10 * batches, seed);
  }
  return wins;
}

std::vector<Observation> random_observations(int rows, int cols, int n, std::uint64_t seed) {
  const Landscape landscape(rows, cols, seed);
  Stream stream(seed, "test/observations");
  std::vector<Observation> observations;
  for (int i = 0; i < n; ++i) {
    const Body body = sample_body(rows, cols, {1, 1, 1, 1, 1}, stream);
    observations.push_back({body.cells, landscape(body)});
  }
  return observations;
}

}  // namespace

TEST_CASE("the normal distribution is that of the C library to 1e-14") {
  for (double x = -38.0; x < 10.0; x += 0.0137) {
    const double expected = 0.5 * std::erfc(-x / std::sqrt(2.0));
    REQUIRE(normal_distribution(x) == Approx(expected).margin(1e-14));
    // In the lower tail also relative to the value, which is what EI multiplies.
    if (x < 0 && x > -36) REQUIRE(normal_distribution(x) == Approx(expected).epsilon(1e-7));
  }
  CHECK(normal_distribution(0.0) == Approx(0.5).margin(1e-15));
  CHECK(normal_density(1.0) == Approx(0.24197072451914337).epsilon(1e-14));
}

TEST_CASE("expected improvement, by hand") {
  CHECK(expected_improvement(0, 1, 0, 0.01) == Approx(0.3939622273492285).epsilon(1e-12));
  CHECK(expected_improvement(-0.5, 0.3, -0.2, 0.01) == Approx(0.31662197021358046).epsilon(1e-12));
  CHECK(expected_improvement(2, 0.5, -1, 0.01) == Approx(6.889659120251914e-11).epsilon(1e-5));
  // Without uncertainty: the improvement itself or nothing.
  CHECK(expected_improvement(-1, 1e-10, 0, 0.01) == Approx(0.99));
  CHECK(expected_improvement(1, 1e-10, 0, 0.01) == 0.0);
}

TEST_CASE("without observations the batch is random, valid and without repetition") {
  const SuggestedBatch batch = suggest(5, 5, {}, {}, 25, {}, 1);
  CHECK_FALSE(batch.from_model);
  REQUIRE(batch.designs.size() == 25);
  std::set<Design> seen;
  for (const Suggestion& s : batch.designs) {
    CHECK(is_valid_robot(s.body));
    CHECK(seen.insert(s.body.cells).second);
  }
  // Uniform voxels: about a fifth of them empty, unlike the 3/7 of evo-sample.
  int empty = 0;
  for (const Suggestion& s : suggest(5, 5, {}, {}, 200, {}, 2).designs)
    empty += 25 - count_voxels(s.body);
  CHECK(empty / 5000.0 < 0.25);
}

TEST_CASE("a batch is valid, new, without repetition and another one for another seed") {
  auto observations = random_observations(4, 4, 40, 5);
  observations[3].fitness = failure;
  const std::vector<Design> pending{
      suggest(4, 4, observations, {}, 1, quick(), 9).designs[0].body.cells};
  const SuggestedBatch batch = suggest(4, 4, observations, pending, 12, quick(), 9);
  CHECK(batch.from_model);
  REQUIRE(batch.designs.size() == 12);
  std::set<Design> seen(pending.begin(), pending.end());
  for (const Observation& o : observations) seen.insert(o.cells);
  for (const Suggestion& s : batch.designs) {
    CHECK(is_valid_robot(s.body));
    CHECK(seen.insert(s.body.cells).second);
    CHECK(s.stddev > 0.0);
  }
  const SuggestedBatch other = suggest(4, 4, observations, pending, 12, quick(), 10);
  int same = 0;
  for (std::size_t i = 0; i < 12; ++i) same += other.designs[i].body == batch.designs[i].body;
  CHECK(same < 12);
}

TEST_CASE("what is pending counts as observed: less is to be learned near it") {
  // 16 designs are valid; four are observed, one is left.
  std::vector<Observation> observations;
  std::vector<Design> others;
  for (const Suggestion& s : suggest(1, 2, {}, {}, 16, quick(), 1).designs) {
    if (observations.size() < 4)
      observations.push_back({s.body.cells, static_cast<double>(observations.size())});
    else
      others.push_back(s.body.cells);
  }
  const Design left = others.back();
  others.pop_back();
  SuggestSettings settings = quick();
  settings.fit = {.restarts = 1, .max_iterations = 1};  // four say too little to be fitted to
  const SuggestedBatch alone = suggest(1, 2, observations, others, 1, settings, 2);
  REQUIRE(alone.designs.size() == 1);
  CHECK(alone.designs[0].body.cells == left);
  for (const Suggestion& s : suggest(1, 2, observations, {}, 12, settings, 2).designs)
    if (s.body.cells == left) {
      CHECK(alone.designs[0].stddev < s.stddev - 0.01);
      CHECK(alone.designs[0].mean == Approx(s.mean).margin(0.05));  // nothing was learned of it
    }
  const std::vector<Design> other_shape{Design(3, Voxel::rigid)};
  CHECK_THROWS_WITH(suggest(1, 2, observations, other_shape, 1, settings, 2),
                    Catch::Contains("pending design has 3 voxels"));
}

TEST_CASE("the batch is the same for the same seed and any number of threads", "[threads]") {
  const auto observations = random_observations(4, 4, 30, 8);
  const SuggestedBatch alone = suggest(4, 4, observations, {}, 6, quick(), 3);
  for (const int threads : {2, 3, 8}) {
    ThreadPool pool(threads);
    const SuggestedBatch batch = suggest(4, 4, observations, {}, 6, quick(), 3, &pool);
    REQUIRE(batch.designs.size() == 6);
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(batch.designs[i].body == alone.designs[i].body);
      CHECK(batch.designs[i].mean == alone.designs[i].mean);
      CHECK(batch.designs[i].stddev == alone.designs[i].stddev);
    }
  }
}

TEST_CASE("what is proposed is predicted to be better than what is known, on average") {
  const auto observations = random_observations(5, 5, 80, 6);
  double mean = 0.0;
  for (const Observation& o : observations) mean += o.fitness / 80;
  double proposed = 0.0;
  const Landscape landscape(5, 5, 6);
  for (const Suggestion& s : suggest(5, 5, observations, {}, 10, quick(), 1).designs) {
    CHECK(s.mean > mean);
    proposed += landscape(s.body) / 10;
  }
  CHECK(proposed > mean);  // and it is
}

TEST_CASE("equal scores, failures and a single observation make no difference in kind") {
  auto observations = random_observations(3, 3, 10, 7);
  for (Observation& o : observations) o.fitness = 2.5;
  CHECK(suggest(3, 3, observations, {}, 5, quick(), 1).designs.size() == 5);
  observations.resize(1);
  CHECK(suggest(3, 3, observations, {}, 5, quick(), 1).designs.size() == 5);
  observations[0].fitness = failure;
  const SuggestedBatch batch = suggest(3, 3, observations, {}, 5, quick(), 1);
  CHECK_FALSE(batch.from_model);
  for (const Suggestion& s : batch.designs) CHECK(s.body.cells != observations[0].cells);
}

TEST_CASE("a shape with too few designs left and observations of another shape are refused") {
  // 1x2: at least one actuator, no gap possible: 5*5 - 3*3 = 16 designs.
  std::vector<Observation> all;
  for (const Suggestion& s : suggest(1, 2, {}, {}, 16, quick(), 1).designs)
    all.push_back({s.body.cells, 1.0});
  CHECK_THROWS_WITH(suggest(1, 2, {}, {}, 17, quick(), 1), Catch::Contains("only 16 of 17"));
  CHECK_THROWS_WITH(suggest(1, 2, all, {}, 1, quick(), 1), Catch::Contains("only 0 of 1"));
  all.resize(10);
  CHECK(suggest(1, 2, all, {}, 6, quick(), 1).designs.size() == 6);
  test::error_of(Failure::data, [&] { suggest(2, 2, all, {}, 1, quick(), 1); });
}

// Sign test: 9 wins of 10 have p = 0.011, 16 of 20 p = 0.006.
TEST_CASE("the model beats random search on a cheap landscape") {
  CHECK(wins_over_random(10, 4, 4, 4, quick()) >= 9);
}

TEST_CASE("the model beats random search over 20 seeds with the full settings", "[.slow]") {
  CHECK(wins_over_random(20, 5, 5, 6, {}) >= 16);
}
