#include "render/report/statistics.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

using namespace evo::report;

namespace {

std::vector<double> numbers(const std::string& text) {
  std::istringstream words(text);
  std::vector<double> values;
  for (double value; words >> value;) values.push_back(value);
  return values;
}

}  // namespace

TEST_CASE("rank tests, effect sizes and intervals are scipy's") {
  std::ifstream table("tests/data/rank-tests.tsv");
  int cases = 0;
  for (std::string line; std::getline(table, line);) {
    if (line.starts_with('#') || line.starts_with("a\t")) continue;
    std::istringstream fields(line);
    std::string a_text, b_text;
    std::getline(fields, a_text, '\t');
    std::getline(fields, b_text, '\t');
    double u = 0, p = 0, low = 0, high = 0;
    fields >> u >> p >> low >> high;
    const auto a = numbers(a_text);
    const auto b = numbers(b_text);
    INFO(line);
    CHECK(std::abs(rank_test(a, b) - p) < 1e-9);
    CHECK(superiority(a, b) == u / static_cast<double>(a.size() * b.size()));
    // Two draws of resamples differ by what a percentile of 10 000 is uncertain by.
    const Interval interval = median_interval(a);
    const auto [least, most] = std::minmax_element(a.begin(), a.end());
    const double spread = *most - *least;
    CHECK(std::abs(interval.low - low) <= 0.04 * spread + 1e-6);
    CHECK(std::abs(interval.high - high) <= 0.04 * spread + 1e-6);
    ++cases;
  }
  CHECK(cases >= 20);
}

TEST_CASE("a rank test by hand") {
  // All of three above all of three: one of 20 arrangements at either end.
  CHECK(rank_test({4, 5, 6}, {1, 2, 3}) == Approx(0.1));
  CHECK(superiority({4, 5, 6}, {1, 2, 3}) == 1.0);
  CHECK(least_p(3, 3) == Approx(0.1));
  CHECK(least_p(1, 1) == 1.0);
  CHECK(rank_test({1, 1}, {1, 1}) == 1.0);
  CHECK(superiority({1, 1}, {1, 1}) == 0.5);
}

TEST_CASE("Holm's correction") {
  const auto p = corrected({0.04, 0.01, 0.03});
  CHECK(p[1] == Approx(0.03));
  CHECK(p[2] == Approx(0.06));
  CHECK(p[0] == Approx(0.06));  // no smaller than the one before
  CHECK(corrected({}).empty());
}

TEST_CASE("an interval is the same for the same values, and lies within them") {
  const std::vector<double> values{1, 5, 2, 8, 3};
  const Interval first = median_interval(values);
  CHECK(first.low == median_interval(values).low);
  CHECK(first.low >= 1);
  CHECK(first.high <= 8);
  CHECK(first.low <= median(values));
  CHECK(median(values) == 3);
  CHECK(median({4, 1}) == 2.5);
  CHECK(median_interval({7}).high == 7);
}
