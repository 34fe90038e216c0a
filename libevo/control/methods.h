// The ways of training. A new one is a class that fulfils TrainingMethod
// (method.h), a line here and a word in settings.h: profiles, messages and checkpoints know it
// from then on.
#pragma once

#include <variant>

#include "libevo/control/gait_training.h"
#include "libevo/control/ppo_training.h"
#include "libevo/control/sequence_training.h"

namespace evo {

using Method = std::variant<PpoTraining<PolicyPasses>, GaitTraining, SequenceTraining,
                            PpoTraining<ModularPasses>>;

Abilities abilities(Algorithm algorithm);
// The first method that has an ability, by its word.
std::string algorithm_that(bool Abilities::*can);

// The method that settings.algorithm names, ready to begin.
Method make_method(const TrainingJob& job);

}  // namespace evo
