// Rollouts in HDF5 (docs/formats/rollout.md): what happened in episodes, with
// enough of the world to draw it without simulating.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/io/hdf5.h"
#include "formats/robot/robot.h"
#include "libevo/sim/model.h"

namespace evo {

struct RolloutEpisode {
  std::uint64_t seed = 0;
  Json random_draws = Json::object();
  double jitter = 0.0;            // by which the start was perturbed, voxels
  std::uint64_t jitter_seed = 0;  // and how: VecEnv's EpisodeStart
  // Row-major; T steps, T+1 observations and positions.
  std::vector<double> observations;        // [T+1 x D]
  std::vector<double> actions;             // [T x A], targets in [0.6, 1.6]
  std::vector<double> rewards;             // [T]
  std::vector<std::uint8_t> terminations;  // [T]
  std::vector<std::uint8_t> truncations;   // [T]
  std::vector<Vec2> positions;             // [T+1 x N], raw units, world order
  int steps() const { return static_cast<int>(rewards.size()); }
};

// Which points make which cells of which object. Absent (no cells) in files of
// other makers.
struct RolloutWorld {
  std::vector<ModelObject> objects;
  std::vector<ModelCell> cells;
};

struct Rollout {
  std::string task;          // name
  std::string task_yaml;     // the whole task, as read
  std::string physics_yaml;  // the whole profile in force
  std::optional<Robot> robot;
  std::uint64_t seed = 0;
  std::string created_by;  // tool, version, commit
  int observation_length = 0;
  int action_length = 0;
  int points = 0;
  RolloutWorld world;
  std::vector<RolloutEpisode> episodes;
};

// Written under a temporary name, then renamed. Throws Error(cannot_create, io).
void write_rollout(const std::filesystem::path& path, const Rollout& rollout);
// Its k-th episode as the group /episode_<id>, whose name is returned; flags are numbers in
// rollouts, as the benchmark has them, and booleans of h5py in datasets.
enum class FlagType { number, boolean };
std::string write_episode(hdf5::Writer& file, const Rollout& rollout, std::size_t k, std::size_t id,
                          FlagType type);
// Whatever is absent in files of other makers stays empty (flags: zero), but
// rewards, which count the steps. Throws Error(no_input) or Error(data) naming
// file and dataset.
Rollout read_rollout(const std::filesystem::path& path);

// Actions in any of the forms of docs/formats/foreign.md, [T x A] row-major; "-" is standard input.
// Throws Error(no_input, io, data).
struct ActionSequence {
  int steps = 0;
  int actuators = 0;
  std::vector<double> values;
  bool is_single = false;  // of float32, in which the benchmark then clips them
};
ActionSequence read_actions(const std::filesystem::path& path);
// What the task drew in the first episode of a rollout, an object.
Json read_draws(const std::filesystem::path& path);

}  // namespace evo
