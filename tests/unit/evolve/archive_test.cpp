#include "libevo/evolve/archive.h"

#include <catch2/catch.hpp>
#include <limits>

#include "libevo/base/error.h"
#include "libevo/base/random.h"
#include "libevo/body/operators.h"

using namespace evo;

namespace {
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
}

TEST_CASE("the fittest of each cell is kept, the first of equals") {
  GridArchive archive({{"a", 4, 0.0, 1.0}, {"b", 2, -1.0, 1.0}});
  CHECK(archive.cells() == 8);
  CHECK(archive.add(0, std::vector{0.1, 0.0}, 1.0));
  CHECK_FALSE(archive.add(1, std::vector{0.2, 0.9}, 1.0));
  CHECK(archive.add(2, std::vector{0.2, 0.9}, 1.5));
  CHECK(archive.add(3, std::vector{0.2, -0.1}, -7.0));
  CHECK_FALSE(archive.add(4, std::vector{0.9, 0.0}, nothing));
  CHECK_FALSE(archive.add(5, std::vector{nothing, 0.0}, 9.0));
  REQUIRE(archive.elites().size() == 2);
  CHECK(archive.elites().at({0, 1}).individual == 2);
  CHECK(archive.elites().at({0, 0}).individual == 3);
}

TEST_CASE("cells divide the range evenly, and what is beyond it counts to its ends") {
  const GridArchive archive({{"a", 4, 0.0, 1.0}});
  const auto bin = [&](double x) { return archive.cell(std::vector{x})->front(); };
  CHECK(bin(0.0) == 0);
  CHECK(bin(0.25) == 1);
  CHECK(bin(0.999) == 3);
  CHECK(bin(1.0) == 3);
  CHECK(bin(-5.0) == 0);
  CHECK(bin(std::numeric_limits<double>::infinity()) == 3);
}

TEST_CASE("grids that make no sense are refused") {
  CHECK_THROWS_AS(GridArchive({}), Error);
  CHECK_THROWS_AS(GridArchive({{"a", 0, 0.0, 1.0}}), Error);
  CHECK_THROWS_AS(GridArchive({{"a", 4, 1.0, 1.0}}), Error);
  CHECK_THROWS_AS(GridArchive({{"a", 4, 0.0, nothing}}), Error);
  CHECK_THROWS_AS(GridArchive({{"a", 100'000, 0.0, 1.0}, {"b", 100'000, 0.0, 1.0}}), Error);
}

TEST_CASE("features of a drawn body") {
  const Body body = Body::from_rows({".....", "HHHR.", "VSSS.", "V..V."});
  const auto feature = [&](const char* name) { return *body_feature(body, name); };
  CHECK(feature("filled") == Approx(10.0 / 20));
  CHECK(feature("actuated") == Approx(6.0 / 10));
  CHECK(feature("horizontal") == Approx(3.0 / 6));
  CHECK(feature("rigid") == Approx(1.0 / 10));
  CHECK(feature("height") == Approx(3.0 / 4));
  CHECK(feature("width") == Approx(4.0 / 5));
  CHECK(feature("feet") == Approx(2.0 / 3));
  // The empty row, and 1, 3 and 1 cells of the others.
  CHECK(feature("symmetry") == Approx((5.0 + 1 + 3 + 1) / 20));
  CHECK_FALSE(body_feature(body, "beauty"));
}

TEST_CASE("features of any robot lie between 0 and 1") {
  Stream stream(3, "test");
  for (int i = 0; i < 200; ++i) {
    const Body body = sample_body(1 + i % 7, 2 + i % 5, default_weights, stream);
    for (const std::string& name : body_features()) {
      const double value = *body_feature(body, name);
      CHECK((value >= 0.0 && value <= 1.0));
    }
  }
}
