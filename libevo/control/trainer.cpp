#include "libevo/control/trainer.h"

#include <utility>
#include <variant>

#include "libevo/base/alternatives.h"
#include "libevo/base/error.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/methods.h"

namespace evo {

namespace {

// ---- the findings in checkpoints -----------------------------------------------------

// One for every TrainedController, or this does not compile: save it, say whether
// it is in a checkpoint, load it.
template <typename Controller>
struct Best;

template <>
struct Best<Policy> {
  static void save(Checkpoint& checkpoint, const Policy& policy) {
    save_policy(checkpoint, "best/policy", policy);
    if (!policy.base) return;
    if (const auto* gait = std::get_if<SineController>(&*policy.base))
      save_sine(checkpoint, "best/gait", *gait);
    if (const auto* sequence = std::get_if<ReplayController>(&*policy.base))
      checkpoint.put("best/base/sequence", sequence->actions);
  }
  static bool in(const Checkpoint& checkpoint) {
    return !checkpoint.part("best/policy").arrays.empty();
  }
  static Policy load(const Checkpoint& checkpoint, const TrainingJob& job) {
    std::optional<OpenLoop> base;
    if (checkpoint.has("best/gait/period")) base = load_sine(checkpoint, "best/gait");
    if (checkpoint.has("best/base/sequence"))
      base =
          ReplayController{checkpoint.get<double>("best/base/sequence"), job.arena.action_length()};
    Policy policy = initial_policy(job, std::move(base));  // of its shape
    load_policy(checkpoint, "best/policy", policy);
    return policy;
  }
};

template <>
struct Best<ModularPolicy> {
  static void save(Checkpoint& checkpoint, const ModularPolicy& policy) {
    save_policy(checkpoint, "best/modular", policy);
  }
  static bool in(const Checkpoint& checkpoint) {
    return !checkpoint.part("best/modular").arrays.empty();
  }
  static ModularPolicy load(const Checkpoint& checkpoint, const TrainingJob& job) {
    ModularPolicy policy = initial_modular_policy(job);  // of its shape
    load_policy(checkpoint, "best/modular", policy);
    return policy;
  }
};

template <>
struct Best<SineController> {
  static void save(Checkpoint& checkpoint, const SineController& sine) {
    save_sine(checkpoint, "best/sine", sine);
  }
  static bool in(const Checkpoint& checkpoint) { return checkpoint.has("best/sine/period"); }
  static SineController load(const Checkpoint& checkpoint, const TrainingJob&) {
    return load_sine(checkpoint, "best/sine");
  }
};

template <>
struct Best<ReplayController> {
  static void save(Checkpoint& checkpoint, const ReplayController& sequence) {
    checkpoint.put("best/sequence", sequence.actions);
  }
  static bool in(const Checkpoint& checkpoint) { return checkpoint.has("best/sequence"); }
  static ReplayController load(const Checkpoint& checkpoint, const TrainingJob& job) {
    return {checkpoint.get<double>("best/sequence"), job.arena.action_length()};
  }
};

TrainedController load_best(const Checkpoint& checkpoint, const TrainingJob& job) {
  std::optional<TrainedController> best;
  for_each_alternative<TrainedController>([&]<typename T>(std::type_identity<T>) {
    if (!best && Best<T>::in(checkpoint)) best = Best<T>::load(checkpoint, job);
  });
  if (!best) throw error(Failure::data, "checkpoint: its best controller is missing");
  return std::move(*best);
}

void save(Checkpoint& checkpoint, const Findings& findings) {
  std::vector<std::uint64_t> steps;
  std::vector<double> evaluations;
  std::vector<double> best;
  for (const CurvePoint& point : findings.curve) {
    steps.push_back(static_cast<std::uint64_t>(point.step));
    evaluations.push_back(point.evaluation);
    best.push_back(point.best);
  }
  checkpoint.put("curve/step", std::move(steps));
  checkpoint.put("curve/evaluation", std::move(evaluations));
  checkpoint.put("curve/best", std::move(best));
  checkpoint.put<std::uint64_t>("steps", {static_cast<std::uint64_t>(findings.steps)});
  if (!findings.best) return;
  checkpoint.put<std::uint64_t>("best/step", {static_cast<std::uint64_t>(findings.best_step)});
  checkpoint.put<double>("best/fitness", {*findings.fitness});
  if (!findings.best_each.empty()) checkpoint.put("best/each", findings.best_each);
  std::visit([&]<typename T>(const T& controller) { Best<T>::save(checkpoint, controller); },
             *findings.best);
}

Findings load(const Checkpoint& checkpoint, const TrainingJob& job) {
  Findings findings;
  const auto& steps = checkpoint.get<std::uint64_t>("curve/step");
  const auto& evaluations = checkpoint.get<double>("curve/evaluation", steps.size());
  const auto& best = checkpoint.get<double>("curve/best", steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i)
    findings.curve.push_back({static_cast<std::int64_t>(steps[i]), evaluations[i], best[i]});
  findings.steps = static_cast<std::int64_t>(checkpoint.get<std::uint64_t>("steps", 1)[0]);
  if (steps.empty()) return findings;
  findings.best_step = static_cast<std::int64_t>(checkpoint.get<std::uint64_t>("best/step", 1)[0]);
  findings.fitness = checkpoint.get<double>("best/fitness", 1)[0];
  if (checkpoint.has("best/each"))
    findings.best_each = checkpoint.get<double>("best/each", 1 + job.others.size());
  findings.best = load_best(checkpoint, job);
  return findings;
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

// Work that failed becomes a TrainingFailure; any other error is thrown on.
TrainingFailure failure_of(const Error& failure, const TrainingJob& job, const Findings& findings) {
  if (failure.kind() != Failure::work) throw failure;
  return {failure.what(), findings.steps, job.seed};
}

}  // namespace

// ---- the trainer ----------------------------------------------------------------------

struct Trainer::Impl {
  TrainingJob job;
  Findings findings;
  Method method;

