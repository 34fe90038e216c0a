// Policies and checkpoints in HDF5 (spec: formats, "Policy"): a trained
// controller with everything that decided it. No clock, no host name: the same
// training is the same file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/files.h"
#include "formats/robot.h"
#include "libevo/control/trainer.h"
#include "libevo/task/env.h"

namespace evo {

struct PolicyFile {
  Robot robot;
  std::string task;           // name
  std::string task_yaml;      // the whole task
  std::string physics_yaml;   // the whole profile in force
  std::string training_yaml;  // the whole profile in force
  std::vector<ObservationSlice> layout;
  std::uint64_t seed = 0;
  std::string isa = "any";  // instruction set the bits belong to; "any": to all of them
  std::string created_by;   // tool and version
  std::string settings_hash;

  Controller controller;  // a Policy or a SineController
  double fitness = 0.0;   // best evaluation
  std::int64_t best_step = 0;
  std::int64_t steps = 0;  // environment steps of training
  std::vector<CurvePoint> curve;
  std::optional<FinalScore> final_score;
};

// SHA-256, in hex, of all that decides a training's result: robot, task,
// physics, training settings (steps included) and seed.
std::string settings_hash(const Body& robot, const TaskSpec& task, const TrainingSettings& settings,
                          std::uint64_t seed);

// What there is to write after a training that succeeded (result.controller is
// set). `robot` is stored as it is.
PolicyFile make_policy_file(const Robot& robot, const Arena& arena,
                            const TrainingSettings& settings, std::uint64_t seed,
                            const TrainResult& result, const std::string& created_by);

// Appears whole or not at all. Throws Error(cannot_create, io).
void write_policy(const std::filesystem::path& path, const PolicyFile& policy,
                  Existing existing = Existing::replaced);
// Throws Error(no_input), or Error(data) naming file and HDF5 path.
PolicyFile read_policy(const std::filesystem::path& path);
// Only the settings hash, to see whether the work is done already.
std::string read_policy_hash(const std::filesystem::path& path);

// A training to go on with, `<id>.checkpoint.h5`, marked with the hash of its
// settings. Reading throws Error(no_input, data), and Error(cannot_create) where
// the checkpoint belongs to other settings than `settings_hash`.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint,
                      const std::string& settings_hash);
Checkpoint read_checkpoint(const std::filesystem::path& path, const std::string& settings_hash);

}  // namespace evo
