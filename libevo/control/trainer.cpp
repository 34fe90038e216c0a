#include "libevo/control/trainer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/evolution_strategy.h"
#include "libevo/control/ppo.h"

namespace evo {
namespace {

// ---- what every method shares -----------------------------------------------------

struct Job {
  const Arena& arena;
  TrainingSettings settings;
  std::uint64_t seed = 0;
  std::string robot_id;

  // Evaluations meet the same episodes for every robot.
  EvaluationSettings evaluation() const {
    EvaluationSettings evaluation;
    evaluation.episodes = settings.evaluation_episodes;
    evaluation.seed = seed;
    return evaluation;
  }
};

// What came out so far.
struct Record {
  std::int64_t steps = 0;
  std::vector<CurvePoint> curve;
  std::optional<double> fitness;
  std::optional<Controller> best;
  std::int64_t best_step = 0;
  std::optional<TrainingFailure> failure;

  // Keeps the controller if it is strictly better than all before.
  void evaluated(double value, const Controller& controller) {
    if (!fitness || value > *fitness) {
      fitness = value;
      best = controller;
      best_step = steps;
    }
    curve.push_back({steps, value, *fitness});
  }
};

using Metrics = std::vector<Metric>;

void report_evaluation(const Record& record, Metrics& metrics) {
  metrics.push_back({"eval/return", record.curve.back().evaluation});
  metrics.push_back({"eval/best", record.curve.back().best});
}

// ---- proximal policy optimisation --------------------------------------------------

class PpoTraining {
 public:
  explicit PpoTraining(const Job& job)
      : env_(job.arena, job.settings.environments),
        ppo_(job.settings, job.arena.observation_length(), job.arena.action_length(),
             job.arena.task().physics.min_target, job.arena.task().physics.max_target, job.seed,
             job.robot_id),
        next_episode_(static_cast<std::size_t>(job.settings.environments), 0),
        episode_return_(next_episode_.size(), 0.0) {
    for (int e = 0; e < env_.environments(); ++e) start_episode(job, e);
    ppo_.observe(env_.observations());
  }

  bool done(const Job& job, const Record&) const {
    return ppo_.updates() >= job.settings.updates();
  }

  void advance(const Job& job, Record& record, Metrics& metrics) {
    std::vector<double> returns;
    for (int t = 0; t < job.settings.rollout; ++t) {
      step(job, returns);
      record.steps += env_.environments();
      require_finite();
    }
    const UpdateReport update = ppo_.learn();
    require_finite();

    metrics = {{"charts/learning_rate", update.learning_rate},
               {"losses/policy_loss", update.losses.policy},
               {"losses/value_loss", update.losses.value},
               {"losses/entropy", update.losses.entropy},
               {"losses/approx_kl", update.losses.approx_kl},
               {"losses/clipfrac", update.losses.clipfrac},
               {"losses/explained_variance", update.explained_variance}};
    if (!returns.empty()) {
      double sum = 0.0;
      for (const double r : returns) sum += r;
      metrics.push_back({"charts/episodic_return", sum / static_cast<double>(returns.size())});
    }
    if (ppo_.updates() % job.settings.evaluation_interval == 0 || done(job, record)) {
      const Controller controller = ppo_.policy();
      record.evaluated(evaluate(job.arena, controller, job.evaluation()).mean(), controller);
      report_evaluation(record, metrics);
    }
  }

  void save(Checkpoint& checkpoint) const {
    ppo_.save(checkpoint);
    checkpoint.put("environments/state", env_.save());
    checkpoint.put("environments/next_episode", next_episode_);
    checkpoint.put("environments/episode_return", episode_return_);
  }

  void load(const Checkpoint& checkpoint) {
    ppo_.load(checkpoint);
    env_.load(checkpoint.get<std::uint8_t>("environments/state"));
    next_episode_ =
        checkpoint.get<std::uint64_t>("environments/next_episode", next_episode_.size());
    episode_return_ = checkpoint.get<double>("environments/episode_return", episode_return_.size());
  }

