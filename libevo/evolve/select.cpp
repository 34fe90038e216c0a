#include "libevo/evolve/select.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "libevo/base/error.h"

namespace evo {
namespace {

Indices all_indices(std::size_t n) {
  Indices indices(n);
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  return indices;
}

bool failed(const std::vector<double>& row) {
  return std::any_of(row.begin(), row.end(), [](double v) { return std::isnan(v); });
}

// a is nowhere worse than b and somewhere better.
bool dominates(const Objectives& objectives, std::size_t a, std::size_t b) {
  bool better = false;
  for (std::size_t k = 0; k < objectives.signs.size(); ++k) {
    const double va = objectives.signs[k] * objectives.rows[a][k];
    const double vb = objectives.signs[k] * objectives.rows[b][k];
    if (va < vb) return false;
    better = better || va > vb;
  }
  return better;
}

void check_rows(const Objectives& objectives) {
  for (std::size_t i = 0; i < objectives.rows.size(); ++i)
    if (objectives.rows[i].size() != objectives.signs.size())
      throw error(Failure::data, "individual {} has {} objectives, {} expected", i + 1,
                  objectives.rows[i].size(), objectives.signs.size());
}

}  // namespace

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

int known_scores(int robot, int window, int population) {
  return robot < population ? 0 : std::max(0, robot - window);
}

int steady_parents(int population, int known, int max_evaluations) {
  return paper_survivors(std::min(population, known), known, max_evaluations);
}

Indices rank(std::span<const double> scores) {
  Indices order = all_indices(scores.size());
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

Indices select_tournament(std::span<const double> scores, std::size_t keep, int size,
                          Stream& stream) {
  if (size < 1) throw error(Failure::usage, "tournament of {} robots: at least 1 needed", size);
  // Ranks instead of scores: the lowest rank wins, and no tie is left to break.
  const Indices order = rank(scores);
  Indices left = all_indices(order.size());
  Indices winners;
  while (winners.size() < keep && !left.empty()) {
    const auto entrants = static_cast<std::uint32_t>(left.size());
    std::size_t winner = stream.below(entrants);  // `left` stays sorted: lowest position wins
    for (int k = 1; k < size; ++k) winner = std::min<std::size_t>(winner, stream.below(entrants));
    winners.push_back(left[winner]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(winner));
  }
  std::sort(winners.begin(), winners.end());
  for (std::size_t& winner : winners) winner = order[winner];
  return winners;
}

std::vector<Indices> pareto_fronts(const Objectives& objectives) {
  check_rows(objectives);
  const std::size_t n = objectives.rows.size();
  Indices failures;
  Indices sound;
  for (std::size_t i = 0; i < n; ++i) (failed(objectives.rows[i]) ? failures : sound).push_back(i);

  std::vector<Indices> beaten(n);             // whom i dominates
  std::vector<std::size_t> dominators(n, 0);  // how many not yet sorted dominate i
  for (const std::size_t a : sound)
    for (const std::size_t b : sound)
      if (dominates(objectives, a, b)) {
        beaten[a].push_back(b);
        ++dominators[b];
      }

  std::vector<Indices> fronts;
  Indices front;
  for (const std::size_t i : sound)
    if (dominators[i] == 0) front.push_back(i);
  while (!front.empty()) {
    Indices next;
    for (const std::size_t a : front)
      for (const std::size_t b : beaten[a])
        if (--dominators[b] == 0) next.push_back(b);
    std::sort(next.begin(), next.end());
    fronts.push_back(std::move(front));
    front = std::move(next);
  }
  if (!failures.empty()) fronts.push_back(std::move(failures));
  return fronts;
}

std::vector<double> crowding_distances(const Objectives& objectives, const Indices& front) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> distance(front.size(), 0.0);
  if (front.empty() || failed(objectives.rows[front.front()])) return distance;
  for (std::size_t k = 0; k < objectives.signs.size(); ++k) {
    const auto value = [&](std::size_t member) { return objectives.rows[front[member]][k]; };
    Indices order = all_indices(front.size());
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return value(a) < value(b); });
    const double range = value(order.back()) - value(order.front());
    distance[order.front()] = distance[order.back()] = infinity;
    if (!(range > 0.0) || std::isinf(range)) continue;
    for (std::size_t i = 1; i + 1 < order.size(); ++i)
      distance[order[i]] += (value(order[i + 1]) - value(order[i - 1])) / range;
  }
  return distance;
}

Indices select_pareto(const Objectives& objectives, std::size_t keep) {
  Indices chosen;
  for (const Indices& front : pareto_fronts(objectives)) {
    if (chosen.size() >= keep) break;
    const std::vector<double> crowding = crowding_distances(objectives, front);
    for (const std::size_t member : rank(crowding)) chosen.push_back(front[member]);
  }
  chosen.resize(std::min(keep, chosen.size()));
  return chosen;
}

}  // namespace evo
