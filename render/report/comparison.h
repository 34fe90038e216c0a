// Which method finds the fitter robots, and how sure that is.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/report/run.h"
#include "render/report/statistics.h"

namespace evo::report {

// Runs that are repetitions of each other: they differ in nothing but their seed.
struct Repetitions {
  std::string label;  // the method, and settings that tell it from others of that method
  std::string method;
  std::vector<const Run*> runs;
};
std::vector<Repetitions> repetitions(const std::vector<const Run*>& runs);

// One method, over its runs. Runs count as far as the shortest of all goes.
struct MethodResult {
  Repetitions group;
  std::vector<double> best;  // fitness, a run each; only of runs in which a robot has one
  double median = 0.0;
  Interval interval;  // of the median, 95 %
  // Against the method with the highest median; of itself 0.5 and 1.
  double leader_ahead = 0.5;  // how often one of its runs is better than one of these
  double p = 1.0;             // of the rank test, corrected for the number of methods
  // Robots until half of its runs had Comparison::target; nothing: fewer have it.
  std::optional<std::size_t> needed;
};

struct Comparison {
  std::size_t robots = 0;             // of each run that count
  double target = 0.0;                // the lowest of the medians
  int decimals = 2;                   // of every fitness
  std::vector<MethodResult> methods;  // the highest median first; those with a fitness
  std::string headline;
  std::vector<std::string> sentences;
};

// `runs` are on one task.
Comparison compare(const std::vector<const Run*>& runs);

// Runs by what their robots are scored by, in the order in which it comes first.
std::vector<std::pair<std::string, std::vector<const Run*>>> by_task(const std::vector<Run>& runs);

// Task by task a line per method, the best first, with the numbers of Comparison:
// task, method, runs, robots, median, low, high, leader_ahead, p, needed. In LaTeX, a table of
// booktabs, and as text to be read numbers are rounded.
enum class TableFormat { tsv, csv, latex, text };
std::string comparison_table(const std::vector<Run>& runs, TableFormat format);

}  // namespace evo::report
