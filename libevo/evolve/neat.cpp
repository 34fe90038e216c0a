#include "libevo/evolve/neat.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "libevo/base/error.h"

namespace evo {
namespace {

double statistic(Statistic kind, std::vector<double> values) {
  switch (kind) {
    case Statistic::mean:
      return std::accumulate(values.begin(), values.end(), 0.0) /
             static_cast<double>(values.size());
    case Statistic::min:
      return *std::min_element(values.begin(), values.end());
    case Statistic::max:
      return *std::max_element(values.begin(), values.end());
    case Statistic::median:
      std::sort(values.begin(), values.end());
      return values[values.size() / 2];
  }
  return 0.0;
}

// ---- a scored generation by genome key ------------------------------------------

// A genome with its fitness, neither owned; the fitness is finite.
struct Member {
  const Genome* genome;
  double fitness;
};

using Members = std::map<int, Member>;

Members by_key(std::span<const Scored> scored, const NeatState& state) {
  std::set<int> known;
  for (const Species& species : state.species)
    known.insert(species.members.begin(), species.members.end());
  double worst = std::numeric_limits<double>::infinity();
  for (const Scored& s : scored)
    if (std::isfinite(s.fitness)) worst = std::min(worst, s.fitness);
  if (!std::isfinite(worst)) worst = 0.0;  // all failed

  Members members;
  for (const Scored& s : scored) {
    const int key = s.genome.key;
    if (!known.contains(key))
      throw error(Failure::data, "genome {} belongs to no species of generation {} of the state",
                  key, state.generation);
    if (!members.emplace(key, Member{&s.genome, std::isfinite(s.fitness) ? s.fitness : worst})
             .second)
      throw error(Failure::data, "genome {} is there twice", key);
  }
  return members;
}

// ---- stagnation -------------------------------------------------------------------

// A species with its members of the scored generation, best first.
struct Brood {
  Species species;
  std::vector<Member> members;
  double fitness = 0.0;
};

std::vector<double> fitness_of(const std::vector<Member>& members) {
  std::vector<double> fitness;
  fitness.reserve(members.size());
  for (const Member& member : members) fitness.push_back(member.fitness);
  return fitness;
}

// The species with members left, their history brought up to date, in
// ascending order of fitness.
std::vector<Brood> gather(const NeatSettings& settings, const Members& members, NeatState& state) {
  std::vector<Brood> broods;
  for (Species& species : state.species) {
    Brood brood{std::move(species), {}, 0.0};
    for (const int key : brood.species.members)
      if (const auto found = members.find(key); found != members.end())
        brood.members.push_back(found->second);
    if (brood.members.empty()) continue;

    std::vector<double>& history = brood.species.fitness_history;
    brood.fitness = statistic(settings.species_fitness_func, fitness_of(brood.members));
    if (history.empty() || brood.fitness > *std::max_element(history.begin(), history.end()))
      brood.species.last_improved = state.generation;
    history.push_back(brood.fitness);
    std::stable_sort(brood.members.begin(), brood.members.end(),
                     [](const Member& a, const Member& b) { return a.fitness > b.fitness; });
    broods.push_back(std::move(brood));
  }
  std::stable_sort(broods.begin(), broods.end(),
                   [](const Brood& a, const Brood& b) { return a.fitness < b.fitness; });
  return broods;
}

// Less fit species go first; the `species_elitism` best ones never do.
void remove_stagnant(const NeatSettings& settings, int generation, std::vector<Brood>& broods) {
  const std::size_t spared =
      std::min(broods.size(), static_cast<std::size_t>(settings.species_elitism));
  const auto stagnant = [&](const Brood& brood) {
    return generation - brood.species.last_improved >= settings.max_stagnation;
  };
  const auto end = broods.end() - static_cast<std::ptrdiff_t>(spared);
  broods.erase(std::remove_if(broods.begin(), end, stagnant), end);
}

// ---- offspring --------------------------------------------------------------------

// Brand-new genomes with the next keys of the run.
std::vector<Individual> fresh_genomes(const NeatSettings& settings, int count, NeatState& state,
                                      std::uint64_t seed) {
  state.next_node_key = std::max(state.next_node_key, settings.num_outputs);
  std::vector<Individual> fresh;
  for (int k = 0; k < count; ++k) {
    const int key = state.next_genome_key++;
    Stream stream(seed, "neat/fresh", static_cast<std::uint64_t>(key));
    fresh.push_back({fresh_genome(settings, key, state.next_node_key, stream), {}});
  }
  return fresh;
}

// Crossover by fitness (the second parent's genes when equal), then mutation.
Individual child_of(const Member& a, const Member& b, const NeatSettings& settings,
                    NeatState& state, int key, Stream& stream) {
  const bool a_is_fitter = a.fitness > b.fitness;  // on equal fitness the second one counts
  const Genome& fitter = a_is_fitter ? *a.genome : *b.genome;
  const Genome& other = a_is_fitter ? *b.genome : *a.genome;
  Individual child{crossover(fitter, other, key, stream), {a.genome->key, b.genome->key}};
  if (a.genome->key == b.genome->key) child.parents.pop_back();
  mutate(child.genome, settings, state.next_node_key, stream);
  return child;
}

// How many of a species' members may be parents: its best `survival_threshold`, at
// least two while there are two.
std::size_t parents_among(const NeatSettings& settings, std::size_t members) {
  const double share = std::ceil(settings.survival_threshold * static_cast<double>(members));
  return std::min(members, std::max<std::size_t>(2, static_cast<std::size_t>(share)));
}

// The species means of fitness scaled by the range of all values, which is taken to
// be at least 1 (neat-python's choice): 0 for the worst there is.
std::vector<double> adjusted_fitness(std::span<const std::vector<double>> species) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const std::vector<double>& fitness : species) {
    low = std::min(low, *std::min_element(fitness.begin(), fitness.end()));
    high = std::max(high, *std::max_element(fitness.begin(), fitness.end()));
  }
  std::vector<double> adjusted;
  adjusted.reserve(species.size());
  for (const std::vector<double>& fitness : species)
    adjusted.push_back((statistic(Statistic::mean, fitness) - low) / std::max(1.0, high - low));
  return adjusted;
}

