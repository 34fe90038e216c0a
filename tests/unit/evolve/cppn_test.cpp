#include "libevo/evolve/cppn.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/base/error.h"

using namespace evo;

namespace {

// Five outputs with these biases and no connections.
Genome painter(std::array<double, 5> biases) {
  Genome genome;
  for (int key = 0; key < 5; ++key)
    insert(genome, NodeGene{key, biases[static_cast<std::size_t>(key)]});
  return genome;
}

std::vector<std::string> picture(const Genome& genome, int rows, int cols) {
  return decode(genome, rows, cols).to_rows();
}

using Rows = std::vector<std::string>;

}  // namespace

TEST_CASE("outputs without connections give their bare bias") {
  CHECK(picture(painter({-1, 2, 3, 0, 0}), 2, 3) == Rows{"SSS", "SSS"});
  // The first one on ties.
  CHECK(picture(painter({-1, 2, 3, 3, 3}), 1, 2) == Rows{"SS"});
  CHECK(picture(painter({0, 0, 0, 0, 0}), 1, 2) == Rows{".."});
}

TEST_CASE("a sixth output paints the stiffness, a power of ten") {
  for (const auto& [output, factor] :
       {std::pair{0.0, 1.0}, std::pair{0.5, std::sqrt(10.0)}, std::pair{-7.0, 0.1}}) {
    Genome genome = painter({-1, -2, -3, 1, 0});
    insert(genome, NodeGene{5, output});
    const Body body = decode(genome, 2, 2, 6);
    CHECK(body.to_rows() == Rows{"HH", "HH"});
    CHECK(body.stiffness_of(3) == Approx(factor));
    CHECK(decode(genome, 2, 2).stiffness.empty());
  }
}

TEST_CASE("a bare bias beats every sigmoid when it exceeds 1") {
  Genome genome = painter({1.5, 0, 0, 30, 0});
  insert(genome, ConnectionGene{-1, 3, 1.0});
  CHECK(picture(genome, 2, 1) == Rows{".", "."});  // 3 saturates at 1
  genome.nodes[0].bias = 1.0;
  CHECK(picture(genome, 2, 1) == Rows{".", "."});  // a tie at 1
  genome.nodes[0].bias = 0.999;
  CHECK(picture(genome, 2, 1) == Rows{"H", "H"});
}

TEST_CASE("the inputs are the row, the column and the distance from the centre") {
  // Soft is 0.4 everywhere; horizontal is sigmoid(5 (x - 1)): 0.0067, 0.5, 0.9933 for
  // x = 0, 1, 2.
  const auto along = [](int input) {
    Genome genome = painter({-9, -9, 0.4, -1, -9});
    insert(genome, ConnectionGene{input, 3, 1.0});
    return picture(genome, 3, 4);
  };
  CHECK(along(-1) == Rows{"SSSS", "HHHH", "HHHH"});
  CHECK(along(-2) == Rows{"SHHH", "SHHH", "SHHH"});
  // Distances from (1, 1.5): 1.80 1.12 1.12 1.80 / 1.5 0.5 0.5 1.5 / as the first row;
  // sigmoid(5 (d - 1)) > 0.4 from d = 0.92 on.
  CHECK(along(-3) == Rows{"HHHH", "HSSH", "HHHH"});
}

TEST_CASE("the response multiplies the input, not the bias") {
  // Row 1: sigmoid(5 (0.5 * 2 - 1)) = 0.5; with the bias inside it would be sigmoid(2.5).
  Genome genome = painter({-9, 0.6, 0.4, -1, -9});
  genome.nodes[3].response = 0.5;
  insert(genome, ConnectionGene{-1, 3, 2.0});
  CHECK(picture(genome, 2, 1) == Rows{"R", "R"});
  genome.nodes[1].bias = 0.45;
  CHECK(picture(genome, 2, 1) == Rows{"R", "H"});
}

TEST_CASE("disabled connections and connections from outputs do not count") {
  Genome genome = painter({-9, 0.7, -9, 0.8, -9});
  insert(genome, ConnectionGene{-1, 3, -100.0, false});
  CHECK(picture(genome, 2, 1) == Rows{"H", "H"});  // the bare bias of 3
  insert(genome, NodeGene{6, 5.0});
  insert(genome, ConnectionGene{1, 6, 1.0});  // from an output: 6 keeps its bare bias, 5
  insert(genome, ConnectionGene{6, 3, 0.1});  // 3 is sigmoid(5 (0.5 + 0.8)) = 0.9985
  CHECK(picture(genome, 1, 1) == Rows{"H"});
  genome.nodes[1].bias = 0.9984;
  CHECK(picture(genome, 1, 1) == Rows{"H"});
  genome.nodes[1].bias = 0.9986;
  CHECK(picture(genome, 1, 1) == Rows{"R"});
}

