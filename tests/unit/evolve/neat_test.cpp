#include "libevo/evolve/neat.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "libevo/evolve/cppn.h"
#include "tests/unit/expect.h"

using namespace evo;

namespace {

constexpr double failure = std::numeric_limits<double>::quiet_NaN();

bool accept_all(const Genome&) { return true; }

// Any smooth measure of a genome will do.
double some_fitness(const Genome& genome) {
  double sum = 0.0;
  for (const ConnectionGene& gene : genome.connections) sum += gene.weight;
  return sum;
}

std::vector<Scored> score(const std::vector<Individual>& population,
                          double (*fitness)(const Genome&)) {
  std::vector<Scored> scored;
  for (const Individual& individual : population)
    scored.push_back({individual.genome, fitness(individual.genome)});
  return scored;
}

// Every genome of the population is a member of exactly one species.
void check_partition(const std::vector<Individual>& population, const NeatState& state) {
  std::multiset<int> members;
  std::set<int> species;
  for (const Species& s : state.species) {
    members.insert(s.members.begin(), s.members.end());
    REQUIRE(std::find(s.members.begin(), s.members.end(), s.representative.key) != s.members.end());
    REQUIRE(species.insert(s.key).second);
    REQUIRE(s.key < state.next_species_key);
  }
  REQUIRE(members.size() == population.size());
  for (const Individual& individual : population) {
    REQUIRE(members.count(individual.genome.key) == 1);
    REQUIRE(individual.genome.key < state.next_genome_key);
    for (const NodeGene& node : individual.genome.nodes) REQUIRE(node.key < state.next_node_key);
  }
}

}  // namespace

TEST_CASE("numbers of offspring are those of neat-python") {
  struct Case {
    std::vector<double> adjusted;
    std::vector<int> sizes;
    int population;
    int smallest;
    std::vector<int> expected;
  };
  // Computed with neat-python 0.92.
  const std::vector<Case> cases{
      {{0.5, 0.5}, {25, 25}, 50, 2, {25, 25}},
      {{1.0, 0.0}, {25, 25}, 50, 2, {37, 13}},
      {{0.2, 0.7, 0.1}, {3, 40, 7}, 50, 2, {7, 37, 6}},
      {{0, 0, 0}, {10, 20, 20}, 50, 2, {11, 20, 20}},
      {{0.31, 0.02, 0.9, 0.5, 0.44}, {5, 1, 2, 30, 12}, 25, 2, {3, 2, 4, 12, 6}},
      {{0.9, 0.1}, {1, 1}, 3, 2, {2, 2}},
      {{0.6, 0.2, 0.2}, {26, 25, 99}, 150, 5, {58, 27, 65}}};
  for (const Case& c : cases)
    CHECK(offspring_counts(c.adjusted, c.sizes, c.population, c.smallest) == c.expected);
}

TEST_CASE("speciation: the closest genome represents, the others join the closest or found") {
  NeatSettings settings;
  settings.num_inputs = settings.num_outputs = 1;
  // One node, no connections: the distance is 0.6 |difference of bias|, limit 3, so 5 apart.
  const auto genome = [](int key, double bias) {
    Genome g;
    g.key = key;
    insert(g, NodeGene{0, bias});
    return g;
  };
  NeatState state;
  speciate(settings,
           std::vector<Individual>{{genome(1, 0.0), {}},
                                   {genome(2, 4.9), {}},
                                   {genome(3, 5.1), {}},
                                   {genome(4, 9.0), {}},
                                   {genome(5, -6.0), {}}},
           state);
  const auto members = [&] {
    std::vector<std::vector<int>> all;
    for (const Species& s : state.species) all.push_back(s.members);
    return all;
  };
  CHECK(members() == std::vector<std::vector<int>>{{1, 2}, {3, 4}, {5}});
  CHECK(state.next_species_key == 4);

  // Old representatives 0.0, 5.1, -6.0 take 12, 11 and 13; 10 is near enough to 11 only.
  state.generation = 7;
  const std::vector<Individual> next{{genome(10, 7.0), {}},
                                     {genome(11, 3.5), {}},
                                     {genome(12, 1.0), {}},
                                     {genome(13, 2.0), {}},
                                     {genome(14, 30.0), {}}};
  speciate(settings, next, state);
  CHECK(members() == std::vector<std::vector<int>>{{12}, {11, 10}, {13}, {14}});
  CHECK(state.species[3].created == 7);
  CHECK(state.species[3].key == 4);
  CHECK(state.species[0].representative == next[2].genome);

  // Fewer genomes than species: the last ones end.
  speciate(settings, std::vector<Individual>{{genome(20, 0.0), {}}}, state);
  CHECK(members() == std::vector<std::vector<int>>{{20}});
}

