#include "libevo/body/operators.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "tests/unit/expect.h"

using namespace evo;
using evo::test::error_of;

namespace {

// Valid, well formed, fully linked, of the shape asked for.
void check_robot(const Body& body, int rows, int cols) {
  REQUIRE(body.rows == rows);
  REQUIRE(body.cols == cols);
  REQUIRE_FALSE(defect(body, true));
  REQUIRE(is_valid_robot(body));
  REQUIRE(body.links == full_links(rows, cols, body.cells));
  REQUIRE(std::none_of(body.cells.begin(), body.cells.end(),
                       [](Voxel v) { return v == Voxel::fixed; }));
}

}  // namespace

TEST_CASE("Sampled bodies are valid robots of the shape asked for") {
  for (const auto& [rows, cols] : {std::pair{5, 5}, {1, 1}, {1, 7}, {6, 1}, {3, 8}, {10, 10}})
    for (std::uint64_t i = 0; i < 200; ++i) {
      Stream stream(11, "test/sample", i);
      check_robot(sample_body(rows, cols, default_weights, stream), rows, cols);
    }
}

TEST_CASE("The same stream gives the same robots, another one others") {
  std::set<std::string> ids;
  for (std::uint64_t i = 0; i < 100; ++i) {
    Stream a(3, "test/same", i);
    Stream b(3, "test/same", i);
    const Body body = sample_body(5, 5, default_weights, a);
    CHECK(body == sample_body(5, 5, default_weights, b));
    CHECK(mutate(body, {}, a) == mutate(body, {}, b));
    ids.insert(identity(body));
  }
  CHECK(ids.size() == 100);
}

TEST_CASE("Giving up early on a matrix does not change which robots are drawn") {
  // All robots of a small shape, against plain rejection of whole matrices.
  constexpr int draws = 40000;
  std::map<std::vector<std::string>, int> sampled;
  std::map<std::vector<std::string>, int> rejected;
  Stream stream(5, "test/distribution");
  for (int i = 0; i < draws; ++i) {
    ++sampled[sample_body(3, 2, {0.6, 0.2, 0, 0.2, 0}, stream).to_rows()];
    for (;;) {
      std::vector<Voxel> cells;
      for (int cell = 0; cell < 6; ++cell)
        cells.push_back(static_cast<Voxel>(stream.discrete(VoxelWeights{0.6, 0.2, 0, 0.2, 0})));
      const Body body(3, 2, cells);
      if (!is_valid_robot(body)) continue;
      ++rejected[body.to_rows()];
      break;
    }
  }
  CHECK(sampled.size() == rejected.size());
  // Two-sample chi-square, each count Poisson: its mean is the number of kinds.
  double chi_square = 0.0;
  for (const auto& [rows, n] : sampled) {
    const int m = rejected[rows];
    chi_square += static_cast<double>((n - m) * (n - m)) / (n + m);
  }
  const auto kinds = static_cast<double>(sampled.size());
  CHECK(std::abs(chi_square - kinds) < 5 * std::sqrt(2 * kinds));
}

TEST_CASE("Weights shape the sample") {
  Stream stream(6, "test/weights");
  for (int i = 0; i < 100; ++i) {
    const Body full = sample_body(4, 4, {0, 1, 1, 1, 0}, stream);
    CHECK(count_voxels(full) == 16);
    CHECK(std::count(full.cells.begin(), full.cells.end(), Voxel::vertical) == 0);
  }
  check_robot(sample_body(60, 60, {0.05, 1, 1, 1, 1}, stream), 60, 60);
}

TEST_CASE("What cannot be sampled is refused at once, or after a bound") {
  Stream stream(7, "test/refused");
  const auto refused = [&](int rows, int cols, VoxelWeights weights,
                           Failure kind = Failure::usage) {
    error_of(kind, [&] { (void)sample_body(rows, cols, weights, stream, 1000); });
  };
  refused(5, 5, {1, 1, 1, 0, 0});
  refused(5, 5, {1, 0, 0, 0, 0});
  refused(5, 5, {0, 0, 0, 0, 0});
  refused(5, 5, {1, 1, 1, -1, 1});
  refused(5, 5, {1, 1, 1, std::numeric_limits<double>::quiet_NaN(), 1});
  refused(5, 5, {1, std::numeric_limits<double>::infinity(), 1, 1, 1});
  refused(0, 5, default_weights);
  refused(5, -1, default_weights);
  refused(largest_side + 1, 5, default_weights);
  refused(35, 35, default_weights, Failure::work);
  refused(5, 5, {1e9, 1e-9, 0, 1e-9, 0}, Failure::work);
}

TEST_CASE("Children of mutation are valid robots") {
  const Body parent = Body::from_rows({"RHHHR", "VSSSV", "VHRHV", "V...V", "V...V"});
  int born = 0;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    Stream stream(8, "test/mutate", i);
    const MutationSettings settings{0.01 + 0.3 * stream.uniform(), stream.integer(1, 50),
                                    default_weights};
    const auto child = mutate(parent, settings, stream);
    if (!child) continue;
    check_robot(*child, 5, 5);
    ++born;
  }
  CHECK(born > 2000);
}

