// Why an episode was over.
#pragma once

#include <string>

#include "formats/rollout/rollout.h"

namespace evo {

struct Ending {
  enum class Kind { cut, limit, goal, failure, rule };
  Kind kind = Kind::cut;
  std::string text;  // for people: "the task's goal: robot's x above 99"
};

// From the flags of the last step and the rules of the task the rollout carries: of
// those that hold at the end, the one that rewards or punishes most. Folding up is a
// rule of every task, known by its punishment. `robot` and other objects are measured
// by the mean of their points, as the tasks do (docs/tasks.md, "Rewards and ends").
Ending ending(const Rollout& rollout, const RolloutEpisode& episode);

}  // namespace evo
