// Gradients through steps of environments: what a step of a VecEnv gave, rewards and
// observations, by the state before it and by the actions. Reward terms and observation parts
// have derivatives; conditions do not, so that rules and what they add, terms that begin or
// end to count, and the counting of goals go unseen. See docs/gradients.md.
#pragma once

#include <memory>
#include <span>

#include "libevo/sim/adjoint.h"
#include "libevo/task/env.h"

namespace evo {

class StepTape {
 public:
  explicit StepTape(double onset = usual_onset);  // as of Tape
  ~StepTape();
  StepTape(StepTape&&) noexcept;

  // For every environment that the step moved, from derivatives by the state after it to those
  // by the state before; targets are those of the step before, which only action_change knows.
  //   by_rewards       [E] how much the step's reward counts
  //   by_observations  as VecEnv::observations(), or empty: they do not count
  //   gradients        [E]
  //   by_actions       as the actions of VecEnv::step(), set
  // All are 0 where a robot folded or the simulation became unstable. The others are left alone.
  void pull_back(std::span<const double> by_rewards, std::span<const double> by_observations,
                 std::span<Gradient> gradients, std::span<double> by_actions,
                 ThreadPool* pool = nullptr) const;

  struct Impl;  // private to libevo/task
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace evo
