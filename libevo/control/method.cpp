#include "libevo/control/method.h"

namespace evo {

EvaluationSettings TrainingJob::evaluation() const {
  EvaluationSettings evaluation;
  evaluation.episodes = settings.evaluation_episodes;
  evaluation.seed = seed;
  return evaluation;
}

void Findings::evaluated(double value, const TrainedController& controller) {
  if (!fitness || value > *fitness) {
    fitness = value;
    best = controller;
    best_step = steps;
  }
  curve.push_back({steps, value, *fitness});
}

void report_evaluation(const Findings& findings, Metrics& metrics) {
  metrics.push_back({"eval/return", findings.curve.back().evaluation});
  metrics.push_back({"eval/best", findings.curve.back().best});
}

}  // namespace evo
