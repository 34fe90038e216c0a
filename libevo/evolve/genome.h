// The genome of NEAT: a network as two lists of genes (Stanley and Miikkulainen,
// "Evolving Neural Networks through Augmenting Topologies", Evolutionary
// Computation 10(2), 2002). Genes carry no innovation numbers: nodes match by
// key and connections by their ends (docs/formats/robot.md).
//
// Node keys: -1, -2, .. are the inputs (they have no gene), 0, 1, .. the outputs,
// everything above is hidden.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evo {

enum class Activation : std::uint8_t { sigmoid, tanh, sin, gauss, identity, relu, abs };
enum class Aggregation : std::uint8_t { sum, product };

constexpr auto words_for(Activation) {
  return std::array{"sigmoid", "tanh", "sin", "gauss", "identity", "relu", "abs"};
}
constexpr auto words_for(Aggregation) { return std::array{"sum", "product"}; }

struct NodeGene {
  int key = 0;
  double bias = 0.0;
  double response = 1.0;  // factor on the aggregated input
  Activation activation = Activation::sigmoid;
  Aggregation aggregation = Aggregation::sum;
  bool operator==(const NodeGene&) const = default;
};

struct ConnectionGene {
  int in = 0;   // an input or a node
  int out = 0;  // a node
  double weight = 0.0;
  bool enabled = true;

  std::pair<int, int> ends() const { return {in, out}; }
  bool operator==(const ConnectionGene&) const = default;
};

struct Genome {
  int key = 0;                              // unique within a run
  std::vector<NodeGene> nodes;              // ascending keys
  std::vector<ConnectionGene> connections;  // ascending (in, out)
  bool operator==(const Genome&) const = default;
};

// The gene of that key, or null.
const NodeGene* find(const Genome& genome, int node);
const ConnectionGene* find(const Genome& genome, int in, int out);

// Puts a gene in its place; there must be none of the same key.
void insert(Genome& genome, const NodeGene& gene);
void insert(Genome& genome, const ConnectionGene& gene);

// Whether a connection in -> out would close a cycle with the others, disabled
// ones included; a connection of a node to itself does.
bool closes_cycle(const Genome& genome, int in, int out);

// What keeps the genome from being a feed-forward network of that many inputs
// and outputs, in words: genes out of order or twice, a missing output node, a
// connection from or to nowhere, a value that is not finite, a cycle. Nothing
// when it is sound.
std::optional<std::string> defect(const Genome& genome, int inputs, int outputs);

}  // namespace evo
