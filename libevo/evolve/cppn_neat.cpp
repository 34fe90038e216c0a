#include "libevo/evolve/cppn_neat.h"

#include <algorithm>
#include <utility>

#include "libevo/base/error.h"
#include "libevo/evolve/cppn.h"

namespace evo {
namespace {

void check_ports(const NeatSettings& settings) {
  if (settings.num_inputs != cppn_inputs || settings.num_outputs != cppn_outputs)
    throw error(Failure::usage,
                "num_inputs is {} and num_outputs {}: the network of a robot has {} and {}",
                settings.num_inputs, settings.num_outputs, cppn_inputs, cppn_outputs);
}

// A new valid body registers its id as it passes.
Accept new_robot(int rows, int cols, std::set<std::string>& seen) {
  return [rows, cols, &seen](const Genome& genome) {
    const Body body = decode(genome, rows, cols);
    return is_valid_robot(body) && seen.insert(identity(body)).second;
  };
}

CppnRobot with_body(Individual individual, int rows, int cols) {
  Body body = decode(individual.genome, rows, cols);
  return {std::move(individual.genome), std::move(body), std::move(individual.parents)};
}

std::vector<CppnRobot> with_bodies(std::vector<Individual> population, int rows, int cols) {
  std::vector<CppnRobot> robots;
  for (Individual& individual : population)
    robots.push_back(with_body(std::move(individual), rows, cols));
  return robots;
}

}  // namespace

std::vector<CppnRobot> first_robots(const NeatSettings& settings, int rows, int cols,
                                    std::set<std::string>& seen, NeatState& state,
                                    std::uint64_t seed) {
  check_ports(settings);
  return with_bodies(first_generation(settings, new_robot(rows, cols, seen), state, seed), rows,
                     cols);
}

std::vector<CppnRobot> next_robots(const NeatSettings& settings, int rows, int cols,
                                   std::span<const Scored> scored, std::set<std::string>& seen,
                                   NeatState& state, std::uint64_t seed) {
  check_ports(settings);
  return with_bodies(next_generation(settings, scored, new_robot(rows, cols, seen), state, seed),
                     rows, cols);
}

// ---- the method ---------------------------------------------------------------------

namespace {

Scored scored(const ScoredRobot& robot) {
  if (!robot.genome) throw error(Failure::data, "robot {} has no genome", robot.id);
  return {*robot.genome, robot.fitness};
}

std::vector<Scored> scored(const std::vector<ScoredRobot>& robots) {
  std::vector<Scored> population;
  for (const ScoredRobot& robot : robots) population.push_back(scored(robot));
  return population;
}

}  // namespace

CppnNeat::CppnNeat(const EvolutionSettings& settings) : settings_(settings) {
  check_ports(settings.neat);
}

Proposal CppnNeat::propose(int number, std::span<const Body> /*pending*/,
                           std::set<std::string>& seen) {
  const bool is_first = number < settings_.pop;
  const std::vector<Scored> population = is_first ? std::vector<Scored>{} : scored(members_);
  const CppnRobot made = with_body(
      next_individual(settings_.neat, population, new_robot(settings_.rows, settings_.cols, seen),
                      species_, number, settings_.seed),
      settings_.rows, settings_.cols);
  Proposal proposal{made.body, MadeBy::neat, {}, made.genome};
  for (const int key : made.parents)
    for (const ScoredRobot& member : members_)
      if (member.genome->key == key) proposal.parents.push_back(member.id);
  return proposal;
}

void CppnNeat::tell(const ScoredRobot& robot) {
  ++told_;
  std::vector<Scored> population = scored(members_);
  join(settings_.neat, scored(robot), population, species_);
  members_.push_back(robot);
  std::erase_if(members_, [&](const ScoredRobot& member) {
    return std::none_of(population.begin(), population.end(), [&](const Scored& other) {
      return other.genome.key == member.genome->key;
    });
  });
}

MethodState CppnNeat::save() const {
  MethodState state;
  state.told = told_;
  state.members = members_;
  state.species = species_;
  return state;
}

void CppnNeat::load(MethodState state) {
  for (const ScoredRobot& robot : state.members) scored(robot);  // refuses one without a genome
  members_ = std::move(state.members);
  species_ = std::move(state.species);
  told_ = state.told;
}

}  // namespace evo
