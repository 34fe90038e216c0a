// A controller that plans in the simulation itself: the best of some windows of actions is done
// for a few steps, then come the next windows (model-predictive control). It plans some windows
// ahead of the episode, and where they lead to a fall, it goes back and plans again. It knows the
// whole state of the world, so it tells what a body can do from any start, not what a controller
// that senses can.
//
// The simulation looks a window ahead from one moment in several lanes, each with a plan of its
// own. To earn the most, every plan climbs the gradient of what it earns (libevo/task/step_tape.h),
// again and again. Windows are short, since gradients through many contacts grow without bound, and
// each plan has one length of step, since entries that decide nothing have gradients of nearly 0,
// and must not be scaled up to the others. To hold to a way, what the plans of all lanes do to the
// distances from it tells which sum of them leads back: least squares, without a gradient.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/control/open_loop.h"
#include "libevo/task/env.h"
#include "libevo/task/step_tape.h"

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
  // Targets of the steps of a window, [K x A], before they are squashed into their range.
  using Plan = std::vector<double>;
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
  // A plan at work.
  struct Lane {
    Plan plan;
    std::vector<double> mean = {};    // of gradients
    std::vector<double> square = {};  // of their squares
    // Of the last simulation.
    std::size_t steps = 0;                 // done in the window
    std::vector<double> off = {};          // its points from the way, x and y after each of them
    std::vector<std::uint8_t> after = {};  // the state after those that may be done
    double value = 0.0;                    // what the window earned, and would for a while after it
    bool is_over = false;                  // the episode ended in it
  };

  std::size_t actuators() const { return static_cast<std::size_t>(arena_->action_length()); }
  void targets_of(const Plan& plan, std::size_t k, std::span<double> targets) const;
  Plan plan_of(std::span<const double> targets) const;
  Plan faint(std::size_t steps, Stream& random) const;
  Plan continued(const Plan& plan, std::size_t done, std::size_t steps) const;
  Plan noisy(Plan plan, double size, Stream& random) const;

  std::vector<Vec2> way_of(const EpisodeStart& start);
  std::size_t steps_of(const Episode& episode) const;
  std::vector<Plan> first_plans(const Part& before, int t, std::size_t window,
                                Stream& random) const;
  // Does the plans of all lanes, [window] steps, from a moment saved by VecEnv::save(), and keeps
  // the states after `committed` of them. Plans earn what the task pays; or, given the points to
  // be at after each step, [window x points], they earn the less, the farther off they are.
  void simulate(std::span<const std::uint8_t> from, std::size_t window, std::size_t committed,
                std::span<const Vec2> way);
  // Each plan goes a step up the gradient of what it earned.
  void climb(std::size_t window);
  // The next plans are the sum of those tried that should lead back to the way, and others around.
  void come_back(int round, Stream& random);
  Part next_part(const Episode& episode, const Part& before, int t, Stream& random);
  void plan_ahead(Episode& episode, int t, Stream& random);

  const Arena* arena_;
  const PlannerController* settings_;
  double middle_;  // of the range of targets
  double half_;
  VecEnv env_;
  std::vector<Lane> lanes_;
  std::vector<Lane> tried_;        // in this window, for a way
  std::vector<StepTape> tapes_;    // of each step of a window
  std::vector<Episode> episodes_;  // of each lane
};

}  // namespace evo
