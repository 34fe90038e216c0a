#include "libevo/evolve/gp.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/base/error.h"

using namespace evo;

namespace {

Design design_of(const std::string& letters) {
  Design design;
  for (const char letter : letters) design.push_back(*voxel_from_letter(letter));
  return design;
}

Design random_design(std::size_t voxels, Stream& stream) {
  Design design;
  for (std::size_t i = 0; i < voxels; ++i) design.push_back(static_cast<Voxel>(stream.below(5)));
  return design;
}

// n random designs with outputs drawn from the process with these parameters.
GpData draw_from_prior(std::size_t n, std::size_t voxels, const GpParameters& parameters,
                       Stream& stream) {
  std::vector<Design> designs;
  // Near each other, so that there is correlation to be learnt: walks from a few starts.
  for (std::size_t i = 0; i < n; ++i) {
    Design design = i % 20 == 0 ? random_design(voxels, stream) : designs.back();
    for (int k = 0; k < 2; ++k)
      design[stream.below(static_cast<std::uint32_t>(voxels))] =
          static_cast<Voxel>(stream.below(5));
    designs.push_back(std::move(design));
  }
  const auto rows = static_cast<Eigen::Index>(n);
  const GpData flat(designs, Eigen::VectorXd::Zero(rows));
  const Eigen::LLT<Eigen::MatrixXd> factor(flat.covariance(parameters));
  Eigen::VectorXd normal(rows);
  for (double& value : normal) value = stream.gaussian();
  return {std::move(designs), factor.matrixL() * normal};
}

}  // namespace

// Variance 1, length scale sqrt(10), noise 0.1: sqrt(5) sqrt(2 m) / length scale is sqrt(m), so
// k(1) = (1 + 1 + 1/3) / e and k(2) = (1 + sqrt 2 + 2/3) exp(-sqrt 2).
static const GpParameters by_hand{1.0, std::sqrt(10.0), 0.1};

TEST_CASE("the kernel is Matern 5/2 of the one-hot distance") {
  const auto table = kernel_table(by_hand, 2);
  REQUIRE(table.size() == 3);
  CHECK(table[0] == 1.0);
  CHECK(table[1] == Approx(0.8583853627333655).epsilon(1e-13));
  CHECK(table[2] == Approx(0.7490135404670808).epsilon(1e-13));

  // The same from one-hot vectors written out.
  Stream stream(1, "test/one-hot");
  const GpParameters p{1.7, 2.3, 0.0};
  for (int k = 0; k < 50; ++k) {
    const Design a = random_design(9, stream);
    const Design b = random_design(9, stream);
    double square = 0.0;
    for (std::size_t i = 0; i < 9; ++i)
      for (int kind = 0; kind < 5; ++kind)
        square += std::pow((static_cast<int>(a[i]) == kind) - (static_cast<int>(b[i]) == kind), 2);
    const double r = std::sqrt(square) / p.length_scale;
    const double expected =
        1.7 * (1 + std::sqrt(5.0) * r + 5 * r * r / 3) * std::exp(-std::sqrt(5.0) * r);
    REQUIRE(kernel_table(p, 9)[static_cast<std::size_t>(mismatches(a, b))] ==
            Approx(expected).epsilon(1e-12));
  }
}

TEST_CASE("posterior and likelihood of two observations, by hand") {
  // Designs .. and .R differ in one voxel, outputs 1 and -1. The covariance has the eigenvalues
  // s = 1.1 + 1e-8 + k(1) and d = 1.1 + 1e-8 - k(1) for (1, 1) and (1, -1).
  const GpData data({design_of(".."), design_of(".R")}, Eigen::Vector2d(1.0, -1.0));
  // S. differs from them in 1 and 2 voxels: mean (k1 - k2) / d,
  // variance 1 - (k1 + k2)^2 / (2 s) - (k1 - k2)^2 / (2 d).
  const GaussianProcess process(data, by_hand);
  const std::vector<Design> asked{design_of("S."), design_of(".."), design_of("SS")};
  const auto posterior = process.predict(asked);
  CHECK(posterior.mean(0) == Approx(0.4526704961954858).epsilon(1e-12));
  CHECK(posterior.variance(0) == Approx(0.31558677103628).epsilon(1e-12));
  // At the first observation: (1 - k1) / d and 1 - (1 + k1)^2 / (2 s) - (1 - k1)^2 / (2 d).
  const double k1 = 0.8583853627333655;
  const double s = 1.1 + 1e-8 + k1;
  const double d = 1.1 + 1e-8 - k1;
  CHECK(posterior.mean(1) == Approx((1 - k1) / d).epsilon(1e-12));
  CHECK(posterior.variance(1) ==
        Approx(1 - (1 + k1) * (1 + k1) / (2 * s) - (1 - k1) * (1 - k1) / (2 * d)).epsilon(1e-12));
  CHECK(posterior.mean(2) == Approx(0.0).margin(1e-15));  // equally far from both
  // -1/2 y' K^-1 y - 1/2 log |K| - log 2 pi = -1 / d - 1/2 log(s d) - log 2 pi.
  CHECK(data.log_likelihood(by_hand).value == Approx(-5.602553571276532).epsilon(1e-12));
}

