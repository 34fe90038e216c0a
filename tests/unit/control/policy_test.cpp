#include "libevo/control/policy.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "libevo/control/ppo.h"

using namespace evo;

TEST_CASE("orthogonal layers have orthogonal rows or columns of the given gain") {
  Stream stream(3, "test");
  const Network network = orthogonal_network(20, {64, 64}, 5, std::sqrt(2.0), 0.01, stream);
  REQUIRE(network.layers.size() == 3);
  const auto gram_error = [](const Matrix& rows, double gain) {
    const Eigen::MatrixXd w = rows.cast<double>();
    const Eigen::MatrixXd expected =
        gain * gain * Eigen::MatrixXd::Identity(rows.rows(), rows.rows());
    return (w * w.transpose() - expected).cwiseAbs().maxCoeff();
  };
  CHECK(gram_error(network.layers[0].weight.transpose(), std::sqrt(2.0)) < 1e-6);
  CHECK(gram_error(network.layers[1].weight, std::sqrt(2.0)) < 1e-6);
  CHECK(gram_error(network.layers[2].weight, 0.01) < 1e-6);
  for (const Layer& layer : network.layers) CHECK(layer.bias.isZero(0.0F));
}

TEST_CASE("running moments are those of all observations at once") {
  Stream stream(4, "test");
  Normalizer running = fresh_normalizer(3);
  running.count = 1e-12;  // a prior that weighs nothing
  std::vector<double> all;
  for (const int rows : {4, 1, 7, 16}) {
    std::vector<double> batch;
    for (int i = 0; i < 3 * rows; ++i) batch.push_back(5.0 * (i % 3) + 2.0 * stream.gaussian());
    update(running, batch);
    all.insert(all.end(), batch.begin(), batch.end());
  }
  const double n = static_cast<double>(all.size()) / 3.0;
  CHECK(running.count == Approx(n));
  for (std::size_t d = 0; d < 3; ++d) {
    double mean = 0.0;
    double square = 0.0;
    for (std::size_t i = d; i < all.size(); i += 3) mean += all[i] / n;
    for (std::size_t i = d; i < all.size(); i += 3) square += (all[i] - mean) * (all[i] - mean) / n;
    CHECK(running.mean[static_cast<Eigen::Index>(d)] == Approx(mean));
    CHECK(running.variance[static_cast<Eigen::Index>(d)] == Approx(square));
  }
}

TEST_CASE("normalised observations are clipped, and unchanged without statistics") {
  Normalizer n;
  n.mean = Eigen::VectorXd::Constant(2, 1.0);
  n.variance = Eigen::VectorXd::Constant(2, 4.0);
  n.count = 10;
  Matrix out;
  normalize(n, std::vector<double>{5.0, 1000.0}, out);
  CHECK(out(0, 0) == Approx(2.0F));
  CHECK(out(0, 1) == 10.0F);
  n.count = 0;
  normalize(n, std::vector<double>{5.0, 1000.0}, out);
  CHECK(out(0, 0) == 5.0F);
  CHECK(out(0, 1) == 10.0F);
}

TEST_CASE("targets stay within their bounds for either action map") {
  Policy policy;
  CHECK(target_of(policy, 1.0, 0.25) == 1.25);
  CHECK(target_of(policy, 1.0, 7.0) == 1.6);
  CHECK(target_of(policy, 1.0, -7.0) == 0.6);
  policy.action_map = ActionMap::squash;
  CHECK(target_of(policy, 1.0, 0.0) == Approx(1.1));
  CHECK(target_of(policy, 1.0, 1.0) == Approx(1.1 + 0.5 * std::tanh(1.0)));
  CHECK(target_of(policy, 1.0, 1e6) <= 1.6);
}

TEST_CASE("acting on a batch is acting on each row") {
  Stream stream(5, "test");
  Policy policy;
  const bool on_gait = GENERATE(false, true);
  if (on_gait) {
    policy.base = travelling_wave(3, 0.3, 12.5, 0.7);
    policy.clock = {12.5, 40.0};
  }
  const int inputs = on_gait ? 7 + 4 : 7;
  policy.actor = orthogonal_network(inputs, {64, 64}, 3, std::sqrt(2.0), 1.0, stream);
  policy.critic = orthogonal_network(inputs, {64, 64}, 1, std::sqrt(2.0), 1.0, stream);
  policy.log_std = Vector::Zero(3);
  policy.normalizer = fresh_normalizer(7);
  std::vector<double> observations(7 * 9);
  for (double& o : observations) o = stream.gaussian();
  std::vector<double> together(3 * 9);
  const std::vector<int> steps{0, 1, 2, 3, 4, 5, 6, 7, 8};
  act(policy, observations, steps, together);
  for (std::size_t e = 0; e < 9; ++e) {
    std::vector<double> alone(3);
    act(policy, std::span(observations).subspan(7 * e, 7), std::span(steps).subspan(e, 1), alone);
    CHECK(alone == std::vector<double>(together.begin() + static_cast<std::ptrdiff_t>(3 * e),
                                       together.begin() + static_cast<std::ptrdiff_t>(3 * e + 3)));
  }
}

TEST_CASE("networks see the clock of the episode after the observation, and act on the gait") {
  Policy policy;
  policy.actor.layers = {{Matrix::Zero(2, 3 + 2), Vector::Zero(2)}};
  policy.log_std = Vector::Zero(2);
  policy.normalizer = fresh_normalizer(3);
  policy.clock = {8.0};
  CHECK(policy.observation_length() == 3);

  Matrix inputs;
  network_inputs(policy.normalizer, policy.clock, std::vector<double>{1, 2, 3, 4, 5, 6},
                 std::vector<int>{0, 2}, inputs);
  REQUIRE(inputs.cols() == 5);
  CHECK(inputs(0, 2) == 3.0F);
  CHECK(inputs(0, 3) == 0.0F);  // sine, then cosine
  CHECK(inputs(0, 4) == 1.0F);
  CHECK(inputs(1, 3) == Approx(1.0F));
  CHECK(inputs(1, 4) == Approx(0.0F).margin(1e-6));

  SineController gait = travelling_wave(2, 0.25, 8.0, 0.0);
  policy.base = gait;
  std::vector<double> targets(2);
  act(policy, std::vector<double>{1, 2, 3}, std::vector<int>{2}, targets);
  CHECK(targets[0] == Approx(1.1 + 0.25));
  gait.shift = {-0.1, 0.0};
  policy.base = gait;
  act(policy, std::vector<double>{1, 2, 3}, std::vector<int>{2}, targets);
  CHECK(targets[0] == Approx(1.1 - 0.1 + 0.25));
}

TEST_CASE("a network on a sequence adds to its targets, and to the last of them after its end") {
  Policy policy;
  policy.actor.layers = {{Matrix::Zero(2, 1), Vector{{0.1F, -0.1F}}}};
  policy.log_std = Vector::Zero(2);
  policy.normalizer = fresh_normalizer(1);
  policy.base = ReplayController{{0.9, 1.0, 1.2, 1.55}, 2};
  std::vector<double> targets(6);
  act(policy, std::vector<double>{0, 0, 0}, std::vector<int>{0, 1, 7}, targets);
  CHECK(targets[0] == Approx(1.0));
  CHECK(targets[1] == Approx(0.9));
  CHECK(targets[2] == Approx(1.3));
  CHECK(targets[3] == Approx(1.45));
  CHECK(targets[4] == targets[2]);
  CHECK(targets[5] == targets[3]);
}
