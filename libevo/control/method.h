// What every way of training shares: the job it is given, and what the Trainer asks of it.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libevo/control/checkpoint.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/settings.h"
#include "libevo/control/trainer.h"

namespace evo {

// How a training with these settings evaluates: the fitness of its best comes from this.
EvaluationSettings evaluation_of(const TrainingSettings& settings, std::uint64_t seed);

struct TrainingJob {
  std::vector<const Arena*> robots;  // that get the same controller; one or more
  TrainingSettings settings;
  std::uint64_t seed = 0;
  std::string robot_id;  // names the random streams
  std::optional<Inheritance> inheritance = {};

  const Arena& arena() const { return *robots.front(); }
  // Evaluations meet the same episodes for every robot.
  EvaluationSettings evaluation() const { return evaluation_of(settings, seed); }
};

// What the controller earns in episodes of the job's robots, robot after robot. Among several
// robots, one whose simulation becomes unstable is left out; `each` has their means then, and NaN.
Evaluation evaluate_all(const TrainingJob& job, const Controller& controller,
                        const EvaluationSettings& settings, std::vector<double>* each = nullptr);

using Metrics = std::vector<Metric>;
double mean(std::span<const double> values);  // of one or more

// The gait that the job inherits, carried over to its robot: of a controller that is
// one, or of a network on one. Nothing where there is none.
std::optional<SineController> inherited_gait(const TrainingJob& job);
// What an inherited network is on, an inherited gait, or, where the settings keep it, an
// inherited sequence, likewise.
std::optional<OpenLoop> inherited_base(const TrainingJob& job);

// Adds what the controller earns, evaluated as the settings say, to the result.
void evaluate(const TrainingJob& job, const TrainedController& controller, TrainResult& result);
// eval/return and eval/best of the evaluation just made.
void report_evaluation(const TrainResult& result, Metrics& metrics);

// What a way of training can do, beside what all can.
struct Abilities {
  // One controller for many robots. It continues only one that is for any body.
  bool shares = false;
  bool own_tasks = false;      // needs nothing but observations, actions and rewards
  bool whole_updates = false;  // trains by updates of environments x rollout steps
};

// A way of training. libevo/control/methods.h lists them all; the list is the
// only place that has to know of a new one.
template <typename T>
concept TrainingMethod = std::movable<T> && std::constructible_from<T, const TrainingJob&> &&
    requires(T method, const T& constant, const TrainingJob& job, TrainResult& result,
             const TrainResult& so_far, Metrics& metrics, const Archive& archive,
             const TrainingSettings& settings) {
  { T::algorithm } -> std::convertible_to<Algorithm>;
  { T::can } -> std::convertible_to<Abilities>;
  // Throws Error(usage) for settings that make no sense with this method.
  T::check(settings);
  { constant.done(job, so_far) } -> std::same_as<bool>;
  // One update or generation, and the evaluation where one is due. Throws
  // Error(work) where numbers leave the finite ones.
  method.advance(job, result, metrics);
  // All that the method needs to continue to the same bytes.
  method.serialize(archive);
};

}  // namespace evo
