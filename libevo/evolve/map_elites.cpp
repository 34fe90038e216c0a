#include "libevo/evolve/map_elites.h"

#include <utility>

namespace evo {

MapElites::MapElites(const EvolutionSettings& settings)
    : settings_(settings), archive_(settings.axes) {}

Proposal MapElites::propose(int number, std::span<const Body> /*pending*/,
                            std::set<std::string>& seen) {
  if (number < settings_.pop || elites_.empty())
    return {
        sample_new(settings_.rows, settings_.cols, default_weights, settings_.seed, number, seen)};
  std::vector<Body> parents;
  std::vector<std::string> ids;
  for (const auto& [cell, robot] : elites_) {
    parents.push_back(robot.body);
    ids.push_back(robot.id);
  }
  Child child = breed_new(parents, settings_.breeding, settings_.seed, number, seen);
  Proposal proposal{std::move(child.body), MadeBy::mutation};
  for (const std::size_t parent : child.parents) proposal.parents.push_back(ids[parent]);
  return proposal;
}

void MapElites::tell(const ScoredRobot& robot) {
  ++told_;
  file(robot);
}

void MapElites::file(const ScoredRobot& robot) {
  if (archive_.add(0, robot.features, robot.fitness))
    elites_.insert_or_assign(*archive_.cell(robot.features), robot);
}

MethodState MapElites::save() const {
  MethodState state;
  state.told = told_;
  for (const auto& [cell, robot] : elites_) state.members.push_back(robot);
  return state;
}

void MapElites::load(MethodState state) {
  archive_ = GridArchive(settings_.axes);
  elites_.clear();
  told_ = state.told;
  for (const ScoredRobot& robot : state.members) file(robot);
}

}  // namespace evo
