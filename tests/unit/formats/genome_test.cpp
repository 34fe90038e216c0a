#include "formats/robot/genome.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "libevo/evolve/neat_operators.h"
#include "tests/unit/expect.h"

using namespace evo;

namespace {

Genome random_genome(std::uint64_t index) {
  NeatSettings settings;
  int next_node = 5;
  Stream stream(1, "test/genome", index);
  Genome genome = fresh_genome(settings, static_cast<int>(index), next_node, stream);
  for (int k = 0; k < 10; ++k) mutate(genome, settings, next_node, stream);
  return genome;
}

// What is said about a genome after one change to a sound one.
template <typename Change>
std::string message(Change change) {
  Json document = genome_to_json(random_genome(3));
  change(document);
  return test::error_of(Failure::data, [&] { read_genome(to_node(document, "g")); })
      .substr(std::string("g:1:").size());
}

}  // namespace

TEST_CASE("a genome written and read is the same to the last bit") {
  for (std::uint64_t index = 0; index < 200; ++index) {
    const Genome genome = random_genome(index);
    const std::string text = genome_to_json(genome).dump();
    REQUIRE(read_genome(Node::json(text, "g")) == genome);
  }
}

TEST_CASE("the fields are those of the specification, in its order") {
  Genome genome;
  genome.key = 17;
  insert(genome, NodeGene{0, -0.25});
  insert(genome, ConnectionGene{-1, 0, 0.5, false});
  CHECK(genome_to_json(genome).dump() ==
        R"({"kind":"cppn","key":17,"nodes":[{"key":0,"bias":-0.25,"response":1.0,)"
        R"("activation":"sigmoid","aggregation":"sum"}],)"
        R"("connections":[{"in":-1,"out":0,"weight":0.5,"enabled":false}]})");
}

TEST_CASE("genes may come in any order and with fields of others") {
  const Genome genome = random_genome(5);
  Json document = genome_to_json(genome);
  for (const char* list : {"nodes", "connections"})
    std::reverse(document[list].begin(), document[list].end());
  document["comment"] = "mine";
  document["nodes"][0]["innovation"] = 3;
  CHECK(read_genome(to_node(document, "g")) == genome);
}

TEST_CASE("a bad genome is refused with its path and what was found") {
  using Change = void (*)(Json&);
  const std::vector<std::pair<Change, const char*>> all{
      {[](Json& g) { g["kind"] = "tree"; },
       ": /kind: unknown kind of genome 'tree'; allowed: cppn"},
      {[](Json& g) { g.erase("nodes"); }, "1: key 'nodes' is missing"},
      {[](Json& g) { g["nodes"][1]["bias"] = "much"; },
       ": /nodes/1/bias: a number is expected, found 'much'"},
      {[](Json& g) { g["nodes"][1].erase("response"); }, ": /nodes/1: key 'response' is missing"},
      {[](Json& g) { g["nodes"][2]["activation"] = "sigmiod"; },
       ": /nodes/2/activation: unknown activation 'sigmiod' (did you mean 'sigmoid'?); "
       "allowed: sigmoid, tanh, sin, gauss, identity, relu, abs"},
      {[](Json& g) { g["nodes"][2]["key"] = 1; }, ": /nodes/2: node 1 is there twice"},
      {[](Json& g) { g["nodes"].erase(3); }, "1: output node 3 is missing"},
      {[](Json& g) { g["connections"][0]["in"] = -4; },
       ": /connections/0/in: a whole number from -3 to 1073741824 is expected, found '-4'"},
      {[](Json& g) { g["connections"][0]["enabled"] = 1; },
       ": /connections/0/enabled: true or false is expected, found '1'"},
      {[](Json& g) { g["connections"][1] = g["connections"][0]; }, "twice"},
      {[](Json& g) { g["connections"][0]["out"] = 9999; }, "ends nowhere"},
      {[](Json& g) { g["connections"][0] = 3; }, ": /connections/0: a mapping"},
      {[](Json& g) { g["key"] = 1e30; }, ": /key: a whole number"}};
  CHECK_NOTHROW(read_genome(to_node(genome_to_json(random_genome(3)), "g")));
  for (const auto& [change, expected] : all) CHECK_THAT(message(change), Catch::Contains(expected));
}
