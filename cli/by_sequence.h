// A network for each robot by way of a sequence of actions (docs/recipes.md): an eighth of the
// steps searches for a sequence, an eighth trains a network that corrects it, and the rest one of
// its own, whose episodes begin along it (profiles `sequence`, `feedback`, `moments`). The
// network that earns more from 64 perturbed starts stays, and this mean is its fitness.
#pragma once

#include <functional>
#include <vector>

#include "cli/training_options.h"

namespace evo::cli {

// As train_robots() in train.h, by the options of evo-train: steps are those of all
// stages, whose files go to folders of --out-dir named by profile. Each stage has a seed of its
// own: with one for all, a parent would enter with its lucky value on the same starts.
int train_by_sequence(const Command& command, const TrainingOptions& options,
                      const std::vector<Robot>& robots,
                      const std::function<void(std::size_t, Robot)>& put);

}  // namespace evo::cli
