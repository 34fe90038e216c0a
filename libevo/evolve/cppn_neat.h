// Robots evolved through their genomes: NEAT over the bodies that CPPNs paint
// (docs/methods.md, "Loop"). A genome passes if its body is a valid robot that
// has not been seen in the whole run.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "libevo/body/body.h"
#include "libevo/evolve/neat.h"

namespace evo {

struct CppnRobot {
  Genome genome;
  Body body;                 // decode(genome, rows, cols)
  std::vector<int> parents;  // genome keys; none if brand new
};

// `settings.pop_size` random robots as generation 0; any settings, among them
// 3 inputs and 5 outputs. `seen` are the ids to avoid; those of the new robots
// are added. Throws like first_generation, Error(usage) for other numbers of
// inputs and outputs.
std::vector<CppnRobot> first_robots(const NeatSettings& settings, int rows, int cols,
                                    std::set<std::string>& seen, NeatState& state,
                                    std::uint64_t seed);

// The next generation; throws like next_generation.
std::vector<CppnRobot> next_robots(const NeatSettings& settings, int rows, int cols,
                                   std::span<const Scored> scored, std::set<std::string>& seen,
                                   NeatState& state, std::uint64_t seed);

}  // namespace evo
