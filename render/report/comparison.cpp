#include "render/report/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/report/parts.h"

namespace evo::report {
namespace {

constexpr double significant = 0.05;

// All settings but the seed, as text.
std::string without_seed(const Run& run) {
  std::string key;
  for (const RunSetting& setting : run.settings)
    if (setting.name != "seed") key += setting.name + "=" + setting.value + "\n";
  return key;
}

// Names the settings that tell a group from the others of the same method.
std::string name_of(const Run& run, const std::vector<Repetitions>& groups) {
  const std::string method = run.method();
  std::string name = method;
  for (const RunSetting& setting : run.settings) {
    const bool differs = std::any_of(groups.begin(), groups.end(), [&](const Repetitions& other) {
      return other.method == method && other.runs[0]->setting(setting.name) != setting.value;
    });
    if (differs && setting.name != "seed")
      name += fmt::format(", {} {}", setting.name, setting.value);
  }
  return name;
}

// "a, b and c"
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
  return text;
}

std::optional<std::size_t> robots_for(const std::vector<std::vector<double>>& curves,
                                      std::size_t robots, double target) {
  constexpr double never = std::numeric_limits<double>::infinity();
  std::vector<double> needed;
  for (const std::vector<double>& curve : curves) {
    const auto end = curve.begin() + static_cast<std::ptrdiff_t>(robots);
    const auto there =
        std::find_if(curve.begin(), end, [&](double best) { return best >= target; });
    needed.push_back(there == end ? never : static_cast<double>(there - curve.begin() + 1));
  }
  std::sort(needed.begin(), needed.end());
  const double middle = needed[(needed.size() - 1) / 2];  // then half of them are there
  if (!std::isfinite(middle)) return std::nullopt;
  return static_cast<std::size_t>(middle);
}

std::string p_of(double p) { return p < 0.001 ? "p < 0.001" : fmt::format("p = {:.2g}", p); }

// Runs of each method with which the test can find a difference at all.
std::size_t enough_runs(std::size_t tests) {
  std::size_t runs = 2;
  while (least_p(runs, runs) * static_cast<double>(tests) >= significant) ++runs;
  return runs;
}

void judge_methods(Comparison& comparison) {
  const MethodResult& leader = comparison.methods.front();
  const std::size_t others = comparison.methods.size() - 1;
  std::vector<std::string> beaten;
  std::vector<std::string> level;
  bool possible = false;  // that the test finds a difference
  for (std::size_t k = 1; k < comparison.methods.size(); ++k) {
    const MethodResult& other = comparison.methods[k];
    (other.p < significant ? beaten : level).push_back(other.group.label);
    possible =
        possible ||
        least_p(leader.best.size(), other.best.size()) * static_cast<double>(others) < significant;
  }
  const std::string& first = leader.group.label;
  std::vector<std::string> all = level;
  all.insert(all.begin(), first);
  if (!beaten.empty())
    comparison.headline =
        fmt::format("{} finds fitter robots than {}{}", first, listed(beaten),
                    level.empty() ? "" : "; it cannot be told apart from " + listed(level));
  else if (possible)
    comparison.headline = listed(all) + " cannot be told apart";
  else
    comparison.headline = fmt::format("Too few runs to tell {} apart", listed(all));

  std::vector<std::string> medians;
  for (const MethodResult& method : comparison.methods)
    medians.push_back(
        fmt::format("{} with {}", number(method.median, comparison.decimals), method.group.label));
  comparison.sentences.push_back(
      fmt::format("After {} the best robot of the median run has a fitness of {}.",
                  count_of(comparison.robots, "robot"), listed(medians)));
  for (std::size_t k = 1; k < comparison.methods.size(); ++k) {
    const MethodResult& other = comparison.methods[k];
    comparison.sentences.push_back(
        fmt::format("A run of {} beats one of {} in {:.0f} % of all pairs; by chance alone a "
                    "difference as large comes up with {} (rank test).",
                    first, other.group.label, 100.0 * other.leader_ahead, p_of(other.p)));
  }
  std::vector<std::string> needs;
  for (const MethodResult& method : comparison.methods)
    needs.push_back(
        method.needed ? fmt::format("{} {}", method.group.label, count_of(*method.needed, "robot"))
                      : fmt::format("{} more than {}", method.group.label, comparison.robots));
  comparison.sentences.push_back(
      fmt::format("To reach a fitness of {}, half of the runs of each took: {}.",
                  number(comparison.target, comparison.decimals), listed(needs)));
  if (!possible)
    comparison.sentences.push_back(fmt::format(
        "Chance alone can order so few runs in any way: compare {} seeds or more of each.",
        enough_runs(others)));
  else if (!level.empty())
    comparison.sentences.push_back("More seeds may show a difference that is there.");
}

}  // namespace

