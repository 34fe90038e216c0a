// PPO's loss of one sample in double precision, written from the papers for tests of gradients.
#pragma once

#include <algorithm>
#include <cmath>

#include "libevo/control/ppo.h"

namespace evo::test {

// Sample i: the policy now has its actions with `log_prob` and values its state at `v`.
inline double loss_of_sample(const Samples& batch, Eigen::Index i, double log_prob, double v,
                             double entropy, const TrainingSettings& o) {
  const double advantage = static_cast<double>(batch.advantages[i]);
  const double ratio = std::exp(log_prob - static_cast<double>(batch.log_probs[i]));
  const double bounded = std::clamp(ratio, 1.0 - o.clip, 1.0 + o.clip);
  const double old_v = static_cast<double>(batch.values[i]);
  const double target = static_cast<double>(batch.returns[i]);
  double square = (v - target) * (v - target);
  if (o.clip_value_loss) {
    const double near = old_v + std::clamp(v - old_v, -o.clip, o.clip);
    square = std::max(square, (near - target) * (near - target));
  }
  return -std::min(ratio * advantage, bounded * advantage) + o.value_coefficient * 0.5 * square -
         o.entropy_coefficient * entropy;
}

}  // namespace evo::test