TEST_CASE("generations partition into species, sizes stay near the request, keys are new") {
  NeatSettings settings;
  NeatState state;
  std::vector<Individual> population = first_generation(settings, accept_all, state, 5);
  REQUIRE(population.size() == 50);
  check_partition(population, state);
  int last_key = 50;
  for (int generation = 1; generation <= 25; ++generation) {
    const auto scored = score(population, some_fitness);
    population = next_generation(settings, scored, accept_all, state, 5);
    check_partition(population, state);
    REQUIRE(state.generation == generation);
    REQUIRE(population.size() >= 50);
    REQUIRE(population.size() <= 50 + 2 * state.species.size());
    std::set<int> parents;
    for (const Scored& s : scored) parents.insert(s.genome.key);
    for (const Individual& individual : population) {
      REQUIRE_FALSE(defect(individual.genome, 3, 5));
      REQUIRE(individual.genome.key > last_key);
      REQUIRE(individual.parents.size() <= 2);
      for (const int parent : individual.parents) REQUIRE(parents.contains(parent));
    }
    last_key = population.back().genome.key;
  }
  double best = -1e9;
  for (const Scored& s : score(population, some_fitness)) best = std::max(best, s.fitness);
  CHECK(best > 20.0);  // the sum of weights has gone up
}

TEST_CASE("the order of the scored genomes does not matter") {
  NeatSettings settings;
  NeatState state;
  const auto population = first_generation(settings, accept_all, state, 3);
  auto scored = score(population, some_fitness);
  NeatState other = state;
  const auto a = next_generation(settings, scored, accept_all, state, 3);
  std::reverse(scored.begin(), scored.end());
  const auto b = next_generation(settings, scored, accept_all, other, 3);
  CHECK(state == other);
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) REQUIRE(a[i].genome == b[i].genome);
}

TEST_CASE("what is not accepted is replaced by exactly the missing number of new genomes") {
  NeatSettings settings;
  settings.pop_size = 30;
  int asked = 0;
  std::set<int> passed;
  const Accept odd_only = [&](const Genome& genome) {
    ++asked;
    if (genome.key % 2 == 0) return false;
    passed.insert(genome.key);
    return true;
  };
  NeatState state;
  auto population = first_generation(settings, odd_only, state, 9);
  CHECK(population.size() == 30);
  CHECK(asked == state.next_genome_key - 1);  // every genome of the run was asked for once
  CHECK(population.back().genome.key == 59);  // the 30th odd key: none was made in excess
  check_partition(population, state);

  population = next_generation(settings, score(population, some_fitness), odd_only, state, 9);
  CHECK(population.size() == 30);
  check_partition(population, state);
  for (const Individual& individual : population) CHECK(passed.contains(individual.genome.key));
  const auto fresh = std::count_if(population.begin(), population.end(),
                                   [](const Individual& i) { return i.parents.empty(); });
  CHECK(fresh > 5);
}

TEST_CASE("a surplus of accepted children is kept") {
  NeatSettings settings;
  settings.pop_size = 10;
  settings.compatibility_threshold = 0.0;  // every genome its own species of at least 2
  NeatState state;
  auto population = first_generation(settings, accept_all, state, 4);
  population = next_generation(settings, score(population, some_fitness), accept_all, state, 4);
  CHECK(population.size() == 20);
  check_partition(population, state);
}

TEST_CASE("extinction: new genomes if the settings say so, else an error") {
  NeatSettings settings;
  CHECK(settings.max_stagnation == 15);
  settings.pop_size = 12;
  settings.max_stagnation = 1;
  settings.compatibility_threshold = 100.0;  // one species
  NeatState state;
  auto population = first_generation(settings, accept_all, state, 6);
  const auto constant = [](const Genome&) { return 1.0; };
  population = next_generation(settings, score(population, constant), accept_all, state, 6);
  REQUIRE(state.species.size() == 1);
  REQUIRE(state.species[0].last_improved == 0);
  const NeatState stagnant = state;
  const auto scored = score(population, constant);
  population = next_generation(settings, scored, accept_all, state, 6);
  CHECK(state.species.front().key == 2);
  for (const Individual& individual : population) CHECK(individual.parents.empty());

  settings.reset_on_extinction = false;
  state = stagnant;
  CHECK_THROWS_AS(next_generation(settings, scored, accept_all, state, 6), Error);
  settings.species_elitism = 1;
  state = stagnant;
  CHECK(next_generation(settings, scored, accept_all, state, 6).size() == 12);
}

TEST_CASE("elites stay unchanged") {
  NeatSettings settings;
  settings.elitism = 1;
  settings.compatibility_threshold = 100.0;
  NeatState state;
  const auto population = first_generation(settings, accept_all, state, 8);
  const auto scored = score(population, some_fitness);
  const auto best =
      std::max_element(scored.begin(), scored.end(),
                       [](const Scored& a, const Scored& b) { return a.fitness < b.fitness; });
  const auto next = next_generation(settings, scored, accept_all, state, 8);
  CHECK(next.front().genome == best->genome);
}

