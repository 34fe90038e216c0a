// What a rollout's task says about it: why an episode was over, what it rewards.
#pragma once

#include <optional>
#include <string>

#include "formats/io/node.h"
#include "formats/rollout/rollout.h"
#include "libevo/sim/physics.h"

namespace evo {

// The physics in force; the benchmark's in files that carry none. Throws Error(data).
Physics recorded_physics(const Rollout& rollout);

// What the task has under a key; nothing where it does not, and in files that carry no task.
// Throws Error(data) for a task that is not YAML.
std::optional<Node> task_value(const Rollout& rollout, const char* key);

// Control steps that the task holds an action for: those of a step of the rollout.
int hold_of(const Rollout& rollout);
// Steps in a second of video at speed 1: the benchmark's viewer shows 50 control steps.
double steps_per_second(const Rollout& rollout);

// Whether the task rewards height at all times: a displacement or an extent along y.
bool rewards_height(const Rollout& rollout);
// Whether the robot's turning counts.
bool rewards_turning(const Rollout& rollout);

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
