// A trained controller at work on one robot.
#pragma once

#include <optional>
#include <span>

#include "libevo/control/controller.h"

namespace evo {

class Actor {
 public:
  // Both must outlive this. Throws Error(data) where the controller has other observations or
  // actions than the robot in its task, or was trained on another task.
  Actor(const TrainedController& controller, const Arena& arena);

  // Targets [E x A] of E environments of the arena in `env`, from `first` on, at `steps` [E] of
  // their episodes.
  void act(const VecEnv& env, int first, std::span<const int> steps, std::span<double> targets);

 private:
  const TrainedController* controller_;
  std::optional<ModularActor> modular_;
  NetworkScratch scratch_;
};

// Throws Error(data) where the sequence is empty or one for another number of actuators.
void require_fit(const ReplayController& sequence, const Arena& arena);

}  // namespace evo