void breed(const Brood& brood, int count, const NeatSettings& settings, NeatState& state,
           std::uint64_t seed, std::vector<Individual>& population) {
  const std::size_t size = brood.members.size();
  const std::size_t elites = std::min(size, static_cast<std::size_t>(settings.elitism));
  for (std::size_t i = 0; i < elites; ++i)
    population.push_back({*brood.members[i].genome, {brood.members[i].genome->key}});

  const std::size_t parents = parents_among(settings, size);
  for (int k = static_cast<int>(elites); k < count; ++k) {
    const int key = state.next_genome_key++;
    Stream stream(seed, "neat/child", static_cast<std::uint64_t>(key));
    const auto n = static_cast<std::uint32_t>(parents);
    const Member& first = brood.members[stream.below(n)];
    const Member& second = brood.members[stream.below(n)];
    population.push_back(child_of(first, second, settings, state, key, stream));
  }
}

// Children of the species that are not stagnant; the others leave the state.
// Empty when every species is stagnant.
std::vector<Individual> reproduce(const NeatSettings& settings, std::span<const Scored> scored,
                                  NeatState& state, std::uint64_t seed) {
  const Members members = by_key(scored, state);
  std::vector<Brood> broods = gather(settings, members, state);
  remove_stagnant(settings, state.generation, broods);
  state.species.clear();
  if (broods.empty()) return {};

  std::vector<int> sizes;
  std::vector<std::vector<double>> fitness;
  for (const Brood& brood : broods) {
    sizes.push_back(static_cast<int>(brood.members.size()));
    fitness.push_back(fitness_of(brood.members));
  }
  const std::vector<int> counts =
      offspring_counts(adjusted_fitness(fitness), sizes, settings.pop_size,
                       std::max(settings.min_species_size, settings.elitism));
  std::vector<Individual> population;
  for (std::size_t i = 0; i < broods.size(); ++i)
    breed(broods[i], counts[i], settings, state, seed, population);
  for (Brood& brood : broods) state.species.push_back(std::move(brood.species));
  return population;
}

// ---- acceptance -------------------------------------------------------------------

void drop_unacceptable(const Accept& accept, std::vector<Individual>& population) {
  std::vector<Individual> kept;  // one call each, in order: a promise erase_if does not make
  for (Individual& individual : population)
    if (accept(individual.genome)) kept.push_back(std::move(individual));
  population = std::move(kept);
}

