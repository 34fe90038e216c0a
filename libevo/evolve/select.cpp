#include "libevo/evolve/select.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "libevo/base/error.h"

namespace evo {

int paper_survivors(int population, int created, int max_evaluations) {
  if (population < 1)
    throw error(Failure::usage, "population size {}: at least 1 needed", population);
  if (max_evaluations < 2)
    throw error(Failure::usage, "maximum of {} evaluations: the schedule needs at least 2",
                max_evaluations);
  if (created < 1 || created > max_evaluations)
    throw error(Failure::usage, "{} robots evaluated: from 1 to the maximum of {} allowed", created,
                max_evaluations);
  // 0.6 = 3/5; once e reaches M the rate is below zero and the floor of 2 holds.
  const std::int64_t left = std::max(max_evaluations - created - 1, 0);
  const std::int64_t numerator = 3 * std::int64_t{population} * left;
  const std::int64_t denominator = 5 * (std::int64_t{max_evaluations} - 1);
  const std::int64_t ceiling = (numerator + denominator - 1) / denominator;
  return static_cast<int>(std::max<std::int64_t>(2, ceiling));
}

std::vector<PlannedGeneration> paper_plan(int population, int max_evaluations) {
  if (population > max_evaluations)
    throw error(Failure::usage, "--pop {} is larger than --evals {}", population, max_evaluations);
  std::vector<PlannedGeneration> plan;
  int robots = population;
  for (int created = population;;) {
    PlannedGeneration next{robots, created, 0, 0};
    if (created == max_evaluations) {
      plan.push_back(next);
      return plan;
    }
    next.survivors = paper_survivors(population, created, max_evaluations);
    next.children = std::min(population - next.survivors, max_evaluations - created);
    if (next.children <= 0)
      throw error(Failure::usage,
                  "--pop {} leaves no room for children beside {} survivors; at least 3 is needed",
                  population, next.survivors);
    plan.push_back(next);
    created += next.children;
    robots = next.survivors + next.children;
  }
}

int steady_parents(int population, int known, int max_evaluations) {
  return paper_survivors(std::min(population, known), known, max_evaluations);
}

Indices rank(std::span<const double> scores) {
  Indices order(scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (std::isnan(scores[a]) || std::isnan(scores[b]))
      return !std::isnan(scores[a]) && std::isnan(scores[b]);
    return scores[a] > scores[b];
  });
  return order;
}

Indices select_truncation(std::span<const double> scores, std::size_t keep) {
  Indices order = rank(scores);
  order.resize(std::min(keep, order.size()));
  return order;
}

}  // namespace evo
