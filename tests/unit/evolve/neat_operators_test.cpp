#include "libevo/evolve/neat_operators.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

using namespace evo;

namespace {

// Settings in which nothing ever mutates, to switch on one thing at a time.
NeatSettings still() {
  NeatSettings settings;
  settings.conn_add_prob = settings.conn_delete_prob = 0.0;
  settings.node_add_prob = settings.node_delete_prob = 0.0;
  settings.enabled_mutate_rate = 0.0;
  for (AttributeSettings* attribute : {&settings.bias, &settings.weight})
    attribute->mutate_rate = attribute->replace_rate = 0.0;
  return settings;
}

Genome some_genome(std::uint64_t index, const NeatSettings& settings = {}, int node_key = 5) {
  Stream stream(1, "test/genome", index);
  return fresh_genome(settings, static_cast<int>(index), node_key, stream);
}

std::set<std::pair<int, int>> ends_of(const Genome& genome) {
  std::set<std::pair<int, int>> ends;
  for (const ConnectionGene& gene : genome.connections) ends.insert(gene.ends());
  return ends;
}

}  // namespace

TEST_CASE("a new genome has five outputs, one hidden node and 12 of 23 connections") {
  const NeatSettings settings;
  int next_node = 5;
  std::map<std::pair<int, int>, int> used;
  for (int key = 1; key <= 400; ++key) {
    Stream stream(1, "test/fresh", static_cast<std::uint64_t>(key));
    const Genome genome = fresh_genome(settings, key, next_node, stream);
    REQUIRE_FALSE(defect(genome, 3, 5));
    REQUIRE(genome.key == key);
    REQUIRE(genome.nodes.size() == 6);
    REQUIRE(genome.nodes.back().key == 4 + key);  // from the run-wide counter
    REQUIRE(genome.connections.size() == 12);
    for (const NodeGene& node : genome.nodes) REQUIRE(node.response == 1.0);
    for (const ConnectionGene& gene : genome.connections) {
      REQUIRE(gene.enabled);
      const auto relative = [&](int k) { return k > 4 ? 5 : k; };
      ++used[{relative(gene.in), relative(gene.out)}];
    }
  }
  CHECK(next_node == 405);
  REQUIRE(used.size() == 23);  // 3 input-hidden, 5 hidden-output, 15 input-output
  for (const auto& [ends, count] : used) CHECK(count == Approx(400 * 12 / 23.0).margin(50));
}

TEST_CASE("initial connections: none, without and with direct ones, all of them") {
  NeatSettings settings;
  settings.initial_connection = {true, 0.0};
  CHECK(some_genome(1, settings).connections.empty());
  settings.initial_connection = {true, 1.0};
  CHECK(some_genome(1, settings).connections.size() == 23);
  settings.initial_connection = {false, 1.0};
  CHECK(some_genome(1, settings).connections.size() == 8);
  settings.num_hidden = 0;
  CHECK(some_genome(1, settings).connections.size() == 15);  // direct ones, as there is no detour
}

TEST_CASE("splitting a connection disables it and leaves a path of weights 1 and its own") {
  NeatSettings settings = still();
  settings.node_add_prob = 1.0;
  for (std::uint64_t run = 0; run < 50; ++run) {
    const Genome parent = some_genome(run);
    Genome child = parent;
    int next_node = 90;
    Stream stream(2, "test/split", run);
    mutate(child, settings, next_node, stream);
    REQUIRE_FALSE(defect(child, 3, 5));
    REQUIRE(next_node == 91);
    REQUIRE(child.connections.size() == parent.connections.size() + 2);
    int split = 0;
    for (const ConnectionGene& old : parent.connections) {
      const ConnectionGene& now = *find(child, old.in, old.out);
      REQUIRE(now.weight == old.weight);
      if (now.enabled) continue;
      ++split;
      REQUIRE(*find(child, old.in, 90) == ConnectionGene{old.in, 90, 1.0, true});
      REQUIRE(*find(child, 90, old.out) == ConnectionGene{90, old.out, old.weight, true});
    }
    REQUIRE(split == 1);
  }
}

