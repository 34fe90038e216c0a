// The environments that a method learns in, and where each of them is in its episodes.
#pragma once

#include <cstdint>
#include <vector>

#include "libevo/control/checkpoint.h"
#include "libevo/task/env.h"

namespace evo {

// Episode k of environment e has its random numbers, draws and jitter from
// (seed, "train", e, k).
struct EpisodeSeeds {
  std::uint64_t stream = 0;  // of the environment
  std::uint64_t episode = 0;
  std::uint64_t jitter = 0;
};

class TrainingEpisodes {
 public:
  TrainingEpisodes(VecEnv environments, std::uint64_t seed);

  // The environment's next episode, which then counts as begun.
  EpisodeSeeds next(int environment);
  // To its start, every coordinate moved by up to `jitter` voxels.
  void reset(int environment, const EpisodeSeeds& seeds, double jitter);

  const std::vector<int>& steps();  // [E] so far; until the next call

  void save(Checkpoint& checkpoint) const;
  void load(const Checkpoint& checkpoint);

  VecEnv env;
  std::vector<std::uint64_t> begun;  // [E] episodes, with the present one
  std::vector<double> returns;       // [E] so far

 private:
  std::uint64_t seed_;
  std::vector<int> steps_;
};

}  // namespace evo