std::vector<Repetitions> repetitions(const std::vector<const Run*>& runs) {
  std::vector<Repetitions> groups;
  std::map<std::string, std::size_t> known;
  for (const Run* run : runs) {
    const auto [group, is_new] = known.emplace(without_seed(*run), groups.size());
    if (is_new) groups.push_back({"", run->method(), {}});
    groups[group->second].runs.push_back(run);
  }
  for (Repetitions& group : groups) group.label = name_of(*group.runs[0], groups);
  return groups;
}

std::vector<std::pair<std::string, std::vector<const Run*>>> by_task(const std::vector<Run>& runs) {
  std::vector<std::pair<std::string, std::vector<const Run*>>> tasks;
  for (const Run& run : runs) {
    const std::string task = run.subject();
    auto known = std::find_if(tasks.begin(), tasks.end(),
                              [&](const auto& group) { return group.first == task; });
    if (known == tasks.end()) known = tasks.insert(tasks.end(), {task, {}});
    known->second.push_back(&run);
  }
  return tasks;
}

Comparison compare(const std::vector<const Run*>& runs) {
  Comparison comparison;
  comparison.robots = std::numeric_limits<std::size_t>::max();
  for (const Run* run : runs) comparison.robots = std::min(comparison.robots, run->robots.size());
  if (comparison.robots == 0) return comparison;

  std::vector<std::pair<MethodResult, std::vector<std::vector<double>>>> results;
  for (Repetitions& group : repetitions(runs)) {
    MethodResult result;
    std::vector<std::vector<double>> curves;
    for (const Run* run : group.runs) {
      std::vector<double> curve = best_so_far(run->robots);
      if (std::isnan(curve[comparison.robots - 1])) continue;
      result.best.push_back(curve[comparison.robots - 1]);
      curves.push_back(std::move(curve));
    }
    if (result.best.empty()) continue;
    result.group = std::move(group);
    result.median = median(result.best);
    result.interval = median_interval(result.best);
    results.emplace_back(std::move(result), std::move(curves));
  }
  if (results.empty()) return comparison;
  std::stable_sort(results.begin(), results.end(),
                   [](const auto& a, const auto& b) { return a.first.median > b.first.median; });

  const std::vector<double>& leader = results.front().first.best;
  comparison.target = results.back().first.median;
  comparison.decimals = decimals_of(results.front().first.median);
  std::vector<double> p;
  for (auto& [result, curves] : results) {
    result.leader_ahead = superiority(leader, result.best);
    result.needed = robots_for(curves, comparison.robots, comparison.target);
    p.push_back(rank_test(leader, result.best));
  }
  p.erase(p.begin());  // the leader against itself
  p = corrected(p);
  for (std::size_t k = 0; k < results.size(); ++k) {
    if (k > 0) results[k].first.p = p[k - 1];
    comparison.methods.push_back(std::move(results[k].first));
  }

  if (comparison.methods.size() > 1) {
    judge_methods(comparison);
  } else {
    const MethodResult& only = comparison.methods.front();
    comparison.headline = fmt::format("{} of {}: {}", count_of(only.best.size(), "run"),
                                      only.group.label, number(only.median, comparison.decimals));
    comparison.sentences.push_back(
        fmt::format("That is the fitness of the best robot of the median run after {}; there is no "
                    "other method to compare with.",
                    count_of(comparison.robots, "robot")));
  }
  return comparison;
}

}  // namespace evo::report
