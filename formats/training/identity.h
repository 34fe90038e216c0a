// What decides the result of a training, as lines "key=value", and the hash of
// them: how a policy or a checkpoint is known to be of the training asked for.
//
//   evo-training 3
//   robot=3f9c02d41b7a
//   seed=1
//   task.name=Walker-v0          names the random streams
//   task.observation.0.velocity=robot
//   ...
//   physics.gravity=50
//   training.learning_rate=0.001
//
// No words of explanation are among them: a description, a comment or a hint can
// be corrected without losing a training. Numbers have the shortest form that reads back to the
// same bits.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libevo/body/body.h"
#include "libevo/control/settings.h"
#include "libevo/task/spec.h"

namespace evo {

// What a training started from, besides its settings: lines of its identity.
struct TrainingOrigin {
  // How many robots get one controller, and the hash of their ids; empty: one robot.
  std::string robots;
  // Settings hash of the policy that was inherited; empty: none.
  std::string inherited;
  // Steps after which the training had been at an end before it was asked for more,
  // ascending: what was trained in parts is another training than the whole at once.
  std::vector<std::int64_t> parts;
};

struct TrainingIdentity {
  std::string lines;

  std::string hash() const;  // SHA-256 of the lines, in hex
};

TrainingIdentity identify(const Body& robot, const TaskSpec& task, const TrainingSettings& settings,
                          std::uint64_t seed, const TrainingOrigin& origin = {});

// How long the training of an identity is.
struct TrainingSpan {
  std::int64_t steps = 0;
  std::vector<std::int64_t> parts;  // as in TrainingOrigin
};

// The span of `there` if it is the training `asked` for but for its span.
std::optional<TrainingSpan> span_of_same(const std::string& there, const std::string& asked);

// "training.steps: 4096 there, 8192 asked for; ..." for the first few settings
// that differ; empty if none does.
std::string difference(const std::string& there, const std::string& asked);

}  // namespace evo
