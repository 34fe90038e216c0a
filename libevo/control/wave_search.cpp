#include "libevo/control/wave_search.h"

#include <algorithm>
#include <numbers>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double amplitude_scale = 0.3;  // share of the rest length
constexpr double phase_scale = 2.0;      // radian
constexpr double period_scale = 0.7;     // of the period's logarithm

std::size_t actuators_of(const TrainingJob& job) {
  return static_cast<std::size_t>(job.arena.action_length());
}

Stream stream_of(const TrainingJob& job) { return {job.seed, "train/search", job.robot_id}; }

}  // namespace

std::int64_t generation_cost(const TrainingJob& job) {
  return std::int64_t{job.settings.population} * job.settings.evaluation_episodes *
         job.arena.task().episode_steps;
}

void require_a_generation(const TrainingJob& job) {
  if (generation_cost(job) > job.settings.steps)
    throw error(Failure::usage,
                "training: {} steps are less than one generation of {} episodes of {} steps",
                job.settings.steps,
                std::int64_t{job.settings.population} * job.settings.evaluation_episodes,
                job.arena.task().episode_steps);
}

bool spent(const TrainingJob& job, const Findings& findings) {
  return findings.steps + generation_cost(job) > job.settings.steps;
}

std::vector<double> try_out(const TrainingJob& job, const std::vector<SineController>& candidates,
                            Findings& findings, Metrics& metrics) {
  const OpenLoopEvaluation result = evaluate_each(job.arena, candidates, job.evaluation());
  findings.steps += result.steps;
  const auto best = std::max_element(result.means.begin(), result.means.end());
  findings.evaluated(*best, candidates[static_cast<std::size_t>(best - result.means.begin())]);
  double sum = 0.0;
  for (const double mean : result.means) sum += mean;
  metrics.push_back({"charts/episodic_return", sum / static_cast<double>(result.means.size())});
  return result.means;
}

namespace {

// ---- the points of the evolution strategy ------------------------------------------

// A point is [amplitudes, phases, period], scaled so that a step of 1 matters
// about the same in each; phases start anywhere.
std::vector<double> initial_mean(std::size_t actuators, Stream& random) {
  std::vector<double> mean(2 * actuators + 1, 0.0);
  for (std::size_t i = 0; i < actuators; ++i)
    mean[actuators + i] = two_pi * random.uniform() / phase_scale;
  return mean;
}

}  // namespace

SineTraining::SineTraining(const TrainingJob& job)
    : actuators_(actuators_of(job)),
      random_(stream_of(job)),
      strategy_(initial_mean(actuators_, random_), job.settings.initial_sigma,
                job.settings.population) {
  require_a_generation(job);
}

bool SineTraining::done(const TrainingJob& job, const Findings& findings) const {
  return spent(job, findings);
}

void SineTraining::advance(const TrainingJob& job, Findings& findings, Metrics& metrics) {
  const std::vector<std::vector<double>> points = strategy_.ask(random_);
  std::vector<SineController> candidates;
  for (const auto& x : points) candidates.push_back(decode(x, job.settings));
  strategy_.tell(points, try_out(job, candidates, findings, metrics));
  metrics.push_back({"charts/sigma", strategy_.sigma()});
  report_evaluation(findings, metrics);
}

void SineTraining::save(Checkpoint& checkpoint) const {
  checkpoint.put("search/random", random_);
  strategy_.save(checkpoint, "search/strategy");
}

void SineTraining::load(const Checkpoint& checkpoint) {
  checkpoint.get("search/random", random_);
  strategy_.load(checkpoint, "search/strategy");
}

SineController SineTraining::decode(const std::vector<double>& x, const TrainingSettings& s) const {
  SineController sine;
  for (std::size_t i = 0; i < actuators_; ++i) {
    sine.amplitude.push_back(0.3 + amplitude_scale * x[i]);
    sine.phase.push_back(phase_scale * x[actuators_ + i]);
  }
  const double middle = math::sqrt(s.shortest_period * s.longest_period);
  sine.period = std::clamp(middle * math::exp(period_scale * x[2 * actuators_]), s.shortest_period,
                           s.longest_period);
  return sine;
}

// ---- random search --------------------------------------------------------------------

RandomTraining::RandomTraining(const TrainingJob& job)
    : actuators_(actuators_of(job)), random_(stream_of(job)) {
  require_a_generation(job);
  // The stream goes on where the strategy's does: published results count on it.
  initial_mean(actuators_, random_);
}

bool RandomTraining::done(const TrainingJob& job, const Findings& findings) const {
  return spent(job, findings);
}

void RandomTraining::advance(const TrainingJob& job, Findings& findings, Metrics& metrics) {
  std::vector<SineController> candidates;
  for (int i = 0; i < job.settings.population; ++i) candidates.push_back(draw(job.settings));
  try_out(job, candidates, findings, metrics);
  report_evaluation(findings, metrics);
}

void RandomTraining::save(Checkpoint& checkpoint) const {
  checkpoint.put("search/random", random_);
}

void RandomTraining::load(const Checkpoint& checkpoint) {
  checkpoint.get("search/random", random_);
}

SineController RandomTraining::draw(const TrainingSettings& s) {
  SineController sine;
  for (std::size_t i = 0; i < actuators_; ++i) sine.amplitude.push_back(0.5 * random_.uniform());
  for (std::size_t i = 0; i < actuators_; ++i) sine.phase.push_back(two_pi * random_.uniform());
  const double ratio = math::log(s.longest_period / s.shortest_period);
  sine.period = s.shortest_period * math::exp(ratio * random_.uniform());
  return sine;
}

}  // namespace evo