// Drops what is not accepted and fills up with random genomes, each time exactly
// as many as are missing.
void make_acceptable(const NeatSettings& settings, const Accept& accept, NeatState& state,
                     std::uint64_t seed, std::vector<Individual>& population) {
  const auto wanted = static_cast<std::size_t>(settings.pop_size);
  drop_unacceptable(accept, population);
  int vain = 0;
  while (population.size() < wanted) {
    const std::size_t missing = wanted - population.size();
    std::vector<Individual> fresh = fresh_genomes(settings, static_cast<int>(missing), state, seed);
    drop_unacceptable(accept, fresh);
    vain = fresh.empty() ? vain + static_cast<int>(missing) : 0;
    if (vain >= max_vain_tries)
      throw error(Failure::work,
                  "{} random genomes in a row gave no new valid robot; {} of {} found: the "
                  "shape may have no more",
                  vain, population.size(), wanted);
    std::move(fresh.begin(), fresh.end(), std::back_inserter(population));
  }
}

void check(const NeatSettings& settings) {
  if (const auto found = defect(settings)) throw Error(Failure::usage, *found);
}

}  // namespace

std::vector<int> offspring_counts(std::span<const double> adjusted_fitness,
                                  std::span<const int> previous_sizes, int pop_size,
                                  int min_species_size) {
  const double sum = std::accumulate(adjusted_fitness.begin(), adjusted_fitness.end(), 0.0);
  std::vector<int> counts;
  for (std::size_t i = 0; i < adjusted_fitness.size(); ++i) {
    double share = min_species_size;
    if (sum > 0.0) share = std::max(share, adjusted_fitness[i] / sum * pop_size);
    const double way = 0.5 * (share - previous_sizes[i]);
    int move = static_cast<int>(std::nearbyint(way));
    if (move == 0 && way != 0.0) move = way > 0.0 ? 1 : -1;
    counts.push_back(previous_sizes[i] + move);
  }
  const double scale =
      pop_size / static_cast<double>(std::accumulate(counts.begin(), counts.end(), 0));
  for (int& count : counts)
    count = std::max(min_species_size, static_cast<int>(std::nearbyint(count * scale)));
  return counts;
}

void speciate(const NeatSettings& settings, std::span<const Individual> population,
              NeatState& state) {
  const std::size_t n = population.size();
  std::vector<bool> placed(n, false);
  std::vector<std::size_t> representatives;  // of each species, in the order of the state
  state.species.resize(std::min(state.species.size(), n));
  for (Species& species : state.species) {
    std::size_t closest = n;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      if (placed[i]) continue;
      const double d = distance(species.representative, population[i].genome, settings);
      if (closest == n || d < least) {
        closest = i;
        least = d;
      }
    }
    placed[closest] = true;
    representatives.push_back(closest);
    species.members = {population[closest].genome.key};
  }

  for (std::size_t i = 0; i < n; ++i) {
    if (placed[i]) continue;
    const Genome& genome = population[i].genome;
    std::size_t home = state.species.size();
    double least = settings.compatibility_threshold;
    for (std::size_t s = 0; s < state.species.size(); ++s) {
      const double d = distance(population[representatives[s]].genome, genome, settings);
      if (d < least) {
        home = s;
        least = d;
      }
    }
    if (home == state.species.size()) {
      Species founded;
      founded.key = state.next_species_key++;
      founded.created = founded.last_improved = state.generation;
      state.species.push_back(std::move(founded));
      representatives.push_back(i);
    }
    state.species[home].members.push_back(genome.key);
  }
  for (std::size_t s = 0; s < state.species.size(); ++s)
    state.species[s].representative = population[representatives[s]].genome;
}

std::vector<Individual> first_generation(const NeatSettings& settings, const Accept& accept,
                                         NeatState& state, std::uint64_t seed) {
  check(settings);
  state = NeatState{};
  std::vector<Individual> population = fresh_genomes(settings, settings.pop_size, state, seed);
  speciate(settings, population, state);  // before the test as well, as neat-python does
  make_acceptable(settings, accept, state, seed, population);
  speciate(settings, population, state);
  return population;
}

std::vector<Individual> next_generation(const NeatSettings& settings,
                                        std::span<const Scored> scored, const Accept& accept,
                                        NeatState& state, std::uint64_t seed) {
  check(settings);
  std::vector<Individual> population = reproduce(settings, scored, state, seed);
  if (population.empty()) {
    if (!settings.reset_on_extinction)
      throw error(Failure::work, "every species is stagnant in generation {}", state.generation);
    population = fresh_genomes(settings, settings.pop_size, state, seed);
  }
  speciate(settings, population, state);
  ++state.generation;
  make_acceptable(settings, accept, state, seed, population);
  speciate(settings, population, state);
  return population;
}

}  // namespace evo
