// Compositional pattern-producing networks: a genome evaluated at every cell of
// a matrix paints the body of a robot (Stanley, "Compositional pattern producing
// networks", GPEM 8(2), 2007; docs/methods.md, "From genome to robot").
#pragma once

#include <span>
#include <vector>

#include "libevo/body/body.h"
#include "libevo/evolve/genome.h"

namespace evo {

// A genome made ready for evaluation: the nodes that some output needs, sources
// first. A node is f(response * aggregate(weight * source) + bias), in single
// precision, one rounding per operation, sources in ascending order of keys. A
// node without incoming connections gives its bare bias, without f. Disabled
// connections and those that start at an output do not count.
class CppnNetwork {
 public:
  // Throws Error(data) with the genome's defect.
  CppnNetwork(const Genome& genome, int inputs, int outputs);

  // inputs[k] is the value of key -1-k; returns the outputs 0, 1, ..
  std::vector<float> evaluate(std::span<const float> inputs) const;

 private:
  struct Edge {
    std::size_t source;  // its number
    float weight;
  };
  struct Node {
    std::size_t number;
    std::size_t first_edge;
    std::size_t edges;
    float bias;
    float response;
    Activation activation;
    Aggregation aggregation;
  };
  float value(const Node& node, const std::vector<float>& values) const;

  // The values are numbered: the inputs, then the genome's nodes.
  std::size_t inputs_;
  std::size_t outputs_;
  std::size_t count_;
  std::vector<Node> order_;
  std::vector<Edge> edges_;
};

// What a body's network sees and says.
inline constexpr int cppn_inputs = 3;   // row, column, distance from the centre, in cells
inline constexpr int cppn_outputs = 5;  // empty, rigid, soft, horizontal, vertical

// The body a genome paints: in each cell the kind of the largest of these outputs, the
// first one on ties; all adjacent voxels linked. A sixth output s, if there is one, makes
// the voxel 10^s times as stiff, s being cut to [-1, 1]. It need not be a valid robot.
Body decode(const Genome& genome, int rows, int cols, int outputs = cppn_outputs);

}  // namespace evo
