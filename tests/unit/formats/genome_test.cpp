#include "formats/robot/genome.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "libevo/evolve/neat_operators.h"

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
  try {
    genome_from_json(document, "/genome");
  } catch (const Refusal& refused) {
    return refused.path + ": " + refused.message;
  }
  return "(no error)";
}

}  // namespace

TEST_CASE("a genome written and read is the same to the last bit") {
  for (std::uint64_t index = 0; index < 200; ++index) {
    const Genome genome = random_genome(index);
    const std::string text = genome_to_json(genome).dump();
    REQUIRE(genome_from_json(Json::parse(text), "") == genome);
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
  CHECK(genome_from_json(document, "") == genome);
}

TEST_CASE("a bad genome is refused with its path and what was found") {
  CHECK(message([](Json&) {}) == "(no error)");
  CHECK(message([](Json& g) { g["kind"] = "tree"; }) ==
        "/genome/kind: unknown kind of genome \"tree\"; allowed: cppn");
  CHECK(message([](Json& g) { g.erase("nodes"); }) == "/genome/nodes: is missing");
  CHECK(message([](Json& g) { g["nodes"][1]["bias"] = "much"; }) ==
        "/genome/nodes/1/bias: expected a number, found \"much\"");
  CHECK(message([](Json& g) { g["nodes"][1].erase("response"); }) ==
        "/genome/nodes/1/response: is missing");
  CHECK(message([](Json& g) { g["nodes"][2]["activation"] = "sigmiod"; }) ==
        "/genome/nodes/2/activation: unknown activation \"sigmiod\" (did you mean 'sigmoid'?); "
        "allowed: sigmoid, tanh, sin, gauss, identity, relu, abs");
  CHECK(message([](Json& g) { g["nodes"][2]["key"] = 1; }) ==
        "/genome/nodes/2/key: node 1 is there twice");
  CHECK(message([](Json& g) { g["nodes"].erase(3); }).find("/genome: output node 3 is missing") ==
        0);
  CHECK(message([](Json& g) { g["connections"][0]["in"] = -4; }) ==
        "/genome/connections/0/in: expected a whole number from -3 to 1073741824, found -4");
  CHECK(message([](Json& g) { g["connections"][0]["enabled"] = 1; }) ==
        "/genome/connections/0/enabled: expected true or false, found 1");
  CHECK(message([](Json& g) { g["connections"][1] = g["connections"][0]; }).find("twice") !=
        std::string::npos);
  CHECK(message([](Json& g) { g["connections"][0]["out"] = 9999; }).find("ends nowhere") !=
        std::string::npos);
  CHECK(message([](Json& g) { g["connections"][0] = 3; }) ==
        "/genome/connections/0: expected a JSON object, found 3");
  CHECK(message([](Json& g) { g["key"] = 1e30; }).find("expected a whole number") !=
        std::string::npos);
}
