// Policies and checkpoints in HDF5 (docs/formats/policy.md): a trained
// controller with everything that decided it. No clock, no host name: the same
// training is the same file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/io/files.h"
#include "formats/robot/robot.h"
#include "formats/training/identity.h"
#include "libevo/control/trainer.h"
#include "libevo/task/env.h"
#include "libevo/task/spec.h"

namespace evo {

struct PolicyFile {
  Robot robot;
  // All robots that share the controller, each with its fitness (`robot` is the best); empty: it
  // is for `robot` alone.
  std::vector<Robot> robots;
  std::string task;           // name
  std::string task_yaml;      // the whole task; empty: see policy_task
  std::string physics_yaml;   // the whole profile in force
  std::string training_yaml;  // the whole profile in force
  std::vector<ObservationSlice> layout;
  std::uint64_t seed = 0;
  std::string isa = "any";    // instruction set the bits belong to; "any": to all of them
  std::string created_by;     // tool, version, commit
  std::string identity;       // formats/training/identity.h
  std::string settings_hash;  // of it

  TrainedController controller;
  double fitness = 0.0;  // best evaluation; of several robots the mean
  std::int64_t best_step = 0;
  std::int64_t steps = 0;  // environment steps of training
  std::vector<CurvePoint> curve;
  std::optional<FinalScore> final_score;
};

// What there is to write after a training that succeeded (result.controller is
// set). `robot` is stored as it is.
PolicyFile make_policy_file(const Robot& robot, const Arena& arena,
                            const TrainingSettings& settings, std::uint64_t seed,
                            const TrainResult& result, const std::string& created_by,
                            const TrainingOrigin& origin = {});

// Appears whole or not at all. Throws Error(cannot_create, io).
void write_policy(const std::filesystem::path& path, const PolicyFile& policy,
                  Existing existing = Existing::replaced);
// Throws Error(no_input), or Error(data) naming file and HDF5 path.
PolicyFile read_policy(const std::filesystem::path& path);
// The task that it was trained on. Throws Error(data), beginning with `where`, if that is of
// a program's own environments (evo_learner_policy in evo/evo.h), named in the file.
TaskSpec policy_task(const PolicyFile& policy, const std::string& where);
// Only the lines of its identity, to see whether the work is done already.
std::string read_policy_identity(const std::filesystem::path& path);

// The lines of a checkpoint's identity.
std::string read_checkpoint_identity(const std::filesystem::path& path);
// A training to continue, `<id>.checkpoint.h5`, marked with its identity.
// Reading throws Error(no_input, data), and Error(cannot_create) where the
// checkpoint is of another training, saying what differs.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint,
                      const TrainingIdentity& training);
Checkpoint read_checkpoint(const std::filesystem::path& path, const TrainingIdentity& training);

}  // namespace evo
