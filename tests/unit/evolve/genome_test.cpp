#include "libevo/evolve/genome.h"

#include <catch2/catch.hpp>
#include <limits>

#include "libevo/base/words.h"

using namespace evo;

namespace {

// 1 input, 2 outputs, hidden nodes 5 and 7: -1 -> 5 -> 7 -> 1 and -1 -> 0.
Genome chain() {
  Genome genome;
  for (const int key : {7, 0, 5, 1}) insert(genome, NodeGene{key});
  insert(genome, ConnectionGene{7, 1, 0.5, false});
  insert(genome, ConnectionGene{-1, 5, 1.0, true});
  insert(genome, ConnectionGene{5, 7, 2.0, true});
  insert(genome, ConnectionGene{-1, 0, 3.0, true});
  return genome;
}

}  // namespace

TEST_CASE("genes lie in the order of their keys and are found by them") {
  const Genome genome = chain();
  std::vector<int> keys;
  for (const NodeGene& node : genome.nodes) keys.push_back(node.key);
  CHECK(keys == std::vector{0, 1, 5, 7});
  CHECK(genome.connections.front().ends() == std::pair{-1, 0});
  CHECK(genome.connections.back().ends() == std::pair{7, 1});
  CHECK(find(genome, 5, 7)->weight == 2.0);
  CHECK(find(genome, 7, 5) == nullptr);
  CHECK(find(genome, 7)->key == 7);
  CHECK(find(genome, 6) == nullptr);
  CHECK_FALSE(defect(genome, 1, 2));
}

TEST_CASE("a connection closes a cycle exactly when its source is downstream") {
  const Genome genome = chain();
  CHECK(closes_cycle(genome, 5, 5));
  CHECK(closes_cycle(genome, 7, 5));
  CHECK(closes_cycle(genome, 1, 5));  // through the disabled connection
  CHECK(closes_cycle(genome, 1, 7));
  CHECK_FALSE(closes_cycle(genome, 0, 5));
  CHECK_FALSE(closes_cycle(genome, 5, 1));
  CHECK_FALSE(closes_cycle(genome, -1, 7));
}

TEST_CASE("a genome that is no feed-forward network is told why") {
  const auto message = [](const Genome& genome, int inputs = 1, int outputs = 2) {
    return defect(genome, inputs, outputs).value_or("sound");
  };
  CHECK(message(chain(), 1, 3) == "output node 2 is missing");

  Genome genome = chain();
  insert(genome, ConnectionGene{-2, 5});
  CHECK(message(genome) ==
        "connection -2 -> 5 starts nowhere: neither an input (-1 to -1) nor a node");
  CHECK(message(genome, 2) == "sound");

  genome = chain();
  insert(genome, ConnectionGene{0, -1});
  CHECK(message(genome) == "connection 0 -> -1 ends nowhere: not a node");

  genome = chain();
  insert(genome, ConnectionGene{1, 5, 0.0, false});
  CHECK(message(genome) == "the connections form a cycle: not a feed-forward network");

  genome = chain();
  insert(genome, NodeGene{5});
  CHECK(message(genome) == "node 5 is out of order or there twice");

  genome = chain();
  insert(genome, ConnectionGene{5, 7});
  CHECK(message(genome) == "connection 5 -> 7 is out of order or there twice");

  genome = chain();
  genome.nodes[2].bias = std::numeric_limits<double>::infinity();
  CHECK(message(genome) == "node 5 has a bias or response that is not finite");
}

TEST_CASE("functions have the names they are written with") {
  for (const std::string& text : words_of<Activation>())
    CHECK(word(from_word<Activation>(text).value()) == text);
  CHECK(words_of<Aggregation>() == std::vector<std::string>{"sum", "product"});
  CHECK_FALSE(from_word<Activation>("Sigmoid"));
}
