// Minari dataset folders (Farama Foundation, dataset standard 0.5): rollouts for
// offline learning with Python tools. <folder>/data/main_data.hdf5 holds the
// episodes, <folder>/data/metadata.json what they have in common. Minari finds
// datasets by id: put the folder at $MINARI_DATASETS_PATH/<id>.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/rollout/rollout.h"

namespace evo {

// "evo/<task>/rollouts-v0", with signs that ids cannot have replaced by "_".
std::string minari_dataset_id(const Rollout& rollout);

// All episodes of the rollouts, one after another, in a new folder that appears
// whole or not at all. Each keeps its robot (JSON), its random draws and how its start was
// perturbed as attributes, point positions as infos. The bounds of actions are those of
// the physics. The rollouts have the same observation and action lengths. Throws Error(data) for
// rollouts that do not fit together or are incomplete, Error(usage) for an id Minari would not take
// ("(namespace/)name-v<number>"), Error(cannot_create) if the folder exists.
void write_minari(const std::filesystem::path& folder, const std::vector<Rollout>& rollouts,
                  const std::string& dataset_id);

}  // namespace evo
