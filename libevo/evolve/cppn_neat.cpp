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

}  // namespace evo