  Controller blank() const { return ppo_.policy(); }

 private:
  // Episode k of environment e has the draws of (seed, "train", e, k).
  void start_episode(const Job& job, int environment) {
    const auto e = static_cast<std::size_t>(environment);
    const std::uint64_t stream = derive_seed(job.seed, "train", e);
    EpisodeStart start;
    start.draws = job.arena.draw(stream, next_episode_[e]++);
    env_.reset(environment, start);
    episode_return_[e] = 0.0;
  }

  // One step of every environment; the returns of episodes that ended are added.
  void step(const Job& job, std::vector<double>& returns) {
    const std::span<const double> targets = ppo_.act();
    require_finite();
    env_.step(targets);
    require_stable(env_);
    ppo_.reward(env_.rewards(), env_.terminated(), env_.truncated(), env_.observations());
    for (int e = 0; e < env_.environments(); ++e) {
      const auto i = static_cast<std::size_t>(e);
      episode_return_[i] += env_.rewards()[i];
      if (env_.terminated()[i] == 0 && env_.truncated()[i] == 0) continue;
      returns.push_back(episode_return_[i]);
      start_episode(job, e);
    }
    ppo_.observe(env_.observations());
  }

  void require_finite() const {
    if (ppo_.divergence()) throw Error(Failure::work, *ppo_.divergence());
  }

  VecEnv env_;
  Ppo ppo_;
  std::vector<std::uint64_t> next_episode_;  // [E] of each environment
  std::vector<double> episode_return_;       // [E] so far
};

// ---- open loop: sine waves, optimised or drawn at random ---------------------------

class SineTraining {
 public:
  explicit SineTraining(const Job& job)
      : actuators_(static_cast<std::size_t>(job.arena.action_length())),
        random_(job.seed, "train/search", job.robot_id),
        strategy_(initial_mean(), job.settings.initial_sigma, job.settings.population) {
    if (generation_cost(job) > job.settings.steps)
      throw error(Failure::usage,
                  "training: {} steps are less than one generation of {} episodes of {} steps",
                  job.settings.steps,
                  std::int64_t{job.settings.population} * job.settings.evaluation_episodes,
                  job.arena.task().episode_steps);
  }

  // Another generation might exceed the budget.
  bool done(const Job& job, const Record& record) const {
    return record.steps + generation_cost(job) > job.settings.steps;
  }

  void advance(const Job& job, Record& record, Metrics& metrics) {
    const bool learns = job.settings.algorithm == Algorithm::sine;
    std::vector<std::vector<double>> points;
    std::vector<SineController> candidates;
    if (learns) {
      points = strategy_.ask(random_);
      for (const auto& x : points) candidates.push_back(decode(x, job.settings));
    } else {
      for (int i = 0; i < job.settings.population; ++i) candidates.push_back(draw(job.settings));
    }
    const SineEvaluation result = evaluate_each(job.arena, candidates, job.evaluation());
    record.steps += result.steps;
    if (learns) strategy_.tell(points, result.means);

    const auto best = std::max_element(result.means.begin(), result.means.end());
    record.evaluated(*best, candidates[static_cast<std::size_t>(best - result.means.begin())]);
    double sum = 0.0;
    for (const double mean : result.means) sum += mean;
    metrics = {{"charts/episodic_return", sum / static_cast<double>(result.means.size())}};
    if (learns) metrics.push_back({"charts/sigma", strategy_.sigma()});
    report_evaluation(record, metrics);
  }

  void save(Checkpoint& checkpoint) const {
    checkpoint.put("search/random", random_);
    strategy_.save(checkpoint, "search/strategy");
  }

  void load(const Checkpoint& checkpoint) {
    checkpoint.get("search/random", random_);
    strategy_.load(checkpoint, "search/strategy");
  }

  Controller blank() const {
    return SineController{std::vector<double>(actuators_), std::vector<double>(actuators_)};
  }

 private:
  static constexpr double two_pi = 2.0 * std::numbers::pi;

