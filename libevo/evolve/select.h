// Who survives: the survivor schedule of the genetic algorithm and three ways
// of choosing among scored individuals. Everything works on plain scores and
// answers with indices, so that bodies, genomes and archives are served alike.
//
// A score that is not a number stands for a failed training or evaluation:
// it ranks after every number, failed ones among themselves in input order.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libevo/base/random.h"

namespace evo {

using Indices = std::vector<std::size_t>;

// Survivors of a population of `population` after `created` of at most
// `max_evaluations` robots have been created, those of the current generation
// included: max(2, ceil(population * x)), x = 0.6 (M - e - 1) / (M - 1) (docs/methods.md,
// "Survivors"). Evaluated in integers, so no rounding decides it. May
// exceed the population (below 2). Throws Error(usage) for counts below 1, an
// M below 2, or more robots created than M.
int paper_survivors(int population, int created, int max_evaluations);

// Evolution without generations: robot k is proposed from exactly the scores of
// robots 0 .. k - window - 1, the first `population` robots from none. Nobody waits
// for a generation, and the run is the same whatever is trained at a time. Returns
// the number of scores that robot k knows.
int known_scores(int robot, int window, int population);

// How many of the best robots scored are parents of such a robot: the paper's share,
// of the population or, while there are fewer scores, of those. `known` >= 1.
int steady_parents(int population, int known, int max_evaluations);

// All indices, best (highest) score first; equal scores keep their order.
Indices rank(std::span<const double> scores);

// The `keep` best, best first; all of them if there are fewer.
Indices select_truncation(std::span<const double> scores, std::size_t keep);

// `keep` distinct winners of tournaments, best first. Each tournament draws
// `size` entrants with replacement from those not yet chosen; the best ranked
// one wins and leaves. Throws Error(usage) for a size below 1.
Indices select_tournament(std::span<const double> scores, std::size_t keep, int size,
                          Stream& stream);

// ---- several objectives (Deb et al., "A Fast and Elitist Multiobjective Genetic
// ---- Algorithm: NSGA-II", IEEE TEVC 6(2), 2002) ------------------------------

// Objectives of each individual, a row an individual; every one is multiplied
// by its sign and then maximised.
struct Objectives {
  std::vector<double> signs;              // +1 maximise, -1 minimise
  std::vector<std::vector<double>> rows;  // [individuals][signs.size()]
};

// Fronts of non-dominated sorting, the best first, indices ascending within a
// front. Individuals with an objective that is not a number form a last front.
// Throws Error(data) for rows of another length than the signs.
std::vector<Indices> pareto_fronts(const Objectives& objectives);

// Crowding distance of each member of a front, in its order; infinite at the
// ends of every objective.
std::vector<double> crowding_distances(const Objectives& objectives, const Indices& front);

// The `keep` best: by front, then by falling crowding distance, then in input
// order.
Indices select_pareto(const Objectives& objectives, std::size_t keep);

}  // namespace evo
