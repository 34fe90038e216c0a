// What every method of evolution is: it proposes robots from the scores told so far. With
// the state it saves, and no more, it goes on as if it had never stopped.
//
// Robot k of a run is proposed from exactly the scores of robots 0 .. k - window - 1
// (known_scores), so that a run is the same on one core and on a thousand, in whatever
// order its trainings end. Pipelines with generations compose the same operators from the
// tools evo-sample, evo-mutate, evo-neat, evo-suggest and evo-archive.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "libevo/body/body.h"
#include "libevo/evolve/archive.h"
#include "libevo/evolve/breeding.h"
#include "libevo/evolve/gp.h"
#include "libevo/evolve/neat.h"

namespace evo {

// What decides a run's robots; every method takes what concerns it.
struct EvolutionSettings {
  int pop = 25;     // robots of the first population, and of a generation
  int evals = 250;  // robots of the run
  int rows = 5;     // of bodies, voxels
  int cols = 5;
  std::uint64_t seed = 0;
  Breeding breeding;              // ga, map
  NeatSettings neat;              // neat
  std::vector<FeatureAxis> axes;  // map
};

struct ScoredRobot {
  std::string id;  // identity(body)
  Body body;
  double fitness = 0.0;          // not a number: its training failed
  std::optional<Genome> genome;  // neat
  std::vector<double> features;  // map: its place on each axis
};

// The operator that made a body; random numbers are from a stream of its own.
enum class MadeBy { sampling, mutation, neat, suggestion };

struct Proposal {
  Body body;
  MadeBy made_by = MadeBy::sampling;
  std::vector<std::string> parents = {};  // ids
  std::optional<Genome> genome = {};
};

// What a method keeps of what it was told.
struct MethodState {
  int told = 0;  // scores
  // ga: the best scored, best first; neat: the population, oldest first; map: the elites.
  std::vector<ScoredRobot> members;
  NeatState species;                       // neat
  std::optional<GpParameters> parameters;  // bo: fitted to the first `fitted` scores
  int fitted = 0;
};

// libevo/evolve/methods.h lists them all; the list is the only place that has to know of a
// new one.
template <typename T>
concept EvolutionMethod = std::movable<T> && std::constructible_from<T, const EvolutionSettings&> &&
    requires(T method, const T& constant, const ScoredRobot& robot, std::span<const Body> pending,
             std::set<std::string>& seen, MethodState state) {
  // As run.yaml has it.
  { T::name } -> std::convertible_to<const char*>;
  // Whether a state is not all: after load() it has to be told all scores again.
  { T::told_again } -> std::convertible_to<bool>;
  // Whether it proposes without regard to what founders are: these may then come from
  // elsewhere, such as another run.
  { T::any_founders } -> std::convertible_to<bool>;
  // Robot `number`, whose id is not in `seen` and joins it. `pending`, given to methods that
  // are told again, are the robots proposed and not scored yet. Throws Error(work) when no
  // new body is found.
  { method.propose(0, pending, seen) } -> std::same_as<Proposal>;
  // The next score, in the order of the robots' numbers.
  method.tell(robot);
  { constant.save() } -> std::same_as<MethodState>;
  method.load(state);
};

}  // namespace evo
