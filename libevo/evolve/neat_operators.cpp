#include "libevo/evolve/neat_operators.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace evo {
namespace {

bool coin(Stream& stream, double probability) { return stream.uniform() < probability; }

template <typename T>
const T& choose(const std::vector<T>& options, Stream& stream) {
  return options[stream.below(static_cast<std::uint32_t>(options.size()))];
}

template <typename T>
void shuffle(std::vector<T>& items, Stream& stream) {
  for (std::size_t n = items.size(); n > 1; --n)
    std::swap(items[n - 1], items[stream.below(static_cast<std::uint32_t>(n))]);
}

// ---- attributes ----------------------------------------------------------------

double initial(const AttributeSettings& s, Stream& stream) {
  return std::clamp(s.init_mean + s.init_stdev * stream.gaussian(), s.min, s.max);
}

double mutated(double value, const AttributeSettings& s, Stream& stream) {
  const double u = stream.uniform();
  if (u < s.mutate_rate)
    return std::clamp(value + s.mutate_power * stream.gaussian(), s.min, s.max);
  if (u < s.mutate_rate + s.replace_rate) return initial(s, stream);
  return value;
}

NodeGene new_node(int key, const NeatSettings& settings, Stream& stream) {
  return {key, initial(settings.bias, stream), initial(settings.response, stream),
          settings.activation_default, settings.aggregation_default};
}

void mutate_attributes(Genome& genome, const NeatSettings& s, Stream& stream) {
  for (ConnectionGene& gene : genome.connections) {
    gene.weight = mutated(gene.weight, s.weight, stream);
    if (coin(stream, s.enabled_mutate_rate)) gene.enabled = coin(stream, 0.5);
  }
  for (NodeGene& gene : genome.nodes) {
    gene.bias = mutated(gene.bias, s.bias, stream);
    gene.response = mutated(gene.response, s.response, stream);
    if (coin(stream, s.activation_mutate_rate))
      gene.activation = choose(s.activation_options, stream);
    if (coin(stream, s.aggregation_mutate_rate))
      gene.aggregation = choose(s.aggregation_options, stream);
  }
}

// ---- structure -----------------------------------------------------------------

bool is_output(int key, const NeatSettings& settings) {
  return key >= 0 && key < settings.num_outputs;
}

void add_connection(Genome& genome, const NeatSettings& settings, Stream& stream) {
  std::vector<int> keys;
  for (const NodeGene& node : genome.nodes) keys.push_back(node.key);
  const int out = choose(keys, stream);
  for (int input = 1; input <= settings.num_inputs; ++input) keys.push_back(-input);
  const int in = choose(keys, stream);

  if (find(genome, in, out) != nullptr) return;
  if (is_output(in, settings) && is_output(out, settings)) return;
  if (closes_cycle(genome, in, out)) return;
  insert(genome,
         ConnectionGene{in, out, initial(settings.weight, stream), settings.enabled_default});
}

// Splits a connection: the old one is disabled, the new pair does roughly what
// it did.
void add_node(Genome& genome, const NeatSettings& settings, int& next_node_key, Stream& stream) {
  if (genome.connections.empty()) return;
  const auto n = static_cast<std::uint32_t>(genome.connections.size());
  ConnectionGene& gene = genome.connections[stream.below(n)];
  gene.enabled = false;
  const ConnectionGene split = gene;  // inserting moves genes
  const int key = next_node_key++;
  insert(genome, new_node(key, settings, stream));
  insert(genome, ConnectionGene{split.in, key, 1.0, true});
  insert(genome, ConnectionGene{key, split.out, split.weight, true});
}

void delete_node(Genome& genome, const NeatSettings& settings, Stream& stream) {
  std::vector<int> hidden;
  for (const NodeGene& node : genome.nodes)
    if (!is_output(node.key, settings)) hidden.push_back(node.key);
  if (hidden.empty()) return;
  const int key = choose(hidden, stream);
  std::erase_if(genome.nodes, [&](const NodeGene& gene) { return gene.key == key; });
  std::erase_if(genome.connections,
                [&](const ConnectionGene& gene) { return gene.in == key || gene.out == key; });
}

void delete_connection(Genome& genome, Stream& stream) {
  if (genome.connections.empty()) return;
  const auto n = static_cast<std::uint32_t>(genome.connections.size());
  genome.connections.erase(genome.connections.begin() + stream.below(n));
}

void mutate_structure(Genome& genome, const NeatSettings& s, int& next_node_key, Stream& stream) {
  if (coin(stream, s.node_add_prob)) add_node(genome, s, next_node_key, stream);
  if (coin(stream, s.node_delete_prob)) delete_node(genome, s, stream);
  if (coin(stream, s.conn_add_prob)) add_connection(genome, s, stream);
  if (coin(stream, s.conn_delete_prob)) delete_connection(genome, stream);
}

std::vector<std::pair<int, int>> candidate_connections(const Genome& genome,
                                                       const NeatSettings& settings) {
  std::vector<int> inputs;
  for (int k = 1; k <= settings.num_inputs; ++k) inputs.push_back(-k);
  std::vector<int> hidden;
  std::vector<int> outputs;
  for (const NodeGene& node : genome.nodes)
    (is_output(node.key, settings) ? outputs : hidden).push_back(node.key);

  std::vector<std::pair<int, int>> candidates;
  const auto join = [&](const std::vector<int>& sources, const std::vector<int>& targets) {
    for (const int source : sources)
      for (const int target : targets) candidates.emplace_back(source, target);
  };
  join(inputs, hidden);
  join(hidden, outputs);
  if (settings.initial_connection.direct || hidden.empty()) join(inputs, outputs);
  return candidates;
}

// ---- distance ------------------------------------------------------------------

double difference(const NodeGene& a, const NodeGene& b) {
  return std::fabs(a.bias - b.bias) + std::fabs(a.response - b.response) +
         (a.activation != b.activation ? 1.0 : 0.0) + (a.aggregation != b.aggregation ? 1.0 : 0.0);
}
double difference(const ConnectionGene& a, const ConnectionGene& b) {
  return std::fabs(a.weight - b.weight) + (a.enabled != b.enabled ? 1.0 : 0.0);
}

int match_key(const NodeGene& gene) { return gene.key; }
std::pair<int, int> match_key(const ConnectionGene& gene) { return gene.ends(); }

// One part of the distance: a merge of two ascending lists of genes.
template <typename Gene>
double part(const std::vector<Gene>& a, const std::vector<Gene>& b, const NeatSettings& settings) {
  if (a.empty() && b.empty()) return 0.0;
  double matching = 0.0;
  std::size_t disjoint = 0;
  auto at_a = a.begin();
  auto at_b = b.begin();
  while (at_a != a.end() && at_b != b.end()) {
    if (match_key(*at_a) == match_key(*at_b)) {
      matching += settings.compatibility_weight_coefficient * difference(*at_a++, *at_b++);
    } else {
      ++disjoint;
      if (match_key(*at_a) < match_key(*at_b))
        ++at_a;
      else
        ++at_b;
    }
  }
  disjoint += static_cast<std::size_t>((a.end() - at_a) + (b.end() - at_b));
  return (matching + settings.compatibility_disjoint_coefficient * static_cast<double>(disjoint)) /
         static_cast<double>(std::max(a.size(), b.size()));
}

}  // namespace

