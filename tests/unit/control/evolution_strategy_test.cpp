#include "libevo/control/evolution_strategy.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace evo;

namespace {

double maximise(EvolutionStrategy& strategy, Stream& stream, int generations,
                double (*f)(const std::vector<double>&)) {
  double best = -HUGE_VAL;
  for (int g = 0; g < generations; ++g) {
    const auto candidates = strategy.ask(stream);
    std::vector<double> fitness;
    for (const auto& x : candidates) fitness.push_back(f(x));
    for (const double value : fitness) best = std::max(best, value);
    strategy.tell(candidates, fitness);
  }
  return best;
}

// Axes of very different length.
double ellipsoid(const std::vector<double>& x) {
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double scale =
        std::pow(1000.0, static_cast<double>(i) / (static_cast<double>(x.size()) - 1));
    sum -= scale * scale * (x[i] - 1.0) * (x[i] - 1.0);
  }
  return sum;
}

}  // namespace

TEST_CASE("the evolution strategy finds the top of an ill-conditioned ellipsoid") {
  Stream stream(1, "es");
  EvolutionStrategy strategy(std::vector<double>(10, 0.0), 0.5, 12);
  CHECK(maximise(strategy, stream, 600, &ellipsoid) > -1e-9);
  for (const double x : strategy.mean()) CHECK(x == Approx(1.0).margin(1e-3));
}

TEST_CASE("candidates that failed rank last") {
  Stream stream(2, "es");
  EvolutionStrategy strategy(std::vector<double>(4, 0.0), 0.5, 11);
  const auto half_failed = [](const std::vector<double>& x) {
    return x[0] > 1.0 ? std::nan("") : x[0] - x[1] * x[1] - x[2] * x[2] - x[3] * x[3];
  };
  CHECK(maximise(strategy, stream, 100, half_failed) == Approx(1.0).margin(0.05));
  CHECK(std::isfinite(strategy.sigma()));
}
