// Search for a sequence of actions, one target for every actuator at every step of an
// episode: "first return, then explore" (Ecoffet, Huizinga, Lehman, Stanley, Clune:
// Nature 590, 2021). An archive keeps moments of the simulation: for every level of
// return that was ever reached the one that was reached soonest, and for every tenth
// step of the episode the one that has earned the most until then. The first is what
// travelling needs, the second what only counts at the end, as to be high up then.
// Again and again a moment is chosen, a little visited one rather, and of levels a high
// one; the simulation continues from there with something new for a while, and what is
// better than the archive's enters it. New is a gait, changed or not, or targets held by
// groups of actuators. A step in front of a stair costs one step, not an episode, and what
// a fall would cost keeps nobody from trying. What earned the most too early, as a jump that
// is over before the episode is, is done once more after a rest, so as to end with it.
//
// A search that starts from a sequence, as a child from its parent's, or from a gait
// enters all that this reaches first.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libevo/base/bytes.h"
#include "libevo/base/random.h"
#include "libevo/control/checkpoint.h"
#include "libevo/control/controller.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/open_loop.h"
#include "libevo/control/settings.h"
#include "libevo/control/transfer.h"
#include "libevo/task/env.h"

namespace evo {

class SequenceSearch {
 public:
  // In the first episode that `evaluation` means, in the settings' environments side by side, with
  // gaits of their periods. `arena` must outlive this.
  SequenceSearch(const Arena& arena, const TrainingSettings& settings,
                 const EvaluationSettings& evaluation, Stream random,
                 std::optional<OpenLoop> start = {});

  // Explores for no more than `budget` control steps, and says how many it took: none
  // where they are fewer than the whole episodes that a search begins with (one of what
  // it starts from, else one in each environment).
  std::int64_t explore(std::int64_t budget);

  // The sequences that may earn the most, [T x A]: of the episodes that came to their
  // end, the best; and the one that leads to the highest level of return, where it
  // leads further, which holds its last targets from then on. Neither twice.
  std::vector<ReplayController> news();

  // Enters all that this gait reaches, next, as of what the search starts from.
  void offer(SineController gait);

  const std::optional<OpenLoop>& start() const { return start_; }
  std::size_t levels() const { return soonest_.size(); }  // in the archive
  double highest() const;                                 // return among them

  // Loading throws Error(data) for a checkpoint of another search.
  void serialize(const Archive& archive);

 private:
  struct Moment {
    std::vector<std::uint8_t> state;  // VecEnv::save
    std::vector<double> actions;      // that lead there, [t x A]
    double earned = 0.0;              // return of them
    SineController gait;              // in progress; without phases: none
    int visits = 0;
    bool delayed = false;  // all of it was done once more, after a rest
    void pass(Bytes& bytes);
  };
  using Moments = std::map<std::int64_t, Moment>;
  // An attempt from a moment on: some steps of targets held by groups of actuators,
  // then a gait.
  struct Attempt {
    Moment at;
    int steps_left = 0;
    int pushes_left = 0;
    int held = 1;
    std::vector<std::size_t> group;    // of each actuator
    std::vector<double> values;        // of each group
    std::optional<OpenLoop> replayed;  // instead of all this
  };

  double uniform(double low, double high) { return low + (high - low) * random_.uniform(); }
  int episode_steps() const { return arena_->task().episode_steps; }
  double low() const { return arena_->task().physics.min_target; }
  double high() const { return arena_->task().physics.max_target; }
  double target(double value) const { return recorded_target(value, low(), high()); }
  int steps_of(const Moment& moment) const;
  std::int64_t level_of(double earned) const;

  Moment* choose();
  bool note(Attempt& attempt, std::size_t lane, std::span<const double> targets);
  void begin();
  std::int64_t measure_level_height(std::int64_t budget);
  Moment* choose_level();
  Moment* choose_time();
  Moment* choose_early();
  Attempt attempt();
  Attempt whole_episode(OpenLoop replayed);
  ReplayController after_a_rest(const Moment& moment) const;
  SineController new_gait();
  SineController changed(SineController gait);
  void choose_targets(Attempt& attempt, std::span<double> targets);
  void enter(Attempt& attempt, int lane);
  void enter(Moments& moments, std::int64_t place, Attempt& attempt, int lane);
  void coarsen();
  ReplayController whole(const std::vector<double>& actions) const;

  const Arena* arena_;
  TrainingSettings settings_;
  EvaluationSettings evaluation_;
  std::vector<Anatomy::Place> places_;  // cells of the actuators
  Stream random_;
  std::optional<OpenLoop> start_;
  VecEnv env_;

  double level_height_ = 0.0;  // 0 until it is known
  bool start_is_due_;
  Moments soonest_;            // by level of return
  Moments highest_;            // by steps / slot
  std::vector<double> ended_;  // actions of the best episode that came to its end
  double ended_return_ = 0.0;
  bool ended_is_new_ = false;
  // The highest level that news() has spoken of.
  double shown_ = -std::numeric_limits<double>::infinity();
};

}  // namespace evo