std::optional<std::string> defect(const NeatSettings& s) {
  const std::pair<const char*, const AttributeSettings*> attributes[] = {
      {"bias", &s.bias}, {"response", &s.response}, {"weight", &s.weight}};
  for (const auto& [name, a] : attributes)
    if (!(a->min <= a->max)) return fmt::format("{}: min {} is above max {}", name, a->min, a->max);
  if (s.pop_size < 2) return fmt::format("pop_size is {}: at least 2 needed", s.pop_size);
  if (s.activation_options.empty()) return "activation_options is empty";
  if (s.aggregation_options.empty()) return "aggregation_options is empty";
  return {};
}

Genome fresh_genome(const NeatSettings& settings, int key, int& next_node_key, Stream& stream) {
  Genome genome;
  genome.key = key;
  for (int output = 0; output < settings.num_outputs; ++output)
    insert(genome, new_node(output, settings, stream));
  for (int k = 0; k < settings.num_hidden; ++k)
    insert(genome, new_node(next_node_key++, settings, stream));

  std::vector<std::pair<int, int>> candidates = candidate_connections(genome, settings);
  shuffle(candidates, stream);
  // nearbyint rounds half to even: 12 of 23 at one half.
  const double share =
      std::nearbyint(static_cast<double>(candidates.size()) * settings.initial_connection.fraction);
  candidates.resize(static_cast<std::size_t>(share));
  for (const auto& [in, out] : candidates)
    insert(genome,
           ConnectionGene{in, out, initial(settings.weight, stream), settings.enabled_default});
  return genome;
}

void mutate(Genome& genome, const NeatSettings& settings, int& next_node_key, Stream& stream) {
  mutate_structure(genome, settings, next_node_key, stream);
  mutate_attributes(genome, settings, stream);
}

Genome crossover(const Genome& fitter, const Genome& other, int key, Stream& stream) {
  Genome child = fitter;
  child.key = key;
  for (ConnectionGene& gene : child.connections)
    if (const ConnectionGene* match = find(other, gene.in, gene.out)) {
      if (coin(stream, 0.5)) gene.weight = match->weight;
      if (coin(stream, 0.5)) gene.enabled = match->enabled;
    }
  for (NodeGene& gene : child.nodes)
    if (const NodeGene* match = find(other, gene.key)) {
      if (coin(stream, 0.5)) gene.bias = match->bias;
      if (coin(stream, 0.5)) gene.response = match->response;
      if (coin(stream, 0.5)) gene.activation = match->activation;
      if (coin(stream, 0.5)) gene.aggregation = match->aggregation;
    }
  return child;
}

double distance(const Genome& a, const Genome& b, const NeatSettings& settings) {
  return part(a.nodes, b.nodes, settings) + part(a.connections, b.connections, settings);
}

}  // namespace evo
