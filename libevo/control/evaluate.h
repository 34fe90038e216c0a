// Episodes run for their returns. Episode k of a seed starts from the same
// draws for every robot and controller (docs/tools.md, "Reproducible"), and its
// result does not depend on which episodes run beside it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "libevo/control/controller.h"
#include "libevo/task/env.h"

namespace evo {

struct EvaluationSettings {
  int episodes = 1;
  std::uint64_t seed = 0;
  double jitter = 0.0;              // of every start coordinate, voxels
  int max_steps = 0;                // episodes end here at the latest; 0: the task's limit alone
  std::optional<Draws> draws = {};  // of every episode, instead of those of (seed, k)
  int lanes = 16;                   // episodes side by side: speed, not results
  int threads = 1;                  // that planners share: speed, too
};

// How an episode of an evaluation, counted from 0, begins.
EpisodeStart start_of(const Arena& arena, const EvaluationSettings& settings, int episode);

struct Evaluation {
  std::vector<double> returns;     // [episodes], in order
  std::vector<int> lengths;        // control steps
  std::vector<double> peaks = {};  // [episodes], the highest that the return was after a step

  double mean() const;
  double standard_error() const;  // of the mean; 0 for one episode
  std::int64_t steps() const;     // of all episodes
};

// What an observer is shown: after the reset (no targets), then after every
// step. The lane's observation, reward and so on are read from `env`.
struct EpisodeMoment {
  int episode = 0;
  const VecEnv& env;
  int lane = 0;                     // environment of `env` the episode runs in
  std::span<const double> targets;  // [A] just taken, or empty
  bool last = false;                // the episode is over
  const EpisodeStart& start;
};
using EpisodeObserver = std::function<void(const EpisodeMoment&)>;

// Throws Error(work) where the controller or the simulation yields something
// that is not a finite number, Error(data) where a controller does not fit the
// arena (lengths of observation or action).
Evaluation evaluate(const Arena& arena, const Controller& controller,
                    const EvaluationSettings& settings, const EpisodeObserver& observer = {});

// What the controller does in the first of these episodes, [T x A]. Throws as evaluate().
ReplayController recorded(const Arena& arena, const Controller& controller,
                          EvaluationSettings settings);

// Many open-loop controllers, waves or sequences, which fit the arena, over the same episodes.
struct OpenLoopEvaluation {
  std::vector<double> means;  // [controllers] of the returns
  std::vector<double> peaks;  // [controllers] of the highest that the return ever was
  std::int64_t steps = 0;     // of all episodes of all of them
};
template <typename OpenLoopController>
OpenLoopEvaluation evaluate_each(const Arena& arena,
                                 const std::vector<OpenLoopController>& controllers,
                                 const EvaluationSettings& settings);

}  // namespace evo
