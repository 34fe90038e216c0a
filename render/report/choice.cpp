#include "render/report/choice.h"

#include <algorithm>
#include <numeric>

namespace evo::report {
namespace {

constexpr std::size_t sheet_columns = 40;     // generations that still fit a screen by scrolling
constexpr std::size_t moving_ancestors = 40;  // whose episodes are a megabyte or two

// The best members of a generation by what they earned in it, as places in it.
std::vector<std::size_t> best_of(const Generation& generation) {
  std::vector<std::size_t> best;
  for (std::size_t place = 0; place < generation.members.size(); ++place)
    if (generation.scores[place]) best.push_back(place);
  std::stable_sort(best.begin(), best.end(), [&](std::size_t a, std::size_t b) {
    return *generation.scores[a] > *generation.scores[b];
  });
  best.resize(std::min(best.size(), sheet_rows));
  return best;
}

std::vector<std::size_t> all_robots(const Run& run) {
  std::vector<std::size_t> order(run.robots.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

}  // namespace

std::vector<std::size_t> ranked(const Run& run) {
  std::vector<std::size_t> order = all_robots(run);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return run.robots[a].fitness > run.robots[b].fitness;  // nothing is less than any number
  });
  return order;
}

std::vector<SheetColumn> sheet(const Run& run) {
  std::vector<const Generation*> begun;
  for (const Generation& generation : run.generations)
    if (!generation.members.empty()) begun.push_back(&generation);
  std::vector<SheetColumn> columns;
  for (const Generation* generation : spread(begun, sheet_columns))
    columns.push_back({generation, best_of(*generation)});
  return columns;
}

std::vector<std::size_t> shown_one_by_one(const Run& run, std::size_t most) {
  const std::vector<std::size_t> all = all_robots(run);
  if (all.size() <= most) return all;
  std::set<std::size_t> chosen;
  const auto add = [&](const std::vector<std::size_t>& robots) {
    chosen.insert(robots.begin(), robots.end());
  };
  std::vector<std::size_t> fittest = ranked(run);
  fittest.resize(most / 2);
  add(fittest);
  add(spread(all, most - most / 2));
  if (run.champion) add(lineage(run.robots, run.by_id, *run.champion));
  std::optional<double> best;
  for (const std::size_t robot : all)
    if (const auto& fitness = run.robots[robot].fitness; fitness && (!best || *fitness > *best)) {
      best = fitness;
      chosen.insert(robot);
    }
  for (const SheetColumn& column : sheet(run))
    for (const std::size_t place : column.best) chosen.insert(column.generation->members[place]);
  return {chosen.begin(), chosen.end()};
}

std::set<std::size_t> looked_at_first(const Run& run, std::size_t most) {
  std::set<std::size_t> chosen;
  if (!run.champion) return chosen;
  const auto line = lineage(run.robots, run.by_id, *run.champion);
  for (const std::size_t robot : spread(line, moving_ancestors)) chosen.insert(robot);
  std::vector<std::size_t> fittest = ranked(run);
  fittest.resize(std::min(fittest.size(), most));
  for (const std::size_t robot : fittest)
    if (run.robots[robot].fitness) chosen.insert(robot);
  return chosen;
}

}  // namespace evo::report
