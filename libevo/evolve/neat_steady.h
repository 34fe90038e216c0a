// NEAT without generations: every scored genome joins a population of at most
// `pop_size` at once, and every new genome has its parents in one species of it
// (the idea of rtNEAT: Stanley, Bryant and Miikkulainen, "Real-time neuroevolution
// in the NERO video game", IEEE TEC 9(6), 2005; the formulas are those of neat.h).
//
// A species' share of the population follows its mean adjusted fitness. It decides
// both how often the species breeds and which one gives up its worst member when
// there are too many. One that has not improved for `max_stagnation` * `pop_size`
// scores has no share and so dies out, unless `species_elitism` protects it.
//
// Everything between two calls is in plain data: the population, oldest first, and a
// NeatState whose `generation` counts the scores that were told, whose species list
// the members of the population by genome key, the founder of each being its
// representative, its best fitness so far its only history.
#pragma once

#include <span>
#include <vector>

#include "libevo/evolve/neat.h"

namespace evo {

// The next score of the run. A fitness that is not finite counts as a score, but
// such a genome does not join. Throws Error(data) for a genome that is a member.
void join(const NeatSettings& settings, const Scored& scored, std::vector<Scored>& population,
          NeatState& state);

// Genome number `key`: a child if there are parents and it is accepted, else the
// first random genome that is. Random numbers come from Stream(seed, "neat/child" or
// "neat/fresh", key). Throws Error(work) when max_vain_tries are not accepted.
Individual next_individual(const NeatSettings& settings, std::span<const Scored> population,
                           const Accept& accept, NeatState& state, int key, std::uint64_t seed);

// The share of each species in a population of `pop_size`, in their order: at least
// `min_species_size` for those that are not stagnant, 0 for those that are or have no member left.
std::vector<double> species_shares(const NeatSettings& settings, std::span<const Scored> population,
                                   const NeatState& state);

}  // namespace evo