TEST_CASE("A voxel is redrawn with the rate, and then as the weights say") {
  // A full parent of a kind that the weights below do not give, so that every
  // redraw shows; no redraw can make it invalid.
  const Body parent = Body::from_rows(std::vector<std::string>(10, std::string(10, 'H')));
  const MutationSettings settings{0.1, 1, {0, 1, 3, 0, 0}};
  constexpr int children = 2000;
  int rigid = 0;
  int soft = 0;
  for (std::uint64_t i = 0; i < children; ++i) {
    Stream stream(9, "test/rate", i);
    const auto child = mutate(parent, settings, stream);
    REQUIRE(child);
    rigid += static_cast<int>(std::count(child->cells.begin(), child->cells.end(), Voxel::rigid));
    soft += static_cast<int>(std::count(child->cells.begin(), child->cells.end(), Voxel::soft));
  }
  const double cells = children * 100.0;
  const auto close = [&](int found, double share) {  // within 5 standard deviations
    return std::abs(found / cells - share) < 5 * std::sqrt(share * (1 - share) / cells);
  };
  CHECK(close(rigid, 0.1 / 4));
  CHECK(close(soft, 0.3 / 4));
}

TEST_CASE("Further attempts of a mutation continue from the mutated body") {
  // Redrawn cells become empty. An attempt that started from the parent again
  // would leave one piece soon enough, in 1000 attempts always; an attempt that
  // continues has less and less left, and sometimes nothing.
  const Body parent = Body::from_rows({"HHHH"});
  int born = 0;
  int died_out = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    Stream stream(10, "test/accumulate", i);
    ++(mutate(parent, {0.5, 1000, {1, 0, 0, 0, 0}}, stream) ? born : died_out);
  }
  CHECK(born > 200);
  CHECK(died_out > 10);
}

TEST_CASE("The ends of the rate") {
  const Body parent = Body::from_rows({"HV", "RS"});
  Stream stream(12, "test/ends");
  CHECK(mutate(parent, {0.0, 1, default_weights}, stream) == parent);
  const auto changed = mutate(parent, {1.0, 50, {0, 0, 0, 0, 1}}, stream);
  REQUIRE(changed);
  CHECK(changed->to_rows() == std::vector<std::string>{"VV", "VV"});
  CHECK_FALSE(mutate(parent, {1.0, 50, {1, 0, 0, 0, 0}}, stream));
  CHECK_FALSE(mutate(parent, {0.1, 0, default_weights}, stream));
  for (const double rate : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()})
    error_of(Failure::usage, [&] { (void)mutate(parent, {rate, 1, default_weights}, stream); });
}

TEST_CASE("Children are fully linked, whatever links the parent had") {
  Body parent = Body::from_rows({"HV", "RS"});
  parent.links = {{0, 1}, {0, 2}, {1, 3}};
  Stream stream(13, "test/links");
  const auto child = mutate(parent, {0.0, 1, default_weights}, stream);
  REQUIRE(child);
  CHECK(child->links == full_links(2, 2, parent.cells));
}

TEST_CASE("Crossover takes every voxel from one of the parents") {
  int from_a = 0;
  int differing = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Stream stream(14, "test/crossover", i);
    const Body a = sample_body(5, 5, default_weights, stream);
    const Body b = sample_body(5, 5, default_weights, stream);
    const auto child = crossover(a, b, 50, stream);
    if (!child) continue;
    check_robot(*child, 5, 5);
    for (std::size_t c = 0; c < 25; ++c) {
      const Voxel voxel = child->cells[c];
      REQUIRE((voxel == a.cells[c] || voxel == b.cells[c]));
      if (a.cells[c] == b.cells[c]) continue;
      ++differing;
      from_a += voxel == a.cells[c] ? 1 : 0;
    }
  }
  REQUIRE(differing > 5000);
  CHECK(from_a / static_cast<double>(differing) == Approx(0.5).margin(0.03));
  Stream stream(15, "test/shapes");
  error_of(Failure::data, [&] {
    (void)crossover(Body::from_rows({"HH"}), Body::from_rows({"H", "H"}), 5, stream);
  });
}

TEST_CASE("Stiffness is inherited with its voxel, and mutates by a share of itself") {
  Stream stream(16, "test/stiffness");
  const Body plain = sample_body(5, 5, {0, 0.25, 0.25, 0.25, 0.25}, stream);
  const Body parent = with_stiffness(plain, std::vector<double>(25, 2.0));
  CHECK(mutate(parent, {.rate = 0.0}, stream) == parent);
  CHECK(mutate(plain, {.rate = 0.0}, stream)->stiffness.empty());
  double moved = 0.0;
  for (int i = 0; i < 400; ++i) {
    const auto child = mutate(parent, {.rate = 0.0, .stiffness_sigma = 0.3}, stream);
    for (const double factor : child->stiffness) {
      REQUIRE((factor >= softest && factor <= stiffest));
      moved += std::log(factor / 2.0) * std::log(factor / 2.0) / (400 * 25);
    }
  }
  CHECK(moved == Approx(0.09).epsilon(0.05));
  const auto mixed = crossover(parent, plain, 50, stream);
  for (const double factor : mixed->stiffness) CHECK((factor == 1.0 || factor == 2.0));
}
