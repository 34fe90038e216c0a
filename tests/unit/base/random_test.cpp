#include "libevo/base/random.h"

#include <catch2/catch.hpp>
#include <vector>

using evo::Stream;

TEST_CASE("the same name gives the same numbers, another name others") {
  Stream a(7, "sample", 3);
  Stream b(7, "sample", 3);
  for (int i = 0; i < 100; ++i) REQUIRE(a.bits() == b.bits());
  std::vector<std::uint32_t> first;
  for (auto stream : {Stream(7, "sample", 4), Stream(8, "sample", 3), Stream(7, "mutate", 3),
                      Stream(7, "sample", "x", 3)})
    first.push_back(stream.bits());
  first.push_back(Stream(7, "sample", 3).bits());
  for (std::size_t i = 0; i < first.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) REQUIRE(first[i] != first[j]);
}

TEST_CASE("a stream continues from a saved position") {
  for (int skip = 0; skip < 9; ++skip) {
    Stream a(1, "p");
    for (int i = 0; i < skip; ++i) a.bits();
    Stream b(1, "p");
    b.seek(a.tell());
    for (int i = 0; i < 9; ++i) REQUIRE(a.bits() == b.bits());
  }
}

TEST_CASE("uniform, below and gaussian have the moments they should") {
  Stream stream(3, "moments");
  const int n = 200000;
  double sum = 0.0;
  double gauss = 0.0;
  double square = 0.0;
  std::vector<int> counts(7);
  for (int i = 0; i < n; ++i) {
    const double u = stream.uniform();
    REQUIRE(u >= 0.0);
    REQUIRE(u < 1.0);
    sum += u;
    const double g = stream.gaussian();
    gauss += g;
    square += g * g;
    ++counts[stream.below(7)];
  }
  CHECK(sum / n == Approx(0.5).margin(0.005));
  CHECK(gauss / n == Approx(0.0).margin(0.01));
  CHECK(square / n == Approx(1.0).margin(0.02));
  for (const int count : counts) CHECK(count == Approx(n / 7.0).margin(700));
}

TEST_CASE("a discrete draw never gives an outcome of weight zero") {
  Stream stream(3, "discrete");
  const std::vector<double> weights{0.0, 1.0, 0.0, 3.0, 0.0};
  int threes = 0;
  for (int i = 0; i < 10000; ++i) {
    const auto k = stream.discrete(weights);
    REQUIRE((k == 1 || k == 3));
    threes += k == 3;
  }
  CHECK(threes == Approx(7500).margin(150));
}
