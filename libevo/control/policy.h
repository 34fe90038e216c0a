// The controller: two small networks, actor and critic, over a normalised
// observation. Single precision. Spec: robots, section 5.2; formats, "Policy".
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libevo/base/random.h"

namespace evo {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXf;

struct Layer {
  Matrix weight;  // [outputs x inputs]
  Vector bias;    // [outputs]
};

// tanh after every layer but the last.
struct Network {
  std::vector<Layer> layers;
};

// Running mean and variance of observations; eps 1e-8, clip +-10.
struct Normalizer {
  Eigen::VectorXd mean;
  Eigen::VectorXd variance;
  double count = 0.0;
  double clip = 10.0;
  double epsilon = 1e-8;
};

// How network outputs become actuator targets.
//   offset: target = clip(1 + a, low, high), as in the paper's code
//   tanh:   target = middle + half * tanh(a), bounded by construction
enum class ActionMap { offset, squash };

struct Policy {
  Network actor;
  Network critic;
  Vector log_std;  // [A], state-independent
  Normalizer normalizer;
  ActionMap action_map = ActionMap::offset;
  double action_offset = 1.0;
  double low = 0.6;
  double high = 1.6;

  int observation_length() const;
  int action_length() const;
};

// The deterministic controller: observations [E x D] in, targets [E x A] out.
void act(const Policy& policy, std::span<const double> observations, std::span<double> targets);

}  // namespace evo
