#include "libevo/evolve/cppn_neat.h"

#include <algorithm>
#include <utility>

#include "libevo/base/error.h"
#include "libevo/evolve/cppn.h"

namespace evo {
namespace {

void check_ports(const NeatSettings& settings) {
  const bool paints =
      settings.num_outputs == cppn_outputs || settings.num_outputs == cppn_outputs + 1;
  if (settings.num_inputs != cppn_inputs || !paints)
    throw error(Failure::usage,
                "num_inputs is {} and num_outputs {}: the network of a robot has {} and {}, or one "
                "more for its stiffness",
                settings.num_inputs, settings.num_outputs, cppn_inputs, cppn_outputs);
}

// A new valid body registers its id as it passes.
Accept new_robot(int rows, int cols, int outputs, std::set<std::string>& seen) {
  return [rows, cols, outputs, &seen](const Genome& genome) {
    const Body body = decode(genome, rows, cols, outputs);
    return is_valid_robot(body) && seen.insert(identity(body)).second;
  };
}

std::vector<CppnRobot> with_bodies(std::vector<Individual> population, int rows, int cols,
                                   int outputs) {
  std::vector<CppnRobot> robots;
  for (Individual& individual : population) {
    Body body = decode(individual.genome, rows, cols, outputs);
    robots.push_back(
        {std::move(individual.genome), std::move(body), std::move(individual.parents)});
  }
  return robots;
}

}  // namespace

std::vector<CppnRobot> first_robots(const NeatSettings& settings, int rows, int cols,
                                    std::set<std::string>& seen, NeatState& state,
                                    std::uint64_t seed) {
  check_ports(settings);
  const int outputs = settings.num_outputs;
  return with_bodies(first_generation(settings, new_robot(rows, cols, outputs, seen), state, seed),
                     rows, cols, outputs);
}

std::vector<CppnRobot> next_robots(const NeatSettings& settings, int rows, int cols,
                                   std::span<const Scored> scored, std::set<std::string>& seen,
                                   NeatState& state, std::uint64_t seed) {
  check_ports(settings);
  const int outputs = settings.num_outputs;
  return with_bodies(
      next_generation(settings, scored, new_robot(rows, cols, outputs, seen), state, seed), rows,
      cols, outputs);
}

}  // namespace evo
