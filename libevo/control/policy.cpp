#include "libevo/control/policy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libevo/base/elementary.h"

namespace evo {
namespace {

// Rows of `a` made orthonormal in order by modified Gram-Schmidt, twice, which
// is enough for full precision (Giraud et al. 2005). Rows <= columns.
void orthonormalize_rows(Eigen::MatrixXd& a) {
  for (int pass = 0; pass < 2; ++pass) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < i; ++j) {
        double dot = 0.0;
        for (Eigen::Index k = 0; k < a.cols(); ++k) dot += a(i, k) * a(j, k);
        for (Eigen::Index k = 0; k < a.cols(); ++k) a(i, k) -= dot * a(j, k);
      }
      double square = 0.0;
      for (Eigen::Index k = 0; k < a.cols(); ++k) square += a(i, k) * a(i, k);
      const double norm = std::sqrt(square);
      for (Eigen::Index k = 0; k < a.cols(); ++k) a(i, k) /= norm;
    }
  }
}

Layer orthogonal_layer(int inputs, int outputs, double gain, Stream& stream) {
  const bool wide = outputs <= inputs;
  Eigen::MatrixXd a(wide ? outputs : inputs, wide ? inputs : outputs);
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j) a(i, j) = stream.gaussian();
  orthonormalize_rows(a);
  if (!wide) a.transposeInPlace();
  return {(gain * a).cast<float>(), Vector::Zero(outputs)};
}

Network zeros_like(const Network& network) {
  Network zeros;
  for (const Layer& layer : network.layers)
    zeros.layers.push_back(
        {Matrix::Zero(layer.weight.rows(), layer.weight.cols()), Vector::Zero(layer.bias.size())});
  return zeros;
}

}  // namespace

int Policy::observation_length() const {
  return static_cast<int>(actor.layers.front().weight.cols()) - 2 * static_cast<int>(clock.size());
}

int Policy::action_length() const { return static_cast<int>(log_std.size()); }

Network orthogonal_network(int inputs, const std::vector<int>& hidden, int outputs,
                           double hidden_gain, double head_gain, Stream& stream) {
  Network network;
  for (const int width : hidden) {
    network.layers.push_back(orthogonal_layer(inputs, width, hidden_gain, stream));
    inputs = width;
  }
  network.layers.push_back(orthogonal_layer(inputs, outputs, head_gain, stream));
  return network;
}

void forward(const Network& network, const Matrix& x, Activations& activations) {
  activations.resize(network.layers.size());
  const Matrix* input = &x;
  for (std::size_t l = 0; l < network.layers.size(); ++l) {
    const Layer& layer = network.layers[l];
    Matrix& y = activations[l];
    y.resize(x.rows(), layer.bias.size());
    y.rowwise() = layer.bias.transpose();
    add_product_transposed_right(*input, layer.weight, y);
    if (l + 1 < network.layers.size()) tanh_in_place(y);
    input = &y;
  }
}

void backward(const Network& network, const Matrix& x, const Activations& activations,
              std::vector<Matrix>& slopes, Network& gradient) {
  for (std::size_t l = network.layers.size(); l-- > 0;) {
    const Matrix& slope = slopes[l];  // dL/d(pre-activation)
    const Matrix& input = l == 0 ? x : activations[l - 1];
    add_product_transposed_left(slope, input, gradient.layers[l].weight);
    for (Eigen::Index b = 0; b < slope.rows(); ++b)
      gradient.layers[l].bias += slope.row(b).transpose();
    if (l == 0) break;
    Matrix& below = slopes[l - 1];
    below.setZero(slope.rows(), input.cols());
    add_product(slope, network.layers[l].weight, below);
    below.array() *= 1.0F - input.array().square();  // tanh' = 1 - tanh^2
  }
}

// Number by number, since Eigen's expressions would need room for what lies between.
void update(Normalizer& normalizer, std::span<const double> observations) {
  const auto d = static_cast<std::size_t>(normalizer.mean.size());
  const std::size_t rows = observations.size() / d;
  const auto n = static_cast<double>(rows);
  const double total = normalizer.count + n;
  for (std::size_t i = 0; i < d; ++i) {
    double mean = 0.0;
    for (std::size_t b = 0; b < rows; ++b) mean += observations[b * d + i];
    mean /= n;
    double squares = 0.0;
    for (std::size_t b = 0; b < rows; ++b) {
      const double difference = observations[b * d + i] - mean;
      squares += difference * difference;
    }
    double& old_mean = normalizer.mean[static_cast<Eigen::Index>(i)];
    double& variance = normalizer.variance[static_cast<Eigen::Index>(i)];
    const double delta = mean - old_mean;
    variance =
        (variance * normalizer.count + squares + delta * delta * (normalizer.count * n / total)) /
        total;
    old_mean += delta * (n / total);
  }
  normalizer.count = total;
}

