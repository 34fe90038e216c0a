// The fitness of the best robot of a run, as it grows.
#pragma once

#include <limits>
#include <vector>

namespace evo {

// After each of `robots` (each with its `fitness`, or nothing: it failed); NaN while all have
// failed.
template <typename Robots>
std::vector<double> best_so_far(const Robots& robots) {
  std::vector<double> curve;
  double best = std::numeric_limits<double>::quiet_NaN();
  for (const auto& robot : robots) {
    if (robot.fitness && !(*robot.fitness <= best)) best = *robot.fitness;
    curve.push_back(best);
  }
  return curve;
}

}  // namespace evo
