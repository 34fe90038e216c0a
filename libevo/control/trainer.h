// One training of one robot: rollouts, updates, evaluations, and the best
// controller found. Single-threaded and sharing nothing, so that many robots
// train side by side; the result depends on arena, settings, seed and robot id.
// See docs/methods.md, "Training".
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libevo/control/checkpoint.h"
#include "libevo/control/controller.h"
#include "libevo/control/settings.h"
#include "libevo/control/transfer.h"
#include "libevo/task/env.h"

namespace evo {

// An evaluation after so many environment steps, and the best until then.
struct CurvePoint {
  std::int64_t step = 0;
  double evaluation = 0.0;
  double best = 0.0;
  bool operator==(const CurvePoint&) const = default;
};

// The best controller over `episodes` episodes with jittered starts.
struct FinalScore {
  int episodes = 0;
  double mean = 0.0;
  double standard_error = 0.0;
  bool operator==(const FinalScore&) const = default;
};

// A training whose numbers left the finite ones.
struct TrainingFailure {
  std::string why;
  std::int64_t step = 0;  // environment steps taken
  std::uint64_t seed = 0;
  bool operator==(const TrainingFailure&) const = default;
};

// The controller of another robot that a training starts from.
struct Inheritance {
  TrainedController controller;
  Anatomy anatomy;  // what it was attached to
};

// What a training has found so far.
struct TrainResult {
  std::int64_t steps = 0;  // environment steps taken
  std::vector<CurvePoint> curve;
  std::optional<double> fitness;                // best evaluation; none after a failure
  std::optional<TrainedController> controller;  // that reached it
  std::int64_t best_step = 0;                   // when it did
  // What each of several robots earned then, NaN where its simulation became unstable.
  std::vector<double> each;
  std::optional<FinalScore> final_score;  // the last thing that a training does
  std::optional<TrainingFailure> failure;

  // Adds a point to the curve, and keeps the controller, and what each of several robots earned
  // with it, if it is strictly better than all before.
  void evaluated(double value, const TrainedController& of, std::span<const double> of_each = {});
};

// Named as CleanRL names them: "losses/policy_loss", "charts/learning_rate", ...
// The caller, who has a clock, adds "charts/SPS".
struct Metric {
  std::string name;
  double value = 0.0;
};

struct TrainingReport {
  std::int64_t step = 0;   // environment steps so far
  std::int64_t steps = 0;  // of the whole training
  std::vector<Metric> metrics;
};

class Trainer {
 public:
  // `robots` must outlive this: one, or more of the same task that get the same controller, of a
  // method that can make one for several. Throws Error(usage) for settings that make no
  // sense, Error(data) for an inheritance that does not fit them. `name` names the random
  // streams: a robot's id.
  Trainer(std::vector<const Arena*> robots, const TrainingSettings& settings, std::uint64_t seed,
          std::string_view name, std::optional<Inheritance> inheritance = {});
  Trainer(const Arena& robot, const TrainingSettings& settings, std::uint64_t seed,
          std::string_view name, std::optional<Inheritance> inheritance = {})
      : Trainer(std::vector{&robot}, settings, seed, name, std::move(inheritance)) {}
  ~Trainer();

  bool done() const;
  // One update of PPO or one generation of the search, and the evaluation
  // where one is due; at the end the final episodes. Numbers that stop being finite end the
  // training with a failure record.
  TrainingReport advance();
  const TrainResult& result() const;

  // Everything needed to continue to the same bytes.
  Checkpoint checkpoint() const;
  // Into a trainer made with the same arguments, or with more steps: a finished
  // training then continues. Throws Error(data) otherwise.
  void restore(const Checkpoint& checkpoint);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Advances to the end, or until `go_on`, called after every advance, says no.
using TrainingHook = std::function<bool(const Trainer&, const TrainingReport&)>;
TrainResult train(Trainer& trainer, const TrainingHook& go_on = {});

}  // namespace evo