TEST_CASE("failed genomes count as the worst and are no parents of many") {
  NeatSettings settings;
  settings.compatibility_threshold = 100.0;
  NeatState state;
  const auto population = first_generation(settings, accept_all, state, 8);
  auto scored = score(population, some_fitness);
  for (std::size_t i = 0; i < 30; ++i) scored[i].fitness = failure;
  const auto next = next_generation(settings, scored, accept_all, state, 8);
  std::set<int> sound;
  for (std::size_t i = 30; i < 50; ++i) sound.insert(scored[i].genome.key);
  for (const Individual& individual : next)
    for (const int parent : individual.parents) CHECK(sound.contains(parent));
  CHECK(std::isfinite(state.species[0].fitness_history[0]));
}

TEST_CASE("scored genomes that do not fit the state are refused") {
  NeatSettings settings;
  NeatState state;
  const auto population = first_generation(settings, accept_all, state, 8);
  auto scored = score(population, some_fitness);
  scored.push_back(scored.front());
  CHECK_THROWS_WITH(next_generation(settings, scored, accept_all, state, 8),
                    Catch::Contains("twice"));
  scored.back().genome.key = 999;
  CHECK_THROWS_WITH(next_generation(settings, scored, accept_all, state, 8),
                    Catch::Contains("genome 999 belongs to no species"));
}

// ---- exclusive or, the classic test of NEAT ---------------------------------------

namespace {

// neat-python's settings for the problem.
NeatSettings xor_settings() {
  NeatSettings settings;
  settings.pop_size = 150;
  settings.num_inputs = 2;
  settings.num_hidden = 0;
  settings.num_outputs = 1;
  settings.initial_connection = {true, 1.0};
  settings.compatibility_weight_coefficient = 0.5;
  settings.conn_add_prob = settings.conn_delete_prob = 0.5;
  settings.species_fitness_func = Statistic::max;
  settings.max_stagnation = 20;
  settings.species_elitism = 2;
  settings.elitism = 2;
  return settings;
}

constexpr std::array<std::array<float, 3>, 4> xor_table{
    {{0, 0, 0}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}}};

// The connections that carry something from an input. With the bare biases of a CPPN,
// one number as output would score 3 of 4 and hold the search there; neat-python's own
// networks do not have them.
Genome without_bare_nodes(Genome genome) {
  const auto is_fed = [&](int key) {
    return key < 0 || std::any_of(genome.connections.begin(), genome.connections.end(),
                                  [&](const ConnectionGene& gene) { return gene.out == key; });
  };
  std::erase_if(genome.connections, [](const ConnectionGene& gene) { return !gene.enabled; });
  for (bool changed = true; changed;) {
    std::vector<ConnectionGene> fed;
    for (const ConnectionGene& gene : genome.connections)
      if (is_fed(gene.in)) fed.push_back(gene);
    changed = fed.size() < genome.connections.size();
    genome.connections = std::move(fed);
  }
  return genome;
}

// Outputs for the four rows; 0 when nothing reaches the output.
std::array<double, 4> xor_outputs(const Genome& genome) {
  const Genome fed = without_bare_nodes(genome);
  const CppnNetwork network(fed, 2, 1);
  const bool reached = std::any_of(fed.connections.begin(), fed.connections.end(),
                                   [](const ConnectionGene& gene) { return gene.out == 0; });
  std::array<double, 4> outputs{};
  for (std::size_t i = 0; i < 4 && reached; ++i)
    outputs[i] = network.evaluate(std::array{xor_table[i][0], xor_table[i][1]})[0];
  return outputs;
}

double xor_fitness(const Genome& genome) {
  const auto outputs = xor_outputs(genome);
  double fitness = 4.0;
  for (std::size_t i = 0; i < 4; ++i) fitness -= std::pow(outputs[i] - xor_table[i][2], 2);
  return fitness;
}

bool solves_xor(const Genome& genome) {
  const auto outputs = xor_outputs(genome);
  for (std::size_t i = 0; i < 4; ++i)
    if (std::fabs(outputs[i] - xor_table[i][2]) >= 0.5) return false;
  return true;
}

// Generations until a genome has all four outputs on the right side, or the limit.
int generations_to_xor(std::uint64_t seed, int limit) {
  const NeatSettings settings = xor_settings();
  NeatState state;
  auto population = first_generation(settings, accept_all, state, seed);
  while (state.generation < limit) {
    for (const Individual& individual : population)
      if (solves_xor(individual.genome)) return state.generation;
    population = next_generation(settings, score(population, xor_fitness), accept_all, state, seed);
  }
  return limit;
}

// How many of the seeds first, .., last solve it within 150 generations.
int xor_successes(std::uint64_t first, std::uint64_t last) {
  int solved = 0;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const int generations = generations_to_xor(seed, 150);
    REQUIRE(generations > 0);  // no initial network, all linear, can solve it
    solved += generations < 150;
  }
  return solved;
}

}  // namespace

TEST_CASE("exclusive or is solved within 150 generations on nine of ten seeds") {
  CHECK(xor_successes(11, 20) >= 9);
}

// neat-python 0.92 with these settings: 49 of 50 seeds, median 53 generations.
TEST_CASE("exclusive or is solved on nine of ten of many seeds", "[.slow]") {
  CHECK(xor_successes(1, 100) >= 90);
}
