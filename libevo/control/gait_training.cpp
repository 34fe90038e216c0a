#include "libevo/control/gait_training.h"

#include <algorithm>
#include <utility>

#include "libevo/base/error.h"

namespace evo {
namespace {

GaitSearchSettings search_settings(const TrainingJob& job) {
  const TrainingSettings& s = job.settings;
  const std::int64_t generations = s.steps / generation_cost(job);
  GaitSearchSettings settings;
  settings.population = s.population;
  settings.wave_generations = std::max<std::int64_t>(
      1, static_cast<std::int64_t>(s.wave_share * static_cast<double>(generations)));
  settings.shortest_period = s.shortest_period;
  settings.longest_period = s.longest_period;
  return settings;
}

GaitSearch make_search(const TrainingJob& job) {
  const Stream random(job.seed, "train/search", job.robot_id);
  if (auto gait = inherited_gait(job))
    return {job.arena().robot(), search_settings(job), random, std::move(*gait)};
  return {job.arena().robot(), search_settings(job), random};
}

// The mean return of each candidate; the best of them is an evaluation.
std::vector<double> try_out(const TrainingJob& job, const std::vector<SineController>& candidates,
                            TrainResult& result, Metrics& metrics) {
  const OpenLoopEvaluation tried = evaluate_each(job.arena(), candidates, job.evaluation());
  result.steps += tried.steps;
  const auto best = std::max_element(tried.means.begin(), tried.means.end());
  result.evaluated(*best, candidates[static_cast<std::size_t>(best - tried.means.begin())]);
  metrics.push_back({"charts/episodic_return", mean(tried.means)});
  return tried.means;
}

}  // namespace

std::int64_t generation_cost(const TrainingJob& job) {
  return std::int64_t{job.settings.population} * job.settings.evaluation_episodes *
         job.arena().task().episode_steps;
}

GaitTraining::GaitTraining(const TrainingJob& job) : search_(make_search(job)) {
  if (generation_cost(job) > job.settings.steps)
    throw error(Failure::usage,
                "training: {} steps are less than one generation of {} episodes of {} steps",
                job.settings.steps,
                std::int64_t{job.settings.population} * job.settings.evaluation_episodes,
                job.arena().task().episode_steps);
}

bool GaitTraining::done(const TrainingJob& job, const TrainResult& result) const {
  return result.steps + generation_cost(job) > job.settings.steps;
}

GaitTraining::Generation GaitTraining::advance(const TrainingJob& job, TrainResult& result,
                                               Metrics& metrics) {
  const std::vector<SineController> gaits = search_.ask();
  const std::vector<double> returns = try_out(job, gaits, result, metrics);
  search_.tell(returns);
  metrics.push_back({"charts/sigma", search_.sigma()});
  report_evaluation(result, metrics);
  const auto best = std::max_element(returns.begin(), returns.end());
  return {*best, gaits[static_cast<std::size_t>(best - returns.begin())]};
}

}  // namespace evo
