// Adam and the clipping of gradients, for whatever gives its parameters as runs of floats:
// a type with size() and operator[], such as ParameterBlocks.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace evo {

// Scales the gradients so that their norm is at most `limit` (0: none); returns
// the norm they had.
template <typename Blocks>
double clip_norm(const Blocks& blocks, double limit) {
  const auto square = [](float x) { return static_cast<double>(x) * static_cast<double>(x); };
  // Eight interleaved sums: a fixed order that still fills vector registers.
  constexpr std::size_t lanes = 8;
  double sums[lanes] = {};
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const std::span<float> block = blocks[k];
    for (std::size_t i = 0; i < block.size(); i += lanes) {
      const std::size_t n = std::min(lanes, block.size() - i);
      if (n == lanes) {  // of a length that the compiler knows
        for (std::size_t j = 0; j < lanes; ++j) sums[j] += square(block[i + j]);
      } else {
        for (std::size_t j = 0; j < n; ++j) sums[j] += square(block[i + j]);
      }
    }
  }
  const double norm = std::sqrt(std::accumulate(sums, sums + lanes, 0.0));
  if (limit > 0.0 && norm > limit) {
    const auto factor = static_cast<float>(limit / norm);
    for (std::size_t k = 0; k < blocks.size(); ++k)
      for (float& g : blocks[k]) g *= factor;
  }
  return norm;
}

// Adam (Kingma and Ba 2015), beta 0.9 and 0.999.
struct Adam {
  std::vector<float> first;   // m, in the order of the blocks
  std::vector<float> second;  // v
  double first_power = 1.0;   // beta_1^t
  double second_power = 1.0;  // beta_2^t

  explicit Adam(std::size_t parameters = 0) : first(parameters), second(parameters) {}

  template <typename Parameters, typename Slopes>
  void step(const Parameters& parameters, const Slopes& slopes, double learning_rate,
            double epsilon) {
    constexpr float beta1 = 0.9F;
    constexpr float beta2 = 0.999F;
    first_power *= 0.9;
    second_power *= 0.999;
    const auto rate = static_cast<float>(learning_rate / (1.0 - first_power));
    const auto correction = static_cast<float>(1.0 / std::sqrt(1.0 - second_power));
    const auto eps = static_cast<float>(epsilon);
    std::size_t offset = 0;
    for (std::size_t b = 0; b < parameters.size(); ++b) {
      const std::span<float> values = parameters[b];
      float* p = values.data();
      const float* g = slopes[b].data();
      float* m = first.data() + offset;
      float* v = second.data() + offset;
      for (std::size_t i = 0; i < values.size(); ++i) {
        m[i] = beta1 * m[i] + (1.0F - beta1) * g[i];
        v[i] = beta2 * v[i] + (1.0F - beta2) * (g[i] * g[i]);
        p[i] -= rate * m[i] / (std::sqrt(v[i]) * correction + eps);
      }
      offset += values.size();
    }
  }
};

}  // namespace evo
