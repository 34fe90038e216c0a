// What NEAT does to genomes: creation, mutation, crossover, distance; and the
// settings of the whole method (docs/methods.md, "Settings"). Names follow
// neat-python's configuration, values the benchmark's file; what that leaves
// open has the library's default.
#pragma once

#include <array>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/evolve/genome.h"

namespace evo {

// How a number of a gene starts and mutates. One uniform draw u decides a
// mutation: u < mutate_rate adds Gaussian(0, mutate_power); u < mutate_rate +
// replace_rate draws anew; else it stays. Values are clamped to [min, max].
struct AttributeSettings {
  double init_mean = 0.0;
  double init_stdev = 1.0;
  double replace_rate = 0.0;
  double mutate_rate = 0.0;
  double mutate_power = 0.0;
  double min = -30.0;
  double max = 30.0;
  bool operator==(const AttributeSettings&) const = default;
};

// Which connections a new genome is given: a random share of the candidates,
// which are every input with every hidden node, every hidden node with every
// output and, when direct or without hidden nodes, every input with every output.
struct InitialConnection {
  bool direct = true;
  double fraction = 0.5;  // 0 is neat-python's "unconnected", 1 its "full"
  bool operator==(const InitialConnection&) const = default;
};

enum class Statistic : std::uint8_t { mean, min, max, median };
constexpr auto words_for(Statistic) { return std::array{"mean", "min", "max", "median"}; }

struct NeatSettings {  // NOLINT(clang-analyzer-optin.performance.Padding): in reading order
  // Run
  Statistic fitness_criterion = Statistic::max;
  double fitness_threshold = 0.0;
  bool no_fitness_termination = true;  // then the two above are unused
  int pop_size = 50;
  bool reset_on_extinction = true;  // start afresh when every species is stagnant

  // Genome
  int num_inputs = 3;
  int num_hidden = 1;
  int num_outputs = 5;
  InitialConnection initial_connection;
  double compatibility_disjoint_coefficient = 1.0;
  double compatibility_weight_coefficient = 0.6;
  double conn_add_prob = 0.2;
  double conn_delete_prob = 0.2;
  double node_add_prob = 0.2;
  double node_delete_prob = 0.2;

  // Nodes
  AttributeSettings bias{.replace_rate = 0.1, .mutate_rate = 0.7, .mutate_power = 0.5};
  AttributeSettings response{.init_mean = 1.0, .init_stdev = 0.0};
  Activation activation_default = Activation::sigmoid;
  std::vector<Activation> activation_options{Activation::sigmoid};
  double activation_mutate_rate = 0.0;
  Aggregation aggregation_default = Aggregation::sum;
  std::vector<Aggregation> aggregation_options{Aggregation::sum};
  double aggregation_mutate_rate = 0.0;

  // Connections
  AttributeSettings weight{.replace_rate = 0.1, .mutate_rate = 0.8, .mutate_power = 0.5};
  bool enabled_default = true;
  double enabled_mutate_rate = 0.01;  // the flag becomes a fair coin

  // Species
  double compatibility_threshold = 3.0;
  Statistic species_fitness_func = Statistic::mean;
  int max_stagnation = 15;          // generations without a better species fitness
  int species_elitism = 0;          // so many best species are never stagnant
  int elitism = 0;                  // so many best members of a species stay unchanged
  double survival_threshold = 0.2;  // share of a species that may be parents, at least 2
  int min_species_size = 2;

  bool operator==(const NeatSettings&) const = default;
};

// What is wrong with settings each of which is within its range (formats/run/neat.cpp), or nothing.
std::optional<std::string> defect(const NeatSettings& settings);

// A new genome: output nodes, hidden nodes with the next keys of the run, and
// the initial connections (their number rounded half to even).
Genome fresh_genome(const NeatSettings& settings, int key, int& next_node_key, Stream& stream);

// Structural mutations, each with its probability, then every attribute of every
// connection and node. Nodes that split a connection take the next keys of the run.
void mutate(Genome& genome, const NeatSettings& settings, int& next_node_key, Stream& stream);

// A child of the fitter parent: its genes, every attribute of a matching one
// from either parent with probability 1/2.
Genome crossover(const Genome& fitter, const Genome& other, int key, Stream& stream);

// Compatibility distance: node part plus connection part, each (sum over
// matching genes of weight coefficient * difference + disjoint coefficient *
// number of other genes) / larger number of genes.
double distance(const Genome& a, const Genome& b, const NeatSettings& settings);

}  // namespace evo