TEST_CASE("deleting a node takes its connections along and spares outputs") {
  NeatSettings settings = still();
  settings.node_delete_prob = 1.0;
  Genome genome = some_genome(3);
  int next_node = 90;
  Stream stream(2, "test/delete");
  mutate(genome, settings, next_node, stream);
  CHECK(genome.nodes.size() == 5);
  for (const ConnectionGene& gene : genome.connections) CHECK((gene.in < 5 && gene.out < 5));
  CHECK_FALSE(defect(genome, 3, 5));
  const Genome before = genome;
  mutate(genome, settings, next_node, stream);
  CHECK(genome == before);
}

TEST_CASE("added connections are new, feed-forward and never join two outputs") {
  NeatSettings settings = still();
  settings.conn_add_prob = 1.0;
  Genome genome = some_genome(4);
  int next_node = 90;
  Stream stream(2, "test/connect");
  for (int k = 0; k < 3000; ++k) {
    const std::size_t before = genome.connections.size();
    mutate(genome, settings, next_node, stream);
    REQUIRE(genome.connections.size() - before <= 1);
  }
  REQUIRE_FALSE(defect(genome, 3, 5));
  std::size_t from_output = 0;
  for (const ConnectionGene& gene : genome.connections) {
    const bool output_source = gene.in >= 0 && gene.in < 5;
    REQUIRE_FALSE((output_source && gene.out < 5));
    from_output += output_source;
  }
  // Saturated: 15 direct, 3 into the hidden node, and each output on one side of it.
  CHECK(genome.connections.size() == 23);
  CHECK(from_output <= 5);
}

TEST_CASE("deleting a connection deletes one until none is left") {
  NeatSettings settings = still();
  settings.conn_delete_prob = 1.0;
  Genome genome = some_genome(5);
  int next_node = 90;
  Stream stream(2, "test/disconnect");
  for (std::size_t left = 12; left-- > 0;) {
    mutate(genome, settings, next_node, stream);
    REQUIRE(genome.connections.size() == left);
  }
  mutate(genome, settings, next_node, stream);
  CHECK(genome.connections.empty());
}

TEST_CASE("attributes mutate at their rates and stay in range") {
  NeatSettings settings;  // the benchmark's rates
  settings.conn_add_prob = settings.conn_delete_prob = 0.0;
  settings.node_add_prob = settings.node_delete_prob = 0.0;
  int weights = 0;
  int weights_kept = 0;
  int biases = 0;
  int biases_kept = 0;
  int disabled = 0;
  double moved = 0.0;
  for (std::uint64_t run = 0; run < 2000; ++run) {
    const Genome parent = some_genome(run);
    Genome child = parent;
    int next_node = 90;
    Stream stream(2, "test/attributes", run);
    mutate(child, settings, next_node, stream);
    REQUIRE(ends_of(child) == ends_of(parent));
    for (std::size_t i = 0; i < child.connections.size(); ++i) {
      const double change = child.connections[i].weight - parent.connections[i].weight;
      ++weights;
      weights_kept += change == 0.0;
      moved += change * change;
      disabled += !child.connections[i].enabled;
    }
    for (std::size_t i = 0; i < child.nodes.size(); ++i) {
      ++biases;
      biases_kept += child.nodes[i].bias == parent.nodes[i].bias;
      REQUIRE(child.nodes[i].response == 1.0);
    }
  }
  CHECK(weights_kept == Approx(0.1 * weights).epsilon(0.1));
  CHECK(biases_kept == Approx(0.2 * biases).epsilon(0.1));
  CHECK(disabled == Approx(0.005 * weights).margin(60));
  // 0.8 of Gaussian(0, 0.5), 0.1 of the difference of two standard normals.
  CHECK(moved / weights == Approx(0.8 * 0.25 + 0.1 * 2.0).epsilon(0.1));
}

TEST_CASE("functions are drawn from their options") {
  NeatSettings settings = still();
  settings.activation_options = {Activation::sin, Activation::gauss};
  settings.activation_mutate_rate = 1.0;
  settings.aggregation_options = {Aggregation::product};
  settings.aggregation_mutate_rate = 1.0;
  Genome genome = some_genome(6);
  int next_node = 90;
  Stream stream(2, "test/functions");
  mutate(genome, settings, next_node, stream);
  for (const NodeGene& node : genome.nodes) {
    CHECK((node.activation == Activation::sin || node.activation == Activation::gauss));
    CHECK(node.aggregation == Aggregation::product);
  }
}