TEST_CASE("hidden nodes are evaluated before those they feed, whatever their keys") {
  // column -> 9 -> 7 -> vertical; 9 = sigmoid(5 (c - 1)), 7 = sigmoid(5 (1 - 2 * 9)),
  // vertical = sigmoid(5 (7 - 0.5)): c = 0: 9 = 0.0067, 7 = 0.9928, vertical 0.9216;
  // c = 1: 9 = 0.5, 7 = 0.5, vertical 0.5; c = 2: 9 = 0.9933, 7 = 0.0072, vertical 0.0784.
  Genome genome = painter({-9, 0.3, 0.51, -9, -0.5});
  insert(genome, NodeGene{9, -1.0});
  insert(genome, NodeGene{7, 1.0});
  insert(genome, ConnectionGene{-2, 9, 1.0});
  insert(genome, ConnectionGene{9, 7, -2.0});
  insert(genome, ConnectionGene{7, 4, 1.0});
  CHECK(picture(genome, 1, 3) == Rows{"VSS"});
  genome.nodes[2].bias = 0.49;
  CHECK(picture(genome, 1, 3) == Rows{"VVS"});
  const CppnNetwork network(genome, cppn_inputs, cppn_outputs);
  CHECK(network.evaluate(std::array{0.0F, 0.0F, 0.0F})[4] == Approx(0.92160).margin(1e-5));
  CHECK(network.evaluate(std::array{0.0F, 2.0F, 0.0F})[4] == Approx(0.07840).margin(1e-5));
}

TEST_CASE("nodes that no output needs change nothing") {
  Genome genome = painter({-9, 0.3, 0.4, -9, -9});
  insert(genome, ConnectionGene{-1, 2, 0.3});
  const Body before = decode(genome, 5, 5);
  insert(genome, NodeGene{8, 30.0});
  insert(genome, ConnectionGene{-1, 8, 30.0});
  CHECK(decode(genome, 5, 5) == before);
}

TEST_CASE("sums are rounded to single precision term by term") {
  // 1e8 + 1 - 1e8 in ascending order of the sources -3, -2, -1 is 0 in single precision.
  Genome genome;
  insert(genome, NodeGene{0, 0.0, 1.0, Activation::identity});
  insert(genome, ConnectionGene{-3, 0, 1e8});
  insert(genome, ConnectionGene{-2, 0, 1.0});
  insert(genome, ConnectionGene{-1, 0, -1e8});
  CHECK(CppnNetwork(genome, 3, 1).evaluate(std::array{1.0F, 1.0F, 1.0F})[0] == 0.0F);
}

TEST_CASE("every activation and aggregation computes what its name says") {
  const auto value = [](Activation activation, float x) {
    Genome genome;
    insert(genome, NodeGene{0, 0.0, 1.0, activation});
    insert(genome, ConnectionGene{-1, 0, 1.0});
    return CppnNetwork(genome, 1, 1).evaluate(std::array{x})[0];
  };
  CHECK(value(Activation::sigmoid, 0.3F) == Approx(1 / (1 + std::exp(-1.5))));
  CHECK(value(Activation::sigmoid, -100.0F) == 0.0F);
  CHECK(value(Activation::sigmoid, 100.0F) == 1.0F);
  CHECK(value(Activation::tanh, 0.3F) == Approx(std::tanh(0.75)));
  CHECK(value(Activation::sin, 0.3F) == Approx(std::sin(0.3)));
  CHECK(value(Activation::gauss, 0.3F) == Approx(std::exp(-0.45)));
  CHECK(value(Activation::identity, -0.3F) == -0.3F);
  CHECK(value(Activation::relu, -0.3F) == 0.0F);
  CHECK(value(Activation::abs, -0.3F) == 0.3F);

  Genome product;
  insert(product, NodeGene{0, 1.0, 1.0, Activation::identity, Aggregation::product});
  insert(product, ConnectionGene{-1, 0, 2.0});
  insert(product, ConnectionGene{-2, 0, 3.0});
  CHECK(CppnNetwork(product, 2, 1).evaluate(std::array{5.0F, 7.0F})[0] == 211.0F);
}

TEST_CASE("a chain of a hundred thousand nodes is evaluated without running out of stack") {
  constexpr int length = 100'000;
  Genome genome;
  for (int key = 0; key <= length; ++key)
    genome.nodes.push_back({key, 1.0, 1.0, Activation::identity, Aggregation::sum});
  genome.connections.push_back({-1, length, 1.0, true});
  for (int key = 1; key <= length; ++key) genome.connections.push_back({key, key - 1, 1.0, true});
  CHECK(CppnNetwork(genome, 1, 1).evaluate(std::array{1.0F})[0] == length + 2.0F);
}

TEST_CASE("a defective genome is refused, not evaluated") {
  CHECK_THROWS_AS(decode(Genome{}, 5, 5), Error);
  CHECK_THROWS_AS(CppnNetwork(painter({}), 3, 5).evaluate(std::array{1.0F}), Error);
}
