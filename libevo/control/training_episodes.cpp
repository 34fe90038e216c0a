#include "libevo/control/training_episodes.h"

#include <utility>

#include "libevo/base/random.h"

namespace evo {

TrainingEpisodes::TrainingEpisodes(VecEnv environments, std::uint64_t seed)
    : env(std::move(environments)),
      begun(static_cast<std::size_t>(env.environments()), 0),
      returns(begun.size(), 0.0),
      seed_(seed) {}

EpisodeSeeds TrainingEpisodes::next(int environment) {
  const auto e = static_cast<std::size_t>(environment);
  const std::uint64_t stream = derive_seed(seed_, "train", e);
  const std::uint64_t k = begun[e]++;
  return {stream, k, derive_seed(stream, "jitter", k)};
}

void TrainingEpisodes::reset(int environment, const EpisodeSeeds& seeds, double jitter) {
  env.reset(environment,
            {env.arena(environment).draw(seeds.stream, seeds.episode), jitter, seeds.jitter});
  returns[static_cast<std::size_t>(environment)] = 0.0;
}

const std::vector<int>& TrainingEpisodes::steps() {
  steps_.clear();
  for (int e = 0; e < env.environments(); ++e) steps_.push_back(env.steps(e));
  return steps_;
}

void TrainingEpisodes::save(Checkpoint& checkpoint) const {
  checkpoint.put("environments/state", env.save());
  checkpoint.put("environments/next_episode", begun);
  checkpoint.put("environments/episode_return", returns);
}

void TrainingEpisodes::load(const Checkpoint& checkpoint) {
  env.load(checkpoint.get<std::uint8_t>("environments/state"));
  begun = checkpoint.get<std::uint64_t>("environments/next_episode", begun.size());
  returns = checkpoint.get<double>("environments/episode_return", returns.size());
}

}  // namespace evo
