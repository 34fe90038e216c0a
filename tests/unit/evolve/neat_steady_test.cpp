#include "libevo/evolve/neat_steady.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "libevo/base/error.h"
#include "libevo/evolve/cppn.h"

using namespace evo;

namespace {

constexpr double failure = std::numeric_limits<double>::quiet_NaN();

bool accept_all(const Genome&) { return true; }

// One node, no connections: two genomes are 0.6 |difference of bias| apart.
Genome genome(int key, double bias) {
  Genome g;
  g.key = key;
  insert(g, NodeGene{0, bias});
  return g;
}

NeatSettings small_settings() {
  NeatSettings settings;
  settings.num_inputs = settings.num_outputs = 1;
  settings.pop_size = 6;
  return settings;
}

struct Run {
  NeatSettings settings;
  std::vector<Scored> population;
  NeatState state;

  void tell(int key, double bias, double fitness) {
    join(settings, {genome(key, bias), fitness}, population, state);
  }
  std::vector<std::vector<int>> members() const {
    std::vector<std::vector<int>> all;
    for (const Species& s : state.species) all.push_back(s.members);
    return all;
  }
};

// How many cells a painted body has of the kind that its place asks for: diagonal
// bands of four kinds.
double bands(const Genome& genome) {
  const Body body = decode(genome, 7, 7);
  const auto wanted = [](int row, int col) {
    if (row + col < 4) return Voxel::rigid;
    if (row + col < 7) return Voxel::soft;
    return row + col < 9 ? Voxel::horizontal : Voxel::empty;
  };
  double sum = 0.0;
  for (int row = 0; row < 7; ++row)
    for (int col = 0; col < 7; ++col)
      sum += body.cells[static_cast<std::size_t>(7 * row + col)] == wanted(row, col);
  return sum;
}

// The best of `robots` genomes, each proposed from all scores but the last `window`.
double best_of_run(int robots, int window, std::uint64_t seed) {
  NeatSettings settings;
  settings.pop_size = 25;
  std::vector<Scored> population;
  NeatState state;
  std::vector<Scored> all;
  double best = 0.0;
  for (int k = 0; k < robots; ++k) {
    if (k > window)
      join(settings, all[static_cast<std::size_t>(k - window - 1)], population, state);
    const Individual made = next_individual(settings, population, accept_all, state, k, seed);
    all.push_back({made.genome, bands(made.genome)});
    best = std::max(best, all.back().fitness);
  }
  return best;
}

}  // namespace

TEST_CASE("steady NEAT: scores join species, the founder represents") {
  Run run{small_settings(), {}, {}};
  run.tell(0, 0.0, 1.0);
  run.tell(1, 4.9, 2.0);  // 2.94 from the founder
  run.tell(2, 5.1, 3.0);  // 3.06: a species of its own
  run.tell(3, 9.0, failure);
  run.tell(4, 9.0, 2.5);  // 2.34 from genome 2
  CHECK(run.members() == std::vector<std::vector<int>>{{0, 1}, {2, 4}});
  CHECK(run.state.species[1].representative.key == 2);
  CHECK(run.state.generation == 5);  // scores, the failed one too
  CHECK(run.state.species[0].last_improved == 2);
  CHECK(run.state.species[0].fitness_history == std::vector<double>{2.0});
  CHECK(run.state.species[1].last_improved == 3);
  CHECK_THROWS_WITH(run.tell(4, 1.0, 1.0), Catch::Contains("genome 4 is there twice"));
}

TEST_CASE("steady NEAT: the species beyond its share gives up its worst member") {
  Run run{small_settings(), {}, {}};
  for (int k = 0; k < 4; ++k) run.tell(k, 0.0, k);         // mean 1.5 of 0 .. 9
  for (int k = 4; k < 6; ++k) run.tell(k, 20.0, k + 4.0);  // mean 8.5
  // Adjusted 1.5/9 and 8.5/9 of 6 places: 0.9, raised to min_species_size, and 5.1.
  const std::vector<double> shares = species_shares(run.settings, run.population, run.state);
  CHECK(shares[0] == Approx(2.0));
  CHECK(shares[1] == Approx(5.1));
  run.tell(6, 40.0, -1.0);  // a newcomer, however bad, has its first two places
  CHECK(run.members() == std::vector<std::vector<int>>{{1, 2, 3}, {4, 5}, {6}});
  CHECK(run.population.size() == 6);
}

