#include "formats/robot/children.h"

#include <utility>

#include "formats/robot/genome.h"
#include "libevo/base/error.h"

namespace evo {

void check(const Breeding& breeding) {
  const MutationSettings& mutation = breeding.mutation;
  for (const auto& [name, p] :
       {std::pair{"--rate", mutation.rate}, std::pair{"--crossover", breeding.crossover}})
    if (!(p >= 0.0 && p <= 1.0))
      throw error(Failure::usage, "{} must be between 0 and 1, got {}", name, p);
  if (!(mutation.stiffness_sigma >= 0.0 && mutation.stiffness_sigma <= 10.0))
    throw error(Failure::usage, "--stiffness-sigma must be between 0 and 10, got {}",
                mutation.stiffness_sigma);
  if (mutation.attempts < 1)
    throw error(Failure::usage, "--attempts must be at least 1, got {}", mutation.attempts);
}

Robot robot_of(Proposal proposal, std::uint64_t seed, int index) {
  Robot robot(std::move(proposal.body));
  if (!proposal.parents.empty()) robot.document["parents"] = proposal.parents;
  robot.document["origin"] = {{"tool", proposal.tool}, {"seed", seed}, {"index", index}};
  if (proposal.genome) robot.document["genome"] = genome_to_json(*proposal.genome);
  return robot;
}

}  // namespace evo
