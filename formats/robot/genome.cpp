#include "formats/robot/genome.h"

#include "formats/io/json_object.h"
#include "libevo/base/words.h"
#include "libevo/evolve/cppn.h"

namespace evo {
namespace {

constexpr const char* genome_kind = "cppn";
constexpr int largest_key = 1 << 30;  // leaves room to count on

template <Worded Function>
Function function_of(const JsonObject& node, const char* field) {
  const std::string& text = node.text(field);
  if (const auto found = from_word<Function>(text)) return *found;
  const std::vector<std::string> known = words_of<Function>();
  throw refusal(node.path_of(field), "unknown {} {}{}; allowed: {}", field, shown(Json(text)),
                did_you_mean(text, known), fmt::join(known, ", "));
}

NodeGene node_from_json(const JsonObject& node) {
  return {node.integer("key", 0, largest_key), node.number("bias"), node.number("response"),
          function_of<Activation>(node, "activation"),
          function_of<Aggregation>(node, "aggregation")};
}

ConnectionGene connection_from_json(const JsonObject& connection) {
  return {connection.integer("in", -cppn_inputs, largest_key),
          connection.integer("out", 0, largest_key), connection.number("weight"),
          connection.boolean("enabled")};
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

Genome genome_from_json(const Json& document, const std::string& path) {
  const JsonObject object(document, path);
  if (object.text("kind") != genome_kind)
    throw refusal(object.path_of("kind"), "unknown kind of genome {}; allowed: {}",
                  shown(object.at("kind")), genome_kind);
  Genome genome;
  genome.key = object.integer("key", 0, largest_key);

  const Json& nodes = object.array("nodes");
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const JsonObject item(nodes[i], fmt::format("{}/nodes/{}", path, i));
    const NodeGene node = node_from_json(item);
    if (find(genome, node.key) != nullptr)
      throw refusal(item.path_of("key"), "node {} is there twice", node.key);
    insert(genome, node);
  }
  const Json& connections = object.array("connections");
  for (std::size_t i = 0; i < connections.size(); ++i) {
    const JsonObject item(connections[i], fmt::format("{}/connections/{}", path, i));
    const ConnectionGene gene = connection_from_json(item);
    if (find(genome, gene.in, gene.out) != nullptr)
      throw refusal(item.path(), "connection {} -> {} is there twice", gene.in, gene.out);
    insert(genome, gene);
  }
  if (const auto found = defect(genome, cppn_inputs, cppn_outputs))
    throw refusal(path, "{}", *found);
  return genome;
}

std::optional<Genome> genome_of(const Robot& robot, const std::string& where) {
  const auto found = robot.document.find("genome");
  if (found == robot.document.end() || found->is_null()) return {};
  try {
    return genome_from_json(*found, "/genome");
  } catch (const Refusal& refused) {
    throw refused.at(where);
  }
}

}  // namespace evo