  std::int64_t generation_cost(const Job& job) const {
    return std::int64_t{job.settings.population} * job.settings.evaluation_episodes *
           job.arena.task().episode_steps;
  }

  // A point of the search is [amplitudes, phases, period], scaled so that a step
  // of 1 matters about the same in each; phases start anywhere.
  std::vector<double> initial_mean() {
    std::vector<double> mean(2 * actuators_ + 1, 0.0);
    for (std::size_t i = 0; i < actuators_; ++i)
      mean[actuators_ + i] = two_pi * random_.uniform() / phase_scale;
    return mean;
  }

  SineController decode(const std::vector<double>& x, const TrainingSettings& s) const {
    SineController sine;
    for (std::size_t i = 0; i < actuators_; ++i) {
      sine.amplitude.push_back(0.3 + amplitude_scale * x[i]);
      sine.phase.push_back(phase_scale * x[actuators_ + i]);
    }
    const double middle = math::sqrt(s.shortest_period * s.longest_period);
    sine.period = std::clamp(middle * math::exp(period_scale * x[2 * actuators_]),
                             s.shortest_period, s.longest_period);
    return sine;
  }

  SineController draw(const TrainingSettings& s) {
    SineController sine;
    for (std::size_t i = 0; i < actuators_; ++i) sine.amplitude.push_back(0.5 * random_.uniform());
    for (std::size_t i = 0; i < actuators_; ++i) sine.phase.push_back(two_pi * random_.uniform());
    const double ratio = math::log(s.longest_period / s.shortest_period);
    sine.period = s.shortest_period * math::exp(ratio * random_.uniform());
    return sine;
  }

  static constexpr double amplitude_scale = 0.3;  // share of the rest length
  static constexpr double phase_scale = 2.0;      // radian
  static constexpr double period_scale = 0.7;     // of the period's logarithm

  std::size_t actuators_;
  Stream random_;
  EvolutionStrategy strategy_;
};

// ---- the record in checkpoints -------------------------------------------------------

void save(Checkpoint& checkpoint, const Record& record) {
  std::vector<std::uint64_t> steps;
  std::vector<double> evaluations;
  std::vector<double> best;
  for (const CurvePoint& point : record.curve) {
    steps.push_back(static_cast<std::uint64_t>(point.step));
    evaluations.push_back(point.evaluation);
    best.push_back(point.best);
  }
  checkpoint.put("curve/step", std::move(steps));
  checkpoint.put("curve/evaluation", std::move(evaluations));
  checkpoint.put("curve/best", std::move(best));
  checkpoint.put<std::uint64_t>("steps", {static_cast<std::uint64_t>(record.steps)});
  if (!record.best) return;
  checkpoint.put<std::uint64_t>("best/step", {static_cast<std::uint64_t>(record.best_step)});
  checkpoint.put<double>("best/fitness", {*record.fitness});
  if (const auto* policy = std::get_if<Policy>(&*record.best)) {
    save_policy(checkpoint, "best/policy", *policy);
  } else if (const auto* sine = std::get_if<SineController>(&*record.best)) {
    checkpoint.put("best/amplitude", sine->amplitude);
    checkpoint.put("best/phase", sine->phase);
    checkpoint.put<double>("best/period", {sine->period});
  }
}

// `blank` has the shape of the best controller.
Record load(const Checkpoint& checkpoint, Controller blank) {
  Record record;
  const auto& steps = checkpoint.get<std::uint64_t>("curve/step");
  const auto& evaluations = checkpoint.get<double>("curve/evaluation", steps.size());
  const auto& best = checkpoint.get<double>("curve/best", steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i)
    record.curve.push_back({static_cast<std::int64_t>(steps[i]), evaluations[i], best[i]});
  record.steps = static_cast<std::int64_t>(checkpoint.get<std::uint64_t>("steps", 1)[0]);
  if (steps.empty()) return record;
  record.best_step = static_cast<std::int64_t>(checkpoint.get<std::uint64_t>("best/step", 1)[0]);
  record.fitness = checkpoint.get<double>("best/fitness", 1)[0];
  if (auto* policy = std::get_if<Policy>(&blank)) {
    load_policy(checkpoint, "best/policy", *policy);
  } else if (auto* sine = std::get_if<SineController>(&blank)) {
    sine->amplitude = checkpoint.get<double>("best/amplitude", sine->amplitude.size());
    sine->phase = checkpoint.get<double>("best/phase", sine->phase.size());
    sine->period = checkpoint.get<double>("best/period", 1)[0];
  }
  record.best = std::move(blank);
  return record;
}

// ---- the end ----------------------------------------------------------------------------

FinalScore score(const Job& job, const Controller& controller) {
  EvaluationSettings final;
  final.episodes = job.settings.final_episodes;
  final.seed = derive_seed(job.seed, "final");
  final.jitter = job.settings.final_jitter;
  const Evaluation scores = evaluate(job.arena, controller, final);
  return {final.episodes, scores.mean(), scores.standard_error()};
}

// Work that failed becomes a record; any other error is thrown on.
TrainingFailure failure_record(const Error& failure, const Job& job, const Record& record) {
  if (failure.kind() != Failure::work) throw failure;
  return {failure.what(), record.steps, job.seed};
}

}  // namespace

// ---- the trainer ----------------------------------------------------------------------

struct Trainer::Impl {
  Job job;
  Record record;
  std::variant<PpoTraining, SineTraining> method;

