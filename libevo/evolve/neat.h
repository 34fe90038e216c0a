// NEAT, generation by generation: species, their stagnation and offspring, and
// the loop of the benchmark's example, in which genomes that are not acceptable
// are replaced by brand-new ones (docs/methods.md, "Settings" and "Loop").
//
// Between generations everything is in plain data (NeatState), so that a step is
// a function of (settings, state, scored genomes, what is acceptable, seed).
// Random numbers come from Stream(seed, "neat/fresh" or "neat/child", genome key);
// genome keys never repeat within a run.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "libevo/evolve/neat_operators.h"

namespace evo {

struct Species {
  int key = 0;
  int created = 0;        // generation
  int last_improved = 0;  // generation of its best species fitness
  Genome representative;
  std::vector<int> members;             // genome keys of the current generation
  std::vector<double> fitness_history;  // species fitness of its generations so far
  bool operator==(const Species&) const = default;
};

// What the next generation needs to know besides the scored genomes.
struct NeatState {
  int generation = 0;  // of the population that `members` refer to
  int next_genome_key = 1;
  int next_node_key = 0;
  int next_species_key = 1;
  std::vector<Species> species;
  bool operator==(const NeatState&) const = default;
};

// A member of a new generation; the keys of its parents: none if it is brand new.
struct Individual {
  Genome genome;
  std::vector<int> parents;
};

struct Scored {
  Genome genome;
  double fitness = 0.0;  // not finite: failed, counted as the worst of the others
};

// Decides whether a genome may be in the population. Called once for every
// candidate, in order, so it may remember what it let pass.
using Accept = std::function<bool(const Genome&)>;

// Random genomes tried in a row without one that is accepted, before giving up.
inline constexpr int max_vain_tries = 20'000;

// The first generation: random genomes until `settings.pop_size` are accepted.
// Throws Error(work) when max_vain_tries in a row are not.
std::vector<Individual> first_generation(const NeatSettings& settings, const Accept& accept,
                                         NeatState& state, std::uint64_t seed);

// The next generation of about `settings.pop_size` from the scored one: children
// that are accepted, filled up with random genomes. Members of a species that
// are not among the scored count as gone. Throws Error(data) for a scored genome
// of no species or met twice, Error(work) on extinction without reset.
std::vector<Individual> next_generation(const NeatSettings& settings,
                                        std::span<const Scored> scored, const Accept& accept,
                                        NeatState& state, std::uint64_t seed);

// ---- the steps of a generation --------------------------------------------------

// Every old species keeps the genome closest to its representative as the new
// one; the others join the closest representative below the threshold or found
// a species. Should there be fewer genomes than species, the last species end.
void speciate(const NeatSettings& settings, std::span<const Individual> population,
              NeatState& state);

// Offspring of each species from its adjusted fitness: half way from the
// previous size to its share of `pop_size`, rescaled to `pop_size`, never below
// `min_species_size`. The sum may differ from `pop_size`.
std::vector<int> offspring_counts(std::span<const double> adjusted_fitness,
                                  std::span<const int> previous_sizes, int pop_size,
                                  int min_species_size);

}  // namespace evo