  static Method begin(const TrainingJob& job) {
    check(job.settings);
    const std::string& name = job.settings.algorithm.name();
    const bool modular = name == ModularTraining::name;
    if (job.inheritance && !modular &&
        std::holds_alternative<ModularPolicy>(job.inheritance->controller))
      throw error(Failure::usage, "training: {} cannot start from a modular policy; --algo {} can",
                  name, ModularTraining::name);
    if (!job.others.empty() && !modular)
      throw error(Failure::usage,
                  "training: {} makes a controller for each robot; --algo {} makes one for all",
                  name, ModularTraining::name);
    if (!job.demonstrations.empty() && name != PpoTraining::name)
      throw error(Failure::usage,
                  "training: episodes of {} begin at recorded moments, those of {} not",
                  PpoTraining::name, name);
    return make_method(job);
  }

  explicit Impl(TrainingJob j) : job(std::move(j)), method(begin(job)) {}
};

Trainer::Trainer(const Arena& arena, const TrainingSettings& settings, std::uint64_t seed,
                 std::string_view robot_id, std::optional<Inheritance> inheritance,
                 std::vector<const Arena*> others, std::vector<Demonstration> demonstrations)
    : impl_(std::make_unique<Impl>(TrainingJob{arena, settings, seed, std::string(robot_id),
                                               std::move(inheritance), std::move(others),
                                               std::move(demonstrations)})) {}

Trainer::~Trainer() = default;
Trainer::Trainer(Trainer&&) noexcept = default;
Trainer& Trainer::operator=(Trainer&&) noexcept = default;

bool Trainer::done() const {
  if (impl_->findings.failure) return true;
  return std::visit([&](const auto& m) { return m.done(impl_->job, impl_->findings); },
                    impl_->method);
}

TrainingReport Trainer::advance() {
  Impl& it = *impl_;
  TrainingReport report;
  try {
    std::visit([&](auto& m) { m.advance(it.job, it.findings, report.metrics); }, it.method);
  } catch (const Error& failure) {
    it.findings.failure = failure_of(failure, it.job, it.findings);
  }
  report.step = it.findings.steps;
  report.steps = it.job.settings.steps;
  return report;
}

TrainResult Trainer::result() const {
  const TrainingJob& job = impl_->job;
  const Findings& findings = impl_->findings;
  TrainResult result;
  result.complete = done();
  result.steps = findings.steps;
  result.curve = findings.curve;
  result.failure = findings.failure;
  if (result.failure || !findings.best) return result;
  if (result.complete && job.settings.final_episodes > 0) {
    try {
      result.final_score = score(job, to_controller(*findings.best));
    } catch (const Error& failure) {
      result.failure = failure_of(failure, job, findings);
      return result;
    }
  }
  result.fitness = findings.fitness;
  result.controller = findings.best;
  result.best_step = findings.best_step;
  result.each = findings.best_each;
  return result;
}

Checkpoint Trainer::checkpoint() const {
  Checkpoint checkpoint;
  save(checkpoint, impl_->findings);
  std::visit([&](const auto& m) { m.save(checkpoint); }, impl_->method);
  return checkpoint;
}

void Trainer::restore(const Checkpoint& checkpoint) {
  impl_->findings = load(checkpoint, impl_->job);
  std::visit([&](auto& m) { m.load(checkpoint); }, impl_->method);
}

TrainResult train(Trainer& trainer, const TrainingHook& go_on) {
  while (!trainer.done()) {
    const TrainingReport report = trainer.advance();
    if (go_on && !go_on(trainer, report)) break;
  }
  return trainer.result();
}

}  // namespace evo