  static std::variant<PpoTraining, SineTraining> begin(const Job& job) {
    check(job.settings);
    if (job.settings.algorithm == Algorithm::ppo) return PpoTraining(job);
    return SineTraining(job);
  }

  explicit Impl(Job j) : job(std::move(j)), method(begin(job)) {}
};

Trainer::Trainer(const Arena& arena, const TrainingSettings& settings, std::uint64_t seed,
                 std::string_view robot_id)
    : impl_(std::make_unique<Impl>(Job{arena, settings, seed, std::string(robot_id)})) {}

Trainer::~Trainer() = default;
Trainer::Trainer(Trainer&&) noexcept = default;
Trainer& Trainer::operator=(Trainer&&) noexcept = default;

bool Trainer::done() const {
  if (impl_->record.failure) return true;
  return std::visit([&](const auto& m) { return m.done(impl_->job, impl_->record); },
                    impl_->method);
}

TrainingReport Trainer::advance() {
  Impl& it = *impl_;
  TrainingReport report;
  try {
    std::visit([&](auto& m) { m.advance(it.job, it.record, report.metrics); }, it.method);
  } catch (const Error& failure) {
    it.record.failure = failure_record(failure, it.job, it.record);
  }
  report.step = it.record.steps;
  report.steps = it.job.settings.steps;
  return report;
}

TrainResult Trainer::result() const {
  const Job& job = impl_->job;
  const Record& record = impl_->record;
  TrainResult result;
  result.complete = done();
  result.steps = record.steps;
  result.curve = record.curve;
  result.failure = record.failure;
  if (result.failure || !record.best) return result;
  if (result.complete && job.settings.final_episodes > 0) {
    try {
      result.final_score = score(job, *record.best);
    } catch (const Error& failure) {
      result.failure = failure_record(failure, job, record);
      return result;
    }
  }
  result.fitness = record.fitness;
  result.controller = record.best;
  result.best_step = record.best_step;
  return result;
}

Checkpoint Trainer::checkpoint() const {
  Checkpoint checkpoint;
  save(checkpoint, impl_->record);
  std::visit([&](const auto& m) { m.save(checkpoint); }, impl_->method);
  return checkpoint;
}

void Trainer::restore(const Checkpoint& checkpoint) {
  std::visit(
      [&](auto& m) {
        impl_->record = load(checkpoint, m.blank());
        m.load(checkpoint);
      },
      impl_->method);
}

TrainResult train(Trainer& trainer, const TrainingHook& go_on) {
  while (!trainer.done()) {
    const TrainingReport report = trainer.advance();
    if (go_on && !go_on(trainer, report)) break;
  }
  return trainer.result();
}

}  // namespace evo
