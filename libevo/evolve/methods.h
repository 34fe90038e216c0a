// The methods of evolution by their names. A new one is a class that fulfils
// EvolutionMethod (method.h) and a line here.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "libevo/evolve/bo.h"
#include "libevo/evolve/cppn_neat.h"
#include "libevo/evolve/ga.h"
#include "libevo/evolve/map_elites.h"

namespace evo {

using AnyEvolution = std::variant<GeneticAlgorithm,      // ga
                                  CppnNeat,              // neat
                                  BayesianOptimisation,  // bo
                                  MapElites              // map
                                  >;

std::vector<std::string> evolution_names();

// Throws Error(usage) for a name that there is no method of.
AnyEvolution make_evolution(std::string_view name, const EvolutionSettings& settings);

}  // namespace evo
