// Windows of actions improved by gradient: the simulation looks some steps ahead from one moment
// in several lanes, each with a plan of its own, and every plan climbs the gradient of what it
// earns (libevo/task/step_tape.h), again and again. Windows are short, since gradients through
// many contacts grow without bound, and each plan has one length of step, since entries that
// decide nothing have gradients of nearly 0, and must not be scaled up to the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/task/env.h"
#include "libevo/task/step_tape.h"

namespace evo {

// Targets of the steps of a window, [K x A], before they are squashed into their range.
using Plan = std::vector<double>;

class Planner {
 public:
  // `arena` must outlive this.
  explicit Planner(const Arena& arena);

  // As many steps as a window may have for its tapes to stay within some memory.
  int longest_window(int lanes) const;

  // What a plan aims for at step k.
  void targets_of(const Plan& plan, std::size_t k, std::span<double> targets) const;
  // The plan that aims for these, or nearly where they are at an end of their range.
  Plan plan_of(std::span<const double> targets) const;

  // Next to nothing, at random.
  Plan faint(std::size_t steps, Stream& random) const;
  // The plan after its first steps have been done, as long as `steps`: what is missing at its end
  // is what came half a window before.
  Plan continued(const Plan& plan, std::size_t done, std::size_t steps) const;
  // The plan with noise that changes slowly, of this deviation.
  Plan noisy(Plan plan, double size, Stream& random) const;

  // One plan for each lane, of one length K. Plans earn what the task pays; or, given the points
  // to be at after each step, [K x points], they earn the less, the farther off they are.
  void begin(std::vector<Plan> plans, std::span<const Vec2> way = {});

  struct Outcome {
    double value = 0.0;    // what the window earned, and would earn for a while after it
    bool is_over = false;  // the episode ended in it
  };
  using Stepped = std::function<void(std::size_t lane)>;  // called after every step of a lane
  // Does all plans in the first lanes of `env`, from a moment saved by VecEnv::save().
  const std::vector<Outcome>& simulate(VecEnv& env, std::span<const std::uint8_t> from,
                                       const Stepped& stepped);
  // Each plan goes a step up the gradient of what it earned.
  void climb();

  const Plan& plan(std::size_t lane) const { return lanes_[lane].plan; }

 private:
  struct Lane {
    Plan plan;
    std::vector<double> mean;    // of gradients
    std::vector<double> square;  // of their squares
    std::size_t steps = 0;       // done in the window
    std::vector<Vec2> off;       // its points from the way, after each of them
  };

  double stray(Lane& lane, std::size_t step, std::span<const Vec2> points) const;
  std::size_t actuators() const { return static_cast<std::size_t>(arena_->action_length()); }

  const Arena* arena_;
  double middle_;
  double half_;
  std::size_t window_ = 0;        // steps
  std::size_t environments_ = 0;  // of the last simulation
  std::vector<Lane> lanes_;
  std::vector<Vec2> way_;
  std::vector<Outcome> outcomes_;
  std::vector<StepTape> tapes_;  // of each step
};

}  // namespace evo
