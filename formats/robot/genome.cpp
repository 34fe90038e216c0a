#include "formats/robot/genome.h"

#include "libevo/base/words.h"
#include "libevo/evolve/cppn.h"

namespace evo {
namespace {

constexpr const char* genome_kind = "cppn";
constexpr int largest_key = 1 << 30;  // leaves room to count on

NodeGene node_gene(const Node& node) {
  return {node.at("key").integer(0, largest_key), node.at("bias").number(),
          node.at("response").number(), node.at("activation").choice<Activation>("activation"),
          node.at("aggregation").choice<Aggregation>("aggregation")};
}

ConnectionGene connection_gene(const Node& connection) {
  return {connection.at("in").integer(-cppn_inputs, largest_key),
          connection.at("out").integer(0, largest_key), connection.at("weight").number(),
          connection.at("enabled").boolean()};
}

}  // namespace

Json genome_to_json(const Genome& genome) {
  Json document;
  document["kind"] = genome_kind;
  document["key"] = genome.key;
  Json& nodes = document["nodes"] = Json::array();
  for (const NodeGene& node : genome.nodes)
    nodes.push_back(Json{{"key", node.key},
                         {"bias", node.bias},
                         {"response", node.response},
                         {"activation", word(node.activation)},
                         {"aggregation", word(node.aggregation)}});
  Json& connections = document["connections"] = Json::array();
  for (const ConnectionGene& gene : genome.connections)
    connections.push_back(Json{
        {"in", gene.in}, {"out", gene.out}, {"weight", gene.weight}, {"enabled", gene.enabled}});
  return document;
}

Genome read_genome(const Node& document) {
  document.at("kind").choice("kind of genome", {genome_kind});
  Genome genome;
  genome.key = document.at("key").integer(0, largest_key);
  for (const Node& item : document.at("nodes").items()) {
    const NodeGene node = node_gene(item);
    if (find(genome, node.key) != nullptr)
      throw item.error(fmt::format("node {} is there twice", node.key));
    insert(genome, node);
  }
  for (const Node& item : document.at("connections").items()) {
    const ConnectionGene gene = connection_gene(item);
    if (find(genome, gene.in, gene.out) != nullptr)
      throw item.error(fmt::format("connection {} -> {} is there twice", gene.in, gene.out));
    insert(genome, gene);
  }
  if (const auto found = defect(genome, cppn_inputs, cppn_outputs)) throw document.error(*found);
  return genome;
}

std::optional<Genome> genome_of(const Robot& robot, const std::string& where) {
  const auto found = robot.document.find("genome");
  if (found == robot.document.end() || found->is_null()) return {};
  return read_genome(to_node(*found, where + ": /genome"));
}

}  // namespace evo
