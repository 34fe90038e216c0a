// What every way of training shares: the job it is given, what it has found so
// far, and what the Trainer asks of it.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libevo/control/checkpoint.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/ppo_parts.h"
#include "libevo/control/settings.h"
#include "libevo/control/trainer.h"

namespace evo {

// How a training with these settings evaluates: the fitness of its best comes from this.
EvaluationSettings evaluation_of(const TrainingSettings& settings, std::uint64_t seed);

struct TrainingJob {
  const Arena& arena;
  TrainingSettings settings;
  std::uint64_t seed = 0;
  std::string robot_id;  // names the random streams
  std::optional<Inheritance> inheritance = {};
  // Of more robots that are to have the same controller, in the same task.
  std::vector<const Arena*> others = {};
  std::vector<Demonstration> demonstrations = {};  // of this robot

  std::vector<const Arena*> arenas() const;  // of all robots
  // Evaluations meet the same episodes for every robot.
  EvaluationSettings evaluation() const;
};

struct Findings {
  std::int64_t steps = 0;  // environment steps taken
  std::vector<CurvePoint> curve;
  std::optional<double> fitness;
  std::optional<TrainedController> best;
  std::int64_t best_step = 0;
  std::vector<double> best_each;  // as in TrainResult
  std::optional<TrainingFailure> failure;

  // Adds a point to the curve, and keeps the controller, and what each of several robots earned
  // with it, if it is strictly better than all before.
  void evaluated(double value, const TrainedController& controller,
                 std::span<const double> each = {});
};

// What the controller earns in episodes of the job's robots, robot after robot. Of several
// robots, one whose simulation becomes unstable is left out; `each` has their means then, and NaN.
Evaluation evaluate_all(const TrainingJob& job, const Controller& controller,
                        const EvaluationSettings& settings, std::vector<double>* each = nullptr);

using Metrics = std::vector<Metric>;

// What an update of PPO did, and the mean of the returns of episodes that ended meanwhile.
Metrics update_metrics(const UpdateReport& update, std::span<const double> returns);

// An untrained policy for the job's arena, on a base where one is given.
Policy initial_policy(const TrainingJob& job, std::optional<OpenLoop> base);

// The gait that the job inherits, carried over to its robot: of a controller that is
// one, or of a network on one. Nothing where there is none.
std::optional<SineController> inherited_gait(const TrainingJob& job);
// What an inherited network is on, an inherited gait, or, where the settings keep it, an
// inherited sequence, likewise.
std::optional<OpenLoop> inherited_base(const TrainingJob& job);

// Adds what the controller earns, evaluated as the settings say, to the findings.
void evaluate(const TrainingJob& job, const TrainedController& controller, Findings& findings);
// eval/return and eval/best of the evaluation just made.
void report_evaluation(const Findings& findings, Metrics& metrics);

// A way of training. libevo/control/methods.h lists them all; the list is the
// only place that has to know of a new one.
template <typename T>
concept TrainingMethod = std::movable<T> && std::constructible_from<T, const TrainingJob&> &&
    requires(T method, const T& constant, const TrainingJob& job, Findings& findings,
             const Findings& found, Metrics& metrics, Checkpoint& out, const Checkpoint& in,
             const TrainingSettings& settings) {
  // As profiles and --algo name it.
  { T::name } -> std::convertible_to<const char*>;
  // Throws Error(usage) for settings that make no sense with this method.
  T::check(settings);
  { constant.done(job, found) } -> std::same_as<bool>;
  // One update or generation, and the evaluation where one is due. Throws
  // Error(work) where numbers leave the finite ones.
  method.advance(job, findings, metrics);
  // All that the method needs to go on to the same bytes.
  constant.save(out);
  method.load(in);
};

}  // namespace evo