TEST_CASE("thousands of mutations leave a sound feed-forward genome with values in range") {
  NeatSettings settings;
  settings.weight.mutate_power = settings.bias.mutate_power = 5.0;  // to reach the limits
  bool touched_limit = false;
  for (std::uint64_t run = 0; run < 10; ++run) {
    Genome genome = some_genome(run);
    int next_node = 90;
    Stream stream(2, "test/many", run);
    for (int k = 0; k < 600; ++k) {
      mutate(genome, settings, next_node, stream);
      REQUIRE_FALSE(defect(genome, 3, 5));
    }
    for (const ConnectionGene& gene : genome.connections) {
      REQUIRE(std::fabs(gene.weight) <= 30.0);
      touched_limit = touched_limit || std::fabs(gene.weight) == 30.0;
    }
    for (const NodeGene& node : genome.nodes) REQUIRE(std::fabs(node.bias) <= 30.0);
  }
  CHECK(touched_limit);
}

TEST_CASE("crossover takes the structure of the fitter parent, matching attributes of either") {
  const Genome fitter = some_genome(1, {}, 5);
  const Genome other = some_genome(2, {}, 5);  // the hidden nodes match
  int matching = 0;
  int from_other = 0;
  for (std::uint64_t run = 0; run < 500; ++run) {
    Stream stream(3, "test/crossover", run);
    const Genome child = crossover(fitter, other, 77, stream);
    REQUIRE(child.key == 77);
    REQUIRE(ends_of(child) == ends_of(fitter));
    REQUIRE(child.nodes.size() == fitter.nodes.size());
    for (const ConnectionGene& gene : child.connections) {
      const double own = find(fitter, gene.in, gene.out)->weight;
      const ConnectionGene* match = find(other, gene.in, gene.out);
      if (match == nullptr) {
        REQUIRE(gene.weight == own);
        continue;
      }
      REQUIRE((gene.weight == own || gene.weight == match->weight));
      ++matching;
      from_other += gene.weight == match->weight;
    }
  }
  REQUIRE(matching > 1000);
  CHECK(from_other == Approx(0.5 * matching).epsilon(0.1));
}

TEST_CASE("the distance of two genomes, by hand") {
  const NeatSettings settings;
  Genome a;
  insert(a, NodeGene{0, 1.0});
  insert(a, NodeGene{1, 0.0});
  insert(a, NodeGene{5, 2.0});
  insert(a, ConnectionGene{-1, 0, 1.0});
  insert(a, ConnectionGene{-1, 5, 1.0});
  insert(a, ConnectionGene{5, 0, 1.0});
  Genome b;
  insert(b, NodeGene{0, -0.5});
  insert(b, NodeGene{1, 0.0, 1.5});
  insert(b, NodeGene{6, 2.0});
  insert(b, ConnectionGene{-1, 0, -1.0, false});
  // Nodes: (0.6 * 1.5 + 0.6 * 0.5 + 2 disjoint) / 3; connections:
  // (0.6 * (2 + 1) + 2 disjoint) / 3.
  CHECK(distance(a, b, settings) == Approx((0.9 + 0.3 + 2.0) / 3 + (1.8 + 2.0) / 3));
  CHECK(distance(b, a, settings) == distance(a, b, settings));
  CHECK(distance(a, a, settings) == 0.0);

  b.nodes[0].activation = Activation::sin;
  CHECK(distance(a, b, settings) == Approx((0.9 + 0.6 + 0.3 + 2.0) / 3 + (1.8 + 2.0) / 3));

  // Two initial genomes share outputs, not the hidden node: 2 disjoint of 6.
  Genome c = some_genome(8, {}, 5);
  Genome d = c;
  d.nodes.back().key = 6;
  c.connections.clear();
  d.connections.clear();
  CHECK(distance(c, d, settings) == Approx(2.0 / 6.0));
}

TEST_CASE("settings that make no sense are told") {
  CHECK_FALSE(defect(NeatSettings{}));
  NeatSettings settings;
  settings.weight.min = 31.0;
  CHECK(defect(settings) == "weight: min 31 is above max 30");
  settings = {};
  settings.pop_size = 1;
  CHECK(defect(settings) == "pop_size is 1: at least 2 needed");
  settings = {};
  settings.activation_options.clear();
  CHECK(defect(settings) == "activation_options is empty");
}
