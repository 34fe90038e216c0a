// Who survives: the survivor schedule of the genetic algorithm, and the best of scored
// individuals. Everything works on plain scores and answers with indices, so that bodies,
// genomes and archives are served alike.
//
// A score that is not a number stands for a failed training or evaluation:
// it ranks after every number, failed ones among themselves in input order.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace evo {

using Indices = std::vector<std::size_t>;

// Survivors of a population of `population` after `created` of at most
// `max_evaluations` robots have been created, those of the current generation
// included: max(2, ceil(population * x)), x = 0.6 (M - e - 1) / (M - 1) (docs/methods.md,
// "Survivors"). Evaluated in integers, so no rounding decides it. May
// exceed the population (below 2). Throws Error(usage) for counts below 1, an
// M below 2, or more robots created than M.
int paper_survivors(int population, int created, int max_evaluations);

// A generation of a run under this schedule, which is known before the run begins.
struct PlannedGeneration {
  int robots = 0;     // survivors and children
  int created = 0;    // in the run so far
  int survivors = 0;  // into the next generation; none of the last one
  int children = 0;   // that join them
};

// All of them, until `max_evaluations` robots are created. Throws Error(usage) where there
// are more robots than evaluations, or no room for children beside the survivors.
std::vector<PlannedGeneration> paper_plan(int population, int max_evaluations);

// How many of the best robots scored are parents of a robot that is proposed without
// generations, from the scores of `known` robots: the paper's share,
// of the population or, while there are fewer scores, of those. `known` >= 1.
int steady_parents(int population, int known, int max_evaluations);

// All indices, best (highest) score first; equal scores keep their order.
Indices rank(std::span<const double> scores);

// The `keep` best, best first; all of them if there are fewer.
Indices select_truncation(std::span<const double> scores, std::size_t keep);

}  // namespace evo
