#include "libevo/evolve/neat_steady.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "libevo/base/error.h"

namespace evo {
namespace {

// The members of a species, best first, the older one on ties.
std::vector<Member> members_of(const Species& species, std::span<const Scored> population) {
  std::vector<Member> members;
  for (const Scored& s : population)
    if (std::find(species.members.begin(), species.members.end(), s.genome.key) !=
        species.members.end())
      members.push_back({&s.genome, s.fitness});
  std::stable_sort(members.begin(), members.end(),
                   [](const Member& a, const Member& b) { return a.fitness > b.fitness; });
  return members;
}

Species& home_of(const NeatSettings& settings, const Genome& genome, NeatState& state) {
  Species* home = nullptr;
  double least = settings.compatibility_threshold;
  for (Species& species : state.species) {
    const double d = distance(species.representative, genome, settings);
    if (d < least) {
      home = &species;
      least = d;
    }
  }
  if (home != nullptr) return *home;
  Species founded;
  founded.key = state.next_species_key++;
  founded.created = founded.last_improved = state.generation;
  founded.representative = genome;
  return state.species.emplace_back(std::move(founded));
}

// Members that are not in the population count as gone, as do species without any.
void remove_absent(std::span<const Scored> population, NeatState& state) {
  for (Species& species : state.species)
    std::erase_if(species.members, [&](int key) {
      return std::none_of(population.begin(), population.end(),
                          [&](const Scored& s) { return s.genome.key == key; });
    });
  std::erase_if(state.species, [](const Species& species) { return species.members.empty(); });
}

// The worst member of the species that exceeds its share most goes.
void remove_one(const NeatSettings& settings, std::vector<Scored>& population, NeatState& state) {
  const std::vector<double> shares = species_shares(settings, population, state);
  std::size_t largest = 0;
  double surplus = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double over = static_cast<double>(state.species[i].members.size()) - shares[i];
    if (over > surplus) {
      largest = i;
      surplus = over;
    }
  }
  Species& species = state.species[largest];
  const int worst = members_of(species, population).back().genome->key;
  std::erase(species.members, worst);
  std::erase_if(population, [&](const Scored& s) { return s.genome.key == worst; });
  if (species.members.empty())
    state.species.erase(state.species.begin() + static_cast<std::ptrdiff_t>(largest));
}

double best_of(const Species& species) {
  return species.fitness_history.empty() ? -std::numeric_limits<double>::infinity()
                                         : species.fitness_history.back();
}

// Whether each species has gone too long without a better member. The
// `species_elitism` species with the best members are never stagnant.
std::vector<bool> stagnant_species(const NeatSettings& settings, const NeatState& state) {
  const double patience =
      static_cast<double>(settings.max_stagnation) * static_cast<double>(settings.pop_size);
  std::vector<bool> stagnant;
  for (const Species& species : state.species)
    stagnant.push_back(state.generation - species.last_improved >= patience);
  std::vector<std::size_t> order(state.species.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return best_of(state.species[a]) > best_of(state.species[b]);
  });
  const auto spared = std::min(order.size(), static_cast<std::size_t>(settings.species_elitism));
  for (std::size_t i = 0; i < spared; ++i) stagnant[order[i]] = false;
  return stagnant;
}

// A child of two members of a species drawn by its share; nothing without parents.
std::optional<Individual> child(const NeatSettings& settings, std::span<const Scored> population,
                                NeatState& state, int key, std::uint64_t seed) {
  const std::vector<double> shares = species_shares(settings, population, state);
  if (std::accumulate(shares.begin(), shares.end(), 0.0) <= 0.0) return std::nullopt;
  Stream stream(seed, "neat/child", static_cast<std::uint64_t>(key));
  const Species& species = state.species[stream.discrete(shares)];
  const std::vector<Member> members = members_of(species, population);
  const auto n = static_cast<std::uint32_t>(parents_among(settings, members.size()));
  const Member& first = members[stream.below(n)];
  const Member& second = members[stream.below(n)];
  return child_of(first, second, settings, state, key, stream);
}

}  // namespace

std::vector<double> species_shares(const NeatSettings& settings, std::span<const Scored> population,
                                   const NeatState& state) {
  const std::vector<bool> stagnant = stagnant_species(settings, state);
  std::vector<std::size_t> living;
  std::vector<std::vector<double>> fitness;
  for (std::size_t i = 0; i < state.species.size(); ++i) {
    const std::vector<Member> members = members_of(state.species[i], population);
    if (stagnant[i] || members.empty()) continue;
    living.push_back(i);
    fitness.emplace_back();
    for (const Member& member : members) fitness.back().push_back(member.fitness);
  }
  const std::vector<double> adjusted = adjusted_fitness(fitness);
  const double sum = std::accumulate(adjusted.begin(), adjusted.end(), 0.0);
  std::vector<double> shares(state.species.size(), 0.0);
  for (std::size_t i = 0; i < living.size(); ++i) {
    const double fair = sum > 0.0 ? adjusted[i] / sum * settings.pop_size : 0.0;
    shares[living[i]] = std::max<double>(settings.min_species_size, fair);
  }
  return shares;
}

void join(const NeatSettings& settings, const Scored& scored, std::vector<Scored>& population,
          NeatState& state) {
  for (const Scored& s : population)
    if (s.genome.key == scored.genome.key)
      throw error(Failure::data, "genome {} is there twice", scored.genome.key);
  ++state.generation;
  remove_absent(population, state);
  if (!std::isfinite(scored.fitness)) return;
  Species& species = home_of(settings, scored.genome, state);
  species.members.push_back(scored.genome.key);
  if (species.fitness_history.empty() || scored.fitness > species.fitness_history.back()) {
    species.fitness_history = {scored.fitness};
    species.last_improved = state.generation;
  }
  population.push_back(scored);
  if (population.size() > static_cast<std::size_t>(settings.pop_size))
    remove_one(settings, population, state);
}

Individual next_individual(const NeatSettings& settings, std::span<const Scored> population,
                           const Accept& accept, NeatState& state, int key, std::uint64_t seed) {
  if (const auto found = defect(settings)) throw Error(Failure::usage, *found);
  state.next_node_key = std::max(state.next_node_key, settings.num_outputs);
  state.next_genome_key = std::max(state.next_genome_key, key + 1);
  if (auto bred = child(settings, population, state, key, seed); bred && accept(bred->genome))
    return std::move(*bred);
  Stream stream(seed, "neat/fresh", static_cast<std::uint64_t>(key));
  for (int tries = 0; tries < max_vain_tries; ++tries) {
    Genome fresh = fresh_genome(settings, key, state.next_node_key, stream);
    if (accept(fresh)) return {std::move(fresh), {}};
  }
  throw error(Failure::work,
              "{} random genomes in a row gave no new valid robot: the shape may have no more",
              max_vain_tries);
}

}  // namespace evo
