// What a training starts from: nothing, the controller of a parent, or a checkpoint of
// the same training.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/train.h"
#include "formats/robot/robot.h"
#include "formats/training/identity.h"
#include "libevo/control/checkpoint.h"
#include "libevo/control/trainer.h"

namespace evo {

struct TrainingStart {
  std::optional<Inheritance> inheritance;
  TrainingOrigin origin;
  TrainingIdentity identity;             // of the whole training
  std::optional<Checkpoint> checkpoint;  // to continue from
};

// Throws Error(no_input) for a founder without the controller that it is to have,
// Error(cannot_create) where the checkpoint is of another training, Error(data).
// `robots` are all that get the same controller.
TrainingStart find_start(const TrainingPlan& plan, const Robot& robot,
                         const std::vector<const Arena*>& robots);

// The trainer in the state of the checkpoint, which came from `path`.
void restore(Trainer& trainer, const Checkpoint& checkpoint, const std::filesystem::path& path);

// Whether the policy with this identity is of the training, but perhaps for its span.
bool is_part(const std::string& identity, const TrainingStart& start);

}  // namespace evo
