#include "libevo/evolve/ga.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libevo/evolve/select.h"

namespace evo {

Proposal GeneticAlgorithm::propose(int number, std::span<const Body> /*pending*/,
                                   std::set<std::string>& seen) {
  if (number < settings_.pop || best_.empty())
    return {
        sample_new(settings_.rows, settings_.cols, default_weights, settings_.seed, number, seen)};
  const auto share =
      static_cast<std::size_t>(steady_parents(settings_.pop, told_, settings_.evals));
  std::vector<Body> parents;
  for (std::size_t k = 0; k < std::min(share, best_.size()); ++k) parents.push_back(best_[k].body);
  Child child = breed_new(parents, settings_.breeding, settings_.seed, number, seen);
  Proposal proposal{std::move(child.body), MadeBy::mutation};
  for (const std::size_t parent : child.parents) proposal.parents.push_back(best_[parent].id);
  return proposal;
}

// The earlier robot of equals comes first.
void GeneticAlgorithm::tell(const ScoredRobot& robot) {
  ++told_;
  if (std::isnan(robot.fitness)) return;
  const auto after = std::find_if(best_.begin(), best_.end(), [&](const ScoredRobot& other) {
    return other.fitness < robot.fitness;
  });
  best_.insert(after, robot);
  if (best_.size() > static_cast<std::size_t>(settings_.pop)) best_.pop_back();
}

MethodState GeneticAlgorithm::save() const {
  MethodState state;
  state.told = told_;
  state.members = best_;
  return state;
}

void GeneticAlgorithm::load(MethodState state) {
  told_ = state.told;
  best_ = std::move(state.members);
}

}  // namespace evo
