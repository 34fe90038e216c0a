#include "libevo/control/method.h"

#include <limits>
#include <optional>
#include <utility>

#include "libevo/base/error.h"
#include "libevo/control/transfer.h"

namespace evo {

EvaluationSettings evaluation_of(const TrainingSettings& settings, std::uint64_t seed) {
  EvaluationSettings evaluation;
  evaluation.episodes = settings.evaluation_episodes;
  evaluation.seed = seed;
  evaluation.jitter = settings.evaluation_jitter;
  return evaluation;
}

Evaluation evaluate_all(const TrainingJob& job, const Controller& controller,
                        const EvaluationSettings& settings, std::vector<double>* each) {
  if (job.robots.size() == 1) return evaluate(job.arena(), controller, settings);
  Evaluation all;
  std::optional<Error> failure;
  for (const Arena* arena : job.robots) {
    try {
      const Evaluation one = evaluate(*arena, controller, settings);
      if (each != nullptr) each->push_back(one.mean());
      all.returns.insert(all.returns.end(), one.returns.begin(), one.returns.end());
      all.lengths.insert(all.lengths.end(), one.lengths.begin(), one.lengths.end());
      all.peaks.insert(all.peaks.end(), one.peaks.begin(), one.peaks.end());
    } catch (const Error& e) {
      if (e.kind() != Failure::work) throw;
      if (each != nullptr) each->push_back(std::numeric_limits<double>::quiet_NaN());
      failure = e;
    }
  }
  if (all.returns.empty()) throw failure.value();
  return all;
}

double mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

void TrainResult::evaluated(double value, const TrainedController& of,
                            std::span<const double> of_each) {
  if (!fitness || value > *fitness) {
    fitness = value;
    controller = of;
    best_step = steps;
    each.assign(of_each.begin(), of_each.end());
  }
  curve.push_back({steps, value, *fitness});
}

std::optional<SineController> inherited_gait(const TrainingJob& job) {
  if (!job.inheritance) return std::nullopt;
  const Inheritance& old = *job.inheritance;
  const SineController* gait = std::get_if<SineController>(&old.controller);
  if (const auto* policy = std::get_if<Policy>(&old.controller); policy && policy->base)
    gait = std::get_if<SineController>(&*policy->base);
  if (gait == nullptr) return std::nullopt;
  return transferred(*gait, old.anatomy, anatomy(job.arena()));
}

std::optional<OpenLoop> inherited_base(const TrainingJob& job) {
  if (auto gait = inherited_gait(job)) return *std::move(gait);
  if (!job.inheritance) return std::nullopt;
  const Inheritance& old = *job.inheritance;
  const ReplayController* sequence = nullptr;
  if (job.settings.keep_sequence) sequence = std::get_if<ReplayController>(&old.controller);
  if (const auto* policy = std::get_if<Policy>(&old.controller); policy && policy->base)
    sequence = std::get_if<ReplayController>(&*policy->base);
  if (sequence == nullptr) return std::nullopt;
  return transferred(*sequence, old.anatomy, anatomy(job.arena()));
}

void evaluate(const TrainingJob& job, const TrainedController& controller, TrainResult& result) {
  std::vector<double> each;
  const double value = evaluate_all(job, controller, job.evaluation(), &each).mean();
  result.evaluated(value, controller, each);
}

void report_evaluation(const TrainResult& result, Metrics& metrics) {
  metrics.push_back({"eval/return", result.curve.back().evaluation});
  metrics.push_back({"eval/best", result.curve.back().best});
}

}  // namespace evo
