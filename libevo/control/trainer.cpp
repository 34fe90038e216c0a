#include "libevo/control/trainer.h"

#include <utility>
#include <variant>

#include "libevo/base/error.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/methods.h"

namespace evo {

namespace {

// ---- the findings in checkpoints -----------------------------------------------------

void serialize(const Archive& archive, std::size_t robots, TrainResult& result) {
  std::vector<std::uint64_t> steps;
  std::vector<double> evaluations;
  std::vector<double> best;
  for (const CurvePoint& point : result.curve) {
    steps.push_back(static_cast<std::uint64_t>(point.step));
    evaluations.push_back(point.evaluation);
    best.push_back(point.best);
  }
  archive.array("curve/step", steps);
  evaluations.resize(steps.size());
  best.resize(steps.size());
  archive.row<double>("curve/evaluation", evaluations);
  archive.row<double>("curve/best", best);
  result.curve.clear();
  for (std::size_t i = 0; i < steps.size(); ++i)
    result.curve.push_back({static_cast<std::int64_t>(steps[i]), evaluations[i], best[i]});
  archive.numbers<std::uint64_t>("steps", result.steps);
  archive.best(result.controller);
  if (archive.loads() ? steps.empty() : !result.controller) return;
  if (!result.controller) throw error(Failure::data, "checkpoint: its best controller is missing");
  if (!result.fitness) result.fitness = 0.0;
  archive.numbers<double>("best/fitness", *result.fitness);
  archive.numbers<std::uint64_t>("best/step", result.best_step);
  result.each.resize(robots > 1 ? robots : 0);
  archive.row<double>("best/each", result.each);
  if (archive.optional("final", result.final_score.has_value())) {
    FinalScore final = result.final_score.value_or(FinalScore{});
    archive.numbers<double>("final", final.episodes, final.mean, final.standard_error);
    result.final_score = final;
  }
}

// ---- the end ----------------------------------------------------------------------------

FinalScore score(const TrainingJob& job, const Controller& controller) {
  EvaluationSettings final;
  final.episodes = job.settings.final_episodes;
  final.seed = derive_seed(job.seed, "final");
  final.jitter = job.settings.final_jitter;
  const Evaluation scores = evaluate_all(job, controller, final);
  return {final.episodes, scores.mean(), scores.standard_error()};
}

}  // namespace

// ---- the trainer ----------------------------------------------------------------------

struct Trainer::Impl {
  TrainingJob job;
  TrainResult result;
  Method method;

  static Method begin(const TrainingJob& job) {
    check(job.settings);
    const std::string name = word(job.settings.algorithm);
    const Abilities can = abilities(job.settings.algorithm);
    if (job.inheritance && !can.shares &&
        std::holds_alternative<ModularPolicy>(job.inheritance->controller))
      throw error(Failure::usage, "training: {} cannot start from a modular policy; {} can", name,
                  algorithm_that(&Abilities::shares));
    if (job.robots.size() > 1 && !can.shares)
      throw error(Failure::usage,
                  "training: {} makes a controller for each robot; {} makes one for all", name,
                  algorithm_that(&Abilities::shares));
    return make_method(job);
  }

  explicit Impl(TrainingJob j) : job(std::move(j)), method(begin(job)) {}

  bool trained() const {
    return std::visit([&](const auto& m) { return m.done(job, result); }, method);
  }
};

Trainer::Trainer(std::vector<const Arena*> robots, const TrainingSettings& settings,
                 std::uint64_t seed, std::string_view name, std::optional<Inheritance> inheritance)
    : impl_(std::make_unique<Impl>(TrainingJob{std::move(robots), settings, seed, std::string(name),
                                               std::move(inheritance)})) {}

Trainer::~Trainer() = default;

bool Trainer::done() const {
  const Impl& it = *impl_;
  if (it.result.failure) return true;
  return it.trained() && (it.result.final_score || it.job.settings.final_episodes == 0);
}

TrainingReport Trainer::advance() {
  Impl& it = *impl_;
  TrainingReport report;
  try {
    if (it.trained())
      it.result.final_score = score(it.job, it.result.controller.value());
    else
      std::visit([&](auto& m) { m.advance(it.job, it.result, report.metrics); }, it.method);
  } catch (const Error& failure) {
    if (failure.kind() != Failure::work) throw;
    it.result.failure = TrainingFailure{failure.what(), it.result.steps, it.job.seed};
    it.result.fitness.reset();
    it.result.controller.reset();
  }
  report.step = it.result.steps;
  report.steps = it.job.settings.steps;
  return report;
}

const TrainResult& Trainer::result() const { return impl_->result; }

Checkpoint Trainer::checkpoint() const {
  Checkpoint checkpoint;
  const Archive archive = Archive::saving(checkpoint);
  serialize(archive, impl_->job.robots.size(), impl_->result);
  std::visit([&](auto& m) { m.serialize(archive); }, impl_->method);
  return checkpoint;
}

void Trainer::restore(const Checkpoint& checkpoint) {
  Impl& it = *impl_;
  const Archive archive = Archive::loading(checkpoint);
  it.result = {};
  serialize(archive, it.job.robots.size(), it.result);
  std::visit([&](auto& m) { m.serialize(archive); }, it.method);
  if (!it.trained()) it.result.final_score.reset();  // of a training with fewer steps
}

TrainResult train(Trainer& trainer, const TrainingHook& go_on) {
  while (!trainer.done()) {
    const TrainingReport report = trainer.advance();
    if (go_on && !go_on(trainer, report)) break;
  }
  return trainer.result();
}

}  // namespace evo
