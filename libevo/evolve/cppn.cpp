#include "libevo/evolve/cppn.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

// To single precision; what is too large becomes infinite.
float single(double x) {
  constexpr double largest = std::numeric_limits<float>::max();
  if (x > largest) return std::numeric_limits<float>::infinity();
  if (x < -largest) return -std::numeric_limits<float>::infinity();
  return static_cast<float>(x);
}

// Slopes as in the libraries that the benchmark uses.
float activate(Activation activation, float z) {
  switch (activation) {
    case Activation::sigmoid:
      return 1.0F / (1.0F + single(math::exp(-5.0F * z)));
    case Activation::tanh:
      return single(math::tanh(2.5F * z));
    case Activation::sin:
      return single(math::sin(z));
    case Activation::gauss:
      return single(math::exp(-5.0F * (z * z)));
    case Activation::identity:
      return z;
    case Activation::relu:
      return std::max(z, 0.0F);
    case Activation::abs:
      return std::fabs(z);
  }
  return z;
}

}  // namespace

CppnNetwork::CppnNetwork(const Genome& genome, int inputs, int outputs)
    : inputs_(static_cast<std::size_t>(inputs)),
      outputs_(static_cast<std::size_t>(outputs)),
      count_(inputs_ + genome.nodes.size()) {
  if (const auto found = defect(genome, inputs, outputs)) throw Error(Failure::data, *found);

  const auto number_of = [&](int key) {
    if (key < 0) return static_cast<std::size_t>(-1 - key);
    return inputs_ + static_cast<std::size_t>(find(genome, key) - genome.nodes.data());
  };
  // Genes ascend by source, hence so do the edges of every node.
  std::vector<std::vector<Edge>> incoming(count_);
  for (const ConnectionGene& gene : genome.connections) {
    const bool from_output = gene.in >= 0 && gene.in < outputs;
    if (gene.enabled && !from_output)
      incoming[number_of(gene.out)].push_back({number_of(gene.in), single(gene.weight)});
  }

  // Depth first from the outputs; a node follows all its sources. The stack is
  // explicit, as a genome from a file may be one long chain.
  enum class Visit : std::uint8_t { no, open, done };
  std::vector<Visit> visits(count_, Visit::no);
  std::fill_n(visits.begin(), inputs_, Visit::done);
  std::vector<std::size_t> stack;
  for (int output = outputs; output-- > 0;) stack.push_back(number_of(output));
  while (!stack.empty()) {
    const std::size_t at = stack.back();
    if (visits[at] == Visit::no) {
      visits[at] = Visit::open;
      for (const Edge& edge : incoming[at])
        if (visits[edge.source] == Visit::no) stack.push_back(edge.source);
      continue;
    }
    stack.pop_back();
    if (visits[at] == Visit::done) continue;
    visits[at] = Visit::done;
    const NodeGene& gene = genome.nodes[at - inputs_];
    order_.push_back({at, edges_.size(), incoming[at].size(), single(gene.bias),
                      single(gene.response), gene.activation, gene.aggregation});
    edges_.insert(edges_.end(), incoming[at].begin(), incoming[at].end());
  }
}

float CppnNetwork::value(const Node& node, const std::vector<float>& values) const {
  if (node.edges == 0) return node.bias;
  const bool is_sum = node.aggregation == Aggregation::sum;
  float total = is_sum ? 0.0F : 1.0F;
  for (std::size_t e = node.first_edge; e < node.first_edge + node.edges; ++e) {
    const float term = edges_[e].weight * values[edges_[e].source];
    total = is_sum ? total + term : total * term;
  }
  return activate(node.activation, node.response * total + node.bias);
}

std::vector<float> CppnNetwork::evaluate(std::span<const float> inputs) const {
  if (inputs.size() != inputs_)
    throw error(Failure::data, "the network has {} inputs, {} values given", inputs_,
                inputs.size());
  std::vector<float> values(count_);
  std::copy(inputs.begin(), inputs.end(), values.begin());
  for (const Node& node : order_) values[node.number] = value(node, values);
  // The outputs have the lowest keys, so they follow the inputs.
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(inputs_);
  return {first, first + static_cast<std::ptrdiff_t>(outputs_)};
}

Body decode(const Genome& genome, int rows, int cols, int outputs) {
  const CppnNetwork network(genome, cppn_inputs, outputs);
  const double middle_row = (rows - 1) / 2.0;
  const double middle_col = (cols - 1) / 2.0;
  std::vector<Voxel> cells;
  std::vector<double> stiffness;
  cells.reserve(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      const double dy = row - middle_row;
      const double dx = col - middle_col;
      const std::vector<float> painted = network.evaluate(std::array{
          static_cast<float>(row), static_cast<float>(col), single(math::sqrt(dy * dy + dx * dx))});
      const auto first = painted.begin();
      cells.push_back(static_cast<Voxel>(std::max_element(first, first + cppn_outputs) - first));
      if (outputs > cppn_outputs)
        stiffness.push_back(std::clamp(
            math::exp(std::numbers::ln10 * std::clamp(double{painted.back()}, -1.0, 1.0)), softest,
            stiffest));
    }
  Body body(rows, cols, std::move(cells));
  return stiffness.empty() ? body : with_stiffness(std::move(body), std::move(stiffness));
}

}  // namespace evo