namespace {

// Into the first columns of `out`.
void fill_normalized(const Normalizer& normalizer, std::span<const double> observations,
                     Matrix& out) {
  const auto d = static_cast<std::size_t>(normalizer.mean.size());
  const bool identity = normalizer.count == 0.0;
  for (std::size_t i = 0; i < d; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const double deviation = std::sqrt(normalizer.variance[column] + normalizer.epsilon);
    for (Eigen::Index b = 0; b < out.rows(); ++b) {
      const double x = observations[static_cast<std::size_t>(b) * d + i];
      const double z = identity ? x : (x - normalizer.mean[column]) / deviation;
      out(b, column) = static_cast<float>(std::clamp(z, -normalizer.clip, normalizer.clip));
    }
  }
}

}  // namespace

void normalize(const Normalizer& normalizer, std::span<const double> observations, Matrix& out) {
  const Eigen::Index d = normalizer.mean.size();
  out.resize(static_cast<Eigen::Index>(observations.size()) / d, d);
  fill_normalized(normalizer, observations, out);
}

void network_inputs(const Normalizer& normalizer, std::span<const double> clock,
                    std::span<const double> observations, std::span<const int> steps,
                    Matrix& inputs) {
  const Eigen::Index seen = normalizer.mean.size();
  inputs.resize(static_cast<Eigen::Index>(steps.size()), seen + 2 * std::ssize(clock));
  fill_normalized(normalizer, observations, inputs);
  for (std::size_t e = 0; e < steps.size(); ++e) {
    const auto row = static_cast<Eigen::Index>(e);
    Eigen::Index next = seen;
    for (const double period : clock) {
      const double turn = 2.0 * std::numbers::pi * steps[e] / period;
      inputs(row, next++) = static_cast<float>(math::sin(turn));
      inputs(row, next++) = static_cast<float>(math::sin(turn + 0.5 * std::numbers::pi));
    }
  }
}

void rest_targets(const Policy& policy, int t, std::span<double> targets) {
  if (policy.base)
    std::visit([&](const auto& base) { act(base, t, targets); }, *policy.base);
  else
    std::fill(targets.begin(), targets.end(), policy.action_offset);
}

double target_of(ActionMap map, double low, double high, double rest, double output) {
  if (map == ActionMap::squash) {
    const double middle = 0.5 * (high + low);
    return middle + 0.5 * (high - low) * math::tanh(output);
  }
  return std::clamp(rest + output, low, high);
}

double target_of(const Policy& policy, double rest, double output) {
  return target_of(policy.action_map, policy.low, policy.high, rest, output);
}

void act(const Policy& policy, std::span<const double> observations, std::span<const int> steps,
         std::span<double> targets, NetworkScratch& scratch) {
  network_inputs(policy.normalizer, policy.clock, observations, steps, scratch.inputs);
  forward(policy.actor, scratch.inputs, scratch.activations);
  const Matrix& mean = scratch.activations.back();
  const auto actions = static_cast<std::size_t>(mean.cols());
  for (std::size_t e = 0; e < steps.size(); ++e)
    rest_targets(policy, steps[e], targets.subspan(e * actions, actions));
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i] = target_of(policy, targets[i], static_cast<double>(mean.data()[i]));
}

void act(const Policy& policy, std::span<const double> observations, std::span<const int> steps,
         std::span<double> targets) {
  NetworkScratch scratch;
  act(policy, observations, steps, targets, scratch);
}

std::size_t parameter_count(const Policy& policy) {
  const ParameterBlocks blocks(policy);
  std::size_t count = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) count += blocks[b].size();
  return count;
}

Gradients zero_gradients(const Policy& policy) {
  return {zeros_like(policy.actor), zeros_like(policy.critic), Vector::Zero(policy.log_std.size())};
}

}  // namespace evo