TEST_CASE("the gradient of the likelihood agrees with finite differences") {
  Stream stream(2, "test/gradient");
  const GpData data = draw_from_prior(30, 12, {1.3, 4.0, 0.2}, stream);
  for (const GpParameters& p :
       {GpParameters{1.0, 1.0, 0.01}, GpParameters{0.5, 6.0, 0.3}, GpParameters{3.0, 20.0, 0.05}}) {
    const auto gradient = data.log_likelihood(p).gradient;
    const double h = 1e-5;
    const auto slope = [&](double GpParameters::*member) {
      GpParameters up = p;
      GpParameters down = p;
      up.*member *= std::exp(h);
      down.*member *= std::exp(-h);
      return (data.log_likelihood(up).value - data.log_likelihood(down).value) / (2 * h);
    };
    CHECK(gradient[0] == Approx(slope(&GpParameters::variance)).epsilon(1e-5).margin(1e-6));
    CHECK(gradient[1] == Approx(slope(&GpParameters::length_scale)).epsilon(1e-5).margin(1e-6));
    CHECK(gradient[2] == Approx(slope(&GpParameters::noise)).epsilon(1e-5).margin(1e-6));
  }
}

TEST_CASE("parameters are recovered from data drawn with them") {
  for (const GpParameters& truth : {GpParameters{2.0, 2.5, 0.5}, GpParameters{1.0, 8.0, 0.1}}) {
    const int runs = 4;
    std::array<double, 3> log_ratio{};  // mean of log(found / truth)
    for (std::uint64_t run = 0; run < runs; ++run) {
      Stream stream(3, "test/recovery", run);
      const GpData data = draw_from_prior(160, 25, truth, stream);
      Stream restarts(4, "test/restarts", run);
      const GpParameters found = fit(data, {.restarts = 1}, restarts);
      CHECK(data.log_likelihood(found).value >= data.log_likelihood(truth).value);
      for (const double slope : data.log_likelihood(found).gradient) CHECK(std::fabs(slope) < 0.02);
      log_ratio[0] += std::log(found.variance / truth.variance) / runs;
      log_ratio[1] += std::log(found.length_scale / truth.length_scale) / runs;
      log_ratio[2] += std::log(found.noise / truth.noise) / runs;
    }
    for (const double mean : log_ratio) CHECK(std::fabs(mean) < std::log(2.0));
  }
}

TEST_CASE("screening the starting points on fewer observations finds as good parameters") {
  Stream stream(5, "test/screening");
  const GpData data = draw_from_prior(150, 16, {1.0, 4.0, 0.1}, stream);
  Stream a(6, "test/restarts");
  Stream b(6, "test/restarts");
  GpFitSettings few;
  few.screening = 50;
  const double full = data.log_likelihood(fit(data, {}, a)).value;
  CHECK(data.log_likelihood(fit(data, few, b)).value == Approx(full).margin(0.01));
}

TEST_CASE("with little noise the posterior runs through the observations") {
  Stream stream(7, "test/interpolation");
  const GpData data = draw_from_prior(60, 25, {1.0, 5.0, 1e-6}, stream);
  const auto posterior = GaussianProcess(data, {1.0, 5.0, 1e-6}).predict(data.designs());
  for (Eigen::Index i = 0; i < 60; ++i) {
    CHECK(posterior.mean(i) == Approx(data.outputs()(i)).margin(1e-3));
    CHECK(posterior.variance(i) < 1e-5);
  }
}

TEST_CASE("a prediction does not depend on what is predicted with it") {
  Stream stream(8, "test/blocks");
  const GpData data = draw_from_prior(70, 10, {1.0, 3.0, 0.1}, stream);
  const GaussianProcess process(data, {1.0, 3.0, 0.1});
  std::vector<Design> many;
  for (int i = 0; i < 600; ++i) many.push_back(random_design(10, stream));
  const auto together = process.predict(many);
  for (std::size_t i = 0; i < many.size(); i += 37) {
    const auto alone = process.predict(std::span(&many[i], 1));
    CHECK(alone.mean(0) == Approx(together.mean(static_cast<Eigen::Index>(i))).epsilon(1e-10));
    CHECK(alone.variance(0) ==
          Approx(together.variance(static_cast<Eigen::Index>(i))).epsilon(1e-10));
  }
}

TEST_CASE("designs that cannot be compared are refused") {
  CHECK_THROWS_AS(GpData({design_of(".."), design_of("...")}, Eigen::Vector2d(0, 0)), Error);
  CHECK_THROWS_AS(GpData({}, Eigen::VectorXd()), Error);
}
