#include "libevo/evolve/genome.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace evo {
namespace {

auto node_place(const Genome& genome, int node) {
  return std::lower_bound(genome.nodes.begin(), genome.nodes.end(), node,
                          [](const NodeGene& gene, int key) { return gene.key < key; });
}

auto connection_place(const Genome& genome, int in, int out) {
  return std::lower_bound(genome.connections.begin(), genome.connections.end(), std::pair{in, out},
                          [](const ConnectionGene& gene, const std::pair<int, int>& ends) {
                            return gene.ends() < ends;
                          });
}

std::optional<std::string> node_defect(const Genome& genome, int outputs) {
  for (std::size_t i = 0; i < genome.nodes.size(); ++i) {
    const NodeGene& node = genome.nodes[i];
    if (node.key < 0) return fmt::format("node {} has the key of an input", node.key);
    if (i > 0 && node.key <= genome.nodes[i - 1].key)
      return fmt::format("node {} is out of order or there twice", node.key);
    if (!std::isfinite(node.bias) || !std::isfinite(node.response))
      return fmt::format("node {} has a bias or response that is not finite", node.key);
  }
  for (int output = 0; output < outputs; ++output)
    if (find(genome, output) == nullptr) return fmt::format("output node {} is missing", output);
  return {};
}

std::optional<std::string> connection_defect(const Genome& genome, int inputs) {
  for (std::size_t i = 0; i < genome.connections.size(); ++i) {
    const ConnectionGene& gene = genome.connections[i];
    const std::string label = fmt::format("connection {} -> {}", gene.in, gene.out);
    if (i > 0 && gene.ends() <= genome.connections[i - 1].ends())
      return label + " is out of order or there twice";
    if (gene.in < -inputs || (gene.in >= 0 && find(genome, gene.in) == nullptr))
      return label +
             fmt::format(" starts nowhere: neither an input (-1 to -{}) nor a node", inputs);
    if (find(genome, gene.out) == nullptr) return label + " ends nowhere: not a node";
    if (!std::isfinite(gene.weight)) return label + " has a weight that is not finite";
  }
  return {};
}

// Kahn's algorithm: what is left after taking away nodes without incoming
// connections, again and again, lies on or behind a cycle.
bool has_cycle(const Genome& genome) {
  std::map<int, int> incoming;
  std::multimap<int, int> outgoing;
  for (const NodeGene& node : genome.nodes) incoming[node.key] = 0;
  for (const ConnectionGene& gene : genome.connections)
    if (gene.in >= 0) {
      ++incoming[gene.out];
      outgoing.emplace(gene.in, gene.out);
    }
  std::vector<int> free;
  for (const auto& [node, count] : incoming)
    if (count == 0) free.push_back(node);
  std::size_t sorted = 0;
  while (!free.empty()) {
    const int node = free.back();
    free.pop_back();
    ++sorted;
    for (auto [at, end] = outgoing.equal_range(node); at != end; ++at)
      if (--incoming[at->second] == 0) free.push_back(at->second);
  }
  return sorted < genome.nodes.size();
}

}  // namespace

const NodeGene* find(const Genome& genome, int node) {
  const auto place = node_place(genome, node);
  return place != genome.nodes.end() && place->key == node ? &*place : nullptr;
}

const ConnectionGene* find(const Genome& genome, int in, int out) {
  const auto place = connection_place(genome, in, out);
  return place != genome.connections.end() && place->ends() == std::pair{in, out} ? &*place
                                                                                  : nullptr;
}

void insert(Genome& genome, const NodeGene& gene) {
  genome.nodes.insert(node_place(genome, gene.key), gene);
}

void insert(Genome& genome, const ConnectionGene& gene) {
  genome.connections.insert(connection_place(genome, gene.in, gene.out), gene);
}

bool closes_cycle(const Genome& genome, int in, int out) {
  // Is `in` downstream of `out`? Genes ascend by source, so those that leave a
  // node lie together.
  std::set<int> reached{out};
  std::vector<int> frontier{out};
  while (!frontier.empty()) {
    const int node = frontier.back();
    frontier.pop_back();
    if (node == in) return true;
    constexpr int before_all_nodes = 0;  // no connection ends at an input
    for (auto gene = connection_place(genome, node, before_all_nodes);
         gene != genome.connections.end() && gene->in == node; ++gene)
      if (reached.insert(gene->out).second) frontier.push_back(gene->out);
  }
  return false;
}

std::optional<std::string> defect(const Genome& genome, int inputs, int outputs) {
  if (auto found = node_defect(genome, outputs)) return found;
  if (auto found = connection_defect(genome, inputs)) return found;
  if (has_cycle(genome)) return "the connections form a cycle: not a feed-forward network";
  return {};
}

}  // namespace evo
