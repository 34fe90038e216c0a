// A controller that plans in the simulation itself: the best of some windows of actions is done
// for a few steps, then come the next windows (model-predictive control). It plans some windows
// ahead of the episode, and where they lead to a fall, it goes back and plans again. It knows the
// whole state of the world, so it tells what a body can do from any start, not what a controller
// that senses can.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/control/planner.h"
#include "libevo/control/replay.h"
#include "libevo/task/env.h"

namespace evo {

struct PlannerController {
  int window = 96;     // control steps
  int committed = 16;  // done of each plan before the next
  int rounds = 8;      // of simulating all plans, with a step up their gradients in between
  int lanes = 8;       // plans
  // Hold to the way that this sequence takes in the unperturbed episode, rather than to earn.
  // The episode ends with it.
  std::optional<ReplayController> sequence = {};
  bool operator==(const PlannerController&) const = default;
};

class Replanner {
 public:
  // Both must outlive this. Throws Error(usage) for settings below 1.
  Replanner(const Arena& arena, const PlannerController& settings);

  // Targets of step t of an episode in a lane of `env`, [A], which began with `start`. Steps come
  // one after the other, from 0 on; `random` is the episode's own.
  void act(const VecEnv& env, int lane, int t, const EpisodeStart& start, Stream& random,
           std::span<double> targets);

 private:
  // The first steps of a window.
  struct Part {
    Plan plan;                        // of the whole window
    int steps = 0;                    // of it
    std::vector<std::uint8_t> after;  // the state then, unless the episode is over
    bool is_lost = false;             // the window ends in a fall
  };
  struct Episode {
    std::vector<Vec2> way;   // points after each step of the sequence
    Part now;                // that is being done
    int since = 0;           // the step that it began at
    std::deque<Part> ahead;  // after it
    int retreats = 0;        // that may still be made
  };

  std::vector<Vec2> way_of(const EpisodeStart& start);
  std::size_t steps_of(const Episode& episode) const;
  std::vector<Plan> first_plans(const Part& before, int t, std::size_t window,
                                Stream& random) const;
  Part next_part(const Episode& episode, const Part& before, int t, Stream& random);
  void plan_ahead(Episode& episode, int t, Stream& random);

  const Arena* arena_;
  const PlannerController* settings_;
  Planner planner_;
  VecEnv env_;
  std::vector<Episode> episodes_;  // of each lane
};

}  // namespace evo
