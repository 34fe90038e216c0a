#include "libevo/control/gait_training.h"

#include <algorithm>
#include <utility>

#include "libevo/control/wave_search.h"

namespace evo {
namespace {

GaitSearchSettings search_settings(const TrainingJob& job) {
  const TrainingSettings& s = job.settings;
  const std::int64_t generations = s.steps / generation_cost(job);
  GaitSearchSettings settings;
  settings.population = s.population;
  settings.wave_generations = std::max<std::int64_t>(
      1, static_cast<std::int64_t>(s.wave_share * static_cast<double>(generations)));
  settings.actuator_sigma = s.actuator_sigma;
  settings.shortest_period = s.shortest_period;
  settings.longest_period = s.longest_period;
  return settings;
}

GaitSearch make_search(const TrainingJob& job) {
  const Stream random(job.seed, "train/search", job.robot_id);
  if (auto gait = inherited_gait(job))
    return {job.arena.robot(), search_settings(job), random, std::move(*gait)};
  return {job.arena.robot(), search_settings(job), random};
}

}  // namespace

GaitTraining::GaitTraining(const TrainingJob& job) : search_(make_search(job)) {
  require_a_generation(job);
}

bool GaitTraining::done(const TrainingJob& job, const Findings& findings) const {
  return spent(job, findings);
}

GaitTraining::Generation GaitTraining::advance(const TrainingJob& job, Findings& findings,
                                               Metrics& metrics) {
  const std::vector<SineController> gaits = search_.ask();
  const std::vector<double> returns = try_out(job, gaits, findings, metrics);
  search_.tell(returns);
  metrics.push_back({"charts/sigma", search_.sigma()});
  report_evaluation(findings, metrics);
  const auto best = std::max_element(returns.begin(), returns.end());
  return {*best, gaits[static_cast<std::size_t>(best - returns.begin())]};
}

}  // namespace evo