TEST_CASE("steady NEAT: a species whose members are gone has no share and goes") {
  Run run{small_settings(), {}, {}};
  for (int k = 0; k < 3; ++k) run.tell(k, 0.0, k);
  for (int k = 3; k < 5; ++k) run.tell(k, 20.0, k);
  Species lost;
  lost.key = 9;
  lost.members = {77, 78};
  lost.representative = run.population.front().genome;
  run.state.species.push_back(lost);
  CHECK(species_shares(run.settings, run.population, run.state).back() == 0.0);
  for (int key = 20; key < 30; ++key)
    next_individual(run.settings, run.population, accept_all, run.state, key, 1);
  run.tell(5, 0.0, 1.0);
  CHECK(run.members() == std::vector<std::vector<int>>{{0, 1, 2, 5}, {3, 4}});
  CHECK(adjusted_fitness(std::vector<std::vector<double>>{{}, {1.0, 3.0}}) ==
        std::vector<double>{0.0, 0.5});
}

TEST_CASE("steady NEAT: what does not improve has no children and dies out") {
  Run run{small_settings(), {}, {}};
  run.settings.max_stagnation = 1;  // 6 scores
  const auto next = [&](int key) {
    return next_individual(run.settings, run.population, accept_all, run.state, key, 1);
  };
  run.tell(0, 0.0, 5.0);
  for (int k = 1; k <= 3; ++k) run.tell(k, 20.0, k);
  for (int k = 4; k <= 6; ++k) run.tell(k, 0.0, failure);
  const auto shares = species_shares(run.settings, run.population, run.state);
  CHECK(shares[0] == 0.0);
  CHECK(shares[1] == Approx(6.0));
  for (int key = 20; key < 40; ++key) {
    const Individual made = next(key);
    CHECK(made.genome.key == key);
    for (const int parent : made.parents) CHECK(parent != 0);
  }
  for (int k = 7; k <= 9; ++k) run.tell(k, 20.0, 3.0 + k);
  CHECK(run.members() == std::vector<std::vector<int>>{{1, 2, 3, 7, 8, 9}});
  // Everything stagnant: brand-new genomes, unless the best species is spared.
  for (int k = 41; k < 47; ++k) run.tell(k, 20.0, 0.0);
  CHECK(next(60).parents.empty());
  run.settings.species_elitism = 1;
  CHECK_FALSE(next(61).parents.empty());
}

TEST_CASE("steady NEAT: a child has its parents in one species, among its best") {
  Run run{small_settings(), {}, {}};
  run.settings.pop_size = 20;
  for (int k = 0; k < 10; ++k) run.tell(k, 0.0, k);
  for (int k = 10; k < 20; ++k) run.tell(k, 20.0, k);
  int bred_by_first = 0;
  for (int key = 100; key < 300; ++key) {
    const Individual made =
        next_individual(run.settings, run.population, accept_all, run.state, key, 3);
    REQUIRE_FALSE(made.parents.empty());
    const bool first = made.parents[0] < 10;
    bred_by_first += first;
    for (const int parent : made.parents) {
      CHECK((parent < 10) == first);
      CHECK(parent % 10 >= 8);  // survival_threshold 0.2 of ten
    }
  }
  // Shares: 4.5/19 and 14.5/19 of 20 places.
  CHECK(bred_by_first > 200 * 0.24 * 0.5);
  CHECK(bred_by_first < 200 * 0.24 * 1.6);
}

TEST_CASE("steady NEAT: a child that is not accepted makes room for a random genome") {
  Run run{small_settings(), {}, {}};
  for (int k = 0; k < 6; ++k) run.tell(k, 0.0, k);
  int asked = 0;
  const auto second_only = [&](const Genome&) { return ++asked == 2; };
  const Individual made =
      next_individual(run.settings, run.population, second_only, run.state, 7, 1);
  CHECK(made.parents.empty());
  CHECK(made.genome.key == 7);
  CHECK(asked == 2);
  CHECK_THROWS_WITH(
      next_individual(
          run.settings, run.population, [](const Genome&) { return false; }, run.state, 8, 1),
      Catch::Contains("20000 random genomes"));
}

TEST_CASE("steady NEAT: it finds what random genomes do not, and a wide window costs little") {
  double narrow = 0.0;
  double wide = 0.0;
  double random = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    narrow += best_of_run(500, 1, seed) / 4;
    wide += best_of_run(500, 25, seed) / 4;
    random += best_of_run(500, 500, seed) / 4;  // no score is ever known
  }
  CHECK(narrow > random + 1.0);
  CHECK(wide > random + 1.0);
}
