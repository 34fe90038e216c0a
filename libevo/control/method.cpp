#include "libevo/control/method.h"

#include <limits>
#include <optional>
#include <utility>

#include "libevo/base/error.h"
#include "libevo/control/ppo.h"
#include "libevo/control/transfer.h"

namespace evo {

EvaluationSettings evaluation_of(const TrainingSettings& settings, std::uint64_t seed) {
  EvaluationSettings evaluation;
  evaluation.episodes = settings.evaluation_episodes;
  evaluation.seed = seed;
  evaluation.jitter = settings.evaluation_jitter;
  return evaluation;
}

EvaluationSettings TrainingJob::evaluation() const { return evaluation_of(settings, seed); }

std::vector<const Arena*> TrainingJob::arenas() const {
  std::vector<const Arena*> all{&arena};
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

Evaluation evaluate_all(const TrainingJob& job, const Controller& controller,
                        const EvaluationSettings& settings, std::vector<double>* each) {
  if (job.others.empty()) return evaluate(job.arena, controller, settings);
  Evaluation all;
  std::optional<Error> failure;
  for (const Arena* arena : job.arenas()) {
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

Metrics update_metrics(const UpdateReport& update, std::span<const double> returns) {
  Metrics metrics{{"charts/learning_rate", update.learning_rate},
                  {"losses/policy_loss", update.losses.policy},
                  {"losses/value_loss", update.losses.value},
                  {"losses/entropy", update.losses.entropy},
                  {"losses/approx_kl", update.losses.approx_kl},
                  {"losses/clipfrac", update.losses.clipfrac},
                  {"losses/explained_variance", update.explained_variance}};
  if (returns.empty()) return metrics;
  double sum = 0.0;
  for (const double r : returns) sum += r;
  metrics.push_back({"charts/episodic_return", sum / static_cast<double>(returns.size())});
  return metrics;
}

void Findings::evaluated(double value, const TrainedController& controller,
                         std::span<const double> each) {
  if (!fitness || value > *fitness) {
    fitness = value;
    best = controller;
    best_step = steps;
    best_each.assign(each.begin(), each.end());
  }
  curve.push_back({steps, value, *fitness});
}

Policy initial_policy(const TrainingJob& job, std::optional<OpenLoop> base) {
  const Physics& physics = job.arena.task().physics;
  return initial_policy(job.settings, job.arena.observation_length(), job.arena.action_length(),
                        physics.min_target, physics.max_target, std::move(base),
                        Stream(job.seed, "train/initial", job.robot_id));
}

std::optional<SineController> inherited_gait(const TrainingJob& job) {
  if (!job.inheritance) return std::nullopt;
  const Inheritance& old = *job.inheritance;
  const SineController* gait = std::get_if<SineController>(&old.controller);
  if (const auto* policy = std::get_if<Policy>(&old.controller); policy && policy->base)
    gait = std::get_if<SineController>(&*policy->base);
  if (gait == nullptr) return std::nullopt;
  return transferred(*gait, old.anatomy, anatomy(job.arena.robot(), job.arena.layout()));
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
  return transferred(*sequence, old.anatomy, anatomy(job.arena.robot(), job.arena.layout()));
}

void evaluate(const TrainingJob& job, const TrainedController& controller, Findings& findings) {
  std::vector<double> each;
  const double value = evaluate_all(job, to_controller(controller), job.evaluation(), &each).mean();
  findings.evaluated(value, controller, each);
}

void report_evaluation(const Findings& findings, Metrics& metrics) {
  metrics.push_back({"eval/return", findings.curve.back().evaluation});
  metrics.push_back({"eval/best", findings.curve.back().best});
}

}  // namespace evo
