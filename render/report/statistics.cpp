#include "render/report/statistics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "libevo/base/random.h"

namespace evo::report {
namespace {

// How many of the arrangements of n and m values have each U: [U], by the recurrence of Mann
// and Whitney. The highest value is one of the first sample, and beats all m of the second,
// or one of the second.
std::vector<double> arrangements(std::size_t n, std::size_t m) {
  // counts[j]: of i and j values, i growing.
  std::vector<std::vector<double>> counts(m + 1, std::vector<double>{1.0});
  for (std::size_t i = 1; i <= n; ++i)
    for (std::size_t j = 1; j <= m; ++j) {
      std::vector<double> both(i * j + 1, 0.0);
      for (std::size_t u = 0; u < counts[j].size(); ++u) both[u + j] += counts[j][u];
      for (std::size_t u = 0; u < counts[j - 1].size(); ++u) both[u] += counts[j - 1][u];
      counts[j] = std::move(both);
    }
  return counts[m];
}

double exact_p(double u, std::size_t n, std::size_t m) {
  const std::vector<double> counts = arrangements(n, m);
  const double all = std::accumulate(counts.begin(), counts.end(), 0.0);
  const auto far = static_cast<std::size_t>(std::max(u, static_cast<double>(n * m) - u));
  const double beyond =
      std::accumulate(counts.begin() + static_cast<std::ptrdiff_t>(far), counts.end(), 0.0);
  return std::min(1.0, 2.0 * beyond / all);
}

// Sizes of the groups of equal values.
std::vector<double> ties(const std::vector<double>& a, const std::vector<double>& b) {
  std::map<double, double> groups;
  for (const auto* sample : {&a, &b})
    for (const double value : *sample) ++groups[value];
  std::vector<double> sizes;
  for (const auto& [value, size] : groups)
    if (size > 1.0) sizes.push_back(size);
  return sizes;
}

double normal_p(double u, double n, double m, const std::vector<double>& tied) {
  const double all = n + m;
  double correction = 0.0;
  for (const double t : tied) correction += t * t * t - t;
  const double variance = n * m / 12.0 * (all + 1.0 - correction / (all * (all - 1.0)));
  if (!(variance > 0.0)) return 1.0;  // all values are equal
  const double z = (std::max(u, n * m - u) - n * m / 2.0 - 0.5) / std::sqrt(variance);
  return std::min(1.0, std::erfc(z / std::numbers::sqrt2));
}

double pairs_won(const std::vector<double>& a, const std::vector<double>& b) {
  double higher = 0.0;
  for (const double x : a)
    for (const double y : b) higher += x > y ? 1.0 : x == y ? 0.5 : 0.0;
  return higher;
}

}  // namespace

double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - std::floor(place)) * (sorted[above] - sorted[below]);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return quantile(values, 0.5);
}

Interval median_interval(const std::vector<double>& values) {
  constexpr double confidence = 0.95;
  constexpr std::size_t resamples = 10000;
  Stream stream(0, "report/bootstrap");
  std::vector<double> medians;
  std::vector<double> drawn(values.size());
  for (std::size_t k = 0; k < resamples; ++k) {
    for (double& value : drawn)
      value = values[stream.below(static_cast<std::uint32_t>(values.size()))];
    medians.push_back(median(drawn));
  }
  std::sort(medians.begin(), medians.end());
  return {quantile(medians, (1.0 - confidence) / 2.0), quantile(medians, (1.0 + confidence) / 2.0)};
}

double rank_test(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr std::size_t most_exact = 30;
  const auto n = static_cast<double>(a.size());
  const auto m = static_cast<double>(b.size());
  const double u = pairs_won(a, b);
  const std::vector<double> tied = ties(a, b);
  const bool exact = tied.empty() && std::max(a.size(), b.size()) <= most_exact;
  return exact ? exact_p(u, a.size(), b.size()) : normal_p(u, n, m, tied);
}

double least_p(std::size_t a, std::size_t b) { return exact_p(static_cast<double>(a * b), a, b); }

double superiority(const std::vector<double>& a, const std::vector<double>& b) {
  return pairs_won(a, b) / static_cast<double>(a.size() * b.size());
}

std::vector<double> corrected(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> more(p.size());
  double before = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    before = std::max(before, std::min(1.0, p[order[k]] * static_cast<double>(p.size() - k)));
    more[order[k]] = before;
  }
  return more;
}

}  // namespace evo::report
