// The controller PPO trains: two small networks, actor and critic, over a
// normalised observation and, if so set, a clock. Single precision. See
// docs/methods.md, "PPO in the paper"; in files docs/formats/policy.md.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "libevo/base/random.h"
#include "libevo/control/matrix.h"
#include "libevo/control/open_loop.h"

namespace evo {

struct Layer {
  Matrix weight;  // [outputs x inputs]
  Vector bias;    // [outputs]
  bool operator==(const Layer&) const = default;
};

// tanh after every layer but the last.
struct Network {
  std::vector<Layer> layers;
  bool operator==(const Network&) const = default;
};

// What every layer put out for a batch: [B x outputs], after its tanh.
using Activations = std::vector<Matrix>;

// Running mean and variance of observations. `epsilon` is added to the variance;
// the normalised observation is clipped to +-clip.
struct Normalizer {
  Eigen::VectorXd mean;
  Eigen::VectorXd variance;
  double count = 0.0;  // 0: observations pass unchanged but for the clip
  double clip = 10.0;
  double epsilon = 1e-8;
  bool operator==(const Normalizer&) const = default;
};

// How network outputs become actuator targets.
//   offset: target = clip(offset + a, low, high), as in the paper's code; with a
//           base, target = clip(base(t) + a, low, high)
//   squash: target = middle + half * tanh(a), bounded by construction
enum class ActionMap { offset, squash };
constexpr auto words_for(ActionMap) { return std::array{"offset", "squash"}; }

struct Policy {
  Network actor;
  Network critic;
  Vector log_std;  // [A], state-independent
  Normalizer normalizer;
  ActionMap action_map = ActionMap::offset;
  double action_offset = 1.0;
  double low = 0.6;
  double high = 1.6;
  // Periods in control steps: after the observation networks see sine and cosine
  // of 2 pi t / period of each.
  std::vector<double> clock;
  std::optional<OpenLoop> base;

  int observation_length() const;  // without the clock
  int action_length() const;
  bool operator==(const Policy&) const = default;
};

// The shape of the loss's gradient with respect to a policy's parameters.
struct Gradients {
  Network actor;
  Network critic;
  Vector log_std;
};

// Orthogonal initialisation (Saxe et al. 2014): gain `hidden_gain` before every
// tanh, `head_gain` for the last layer, zero biases.
Network orthogonal_network(int inputs, const std::vector<int>& hidden, int outputs,
                           double hidden_gain, double head_gain, Stream& stream);

// Y = network(X), X [B x D]; the result is activations.back().
void forward(const Network& network, const Matrix& x, Activations& activations);

// Adds to `gradient` what dL/dY [B x outputs], which is slopes.back(), means for the
// network's parameters. `activations` come from forward() with the same X. `slopes` has a
// matrix for every layer; the others are left with dL/d(what the layer's tanh gets).
void backward(const Network& network, const Matrix& x, const Activations& activations,
              std::vector<Matrix>& slopes, Network& gradient);

// Takes a batch [B x D] into the running moments (Chan, Golub, LeVeque 1979).
void update(Normalizer& normalizer, std::span<const double> observations);
// [B x D] doubles -> [B x D] floats.
void normalize(const Normalizer& normalizer, std::span<const double> observations, Matrix& out);

// What networks see of observations [E x D] at steps [E] of their episodes:
// [E x (D + 2 periods)].
void network_inputs(const Normalizer& normalizer, std::span<const double> clock,
                    std::span<const double> observations, std::span<const int> steps,
                    Matrix& inputs);
// What actions are added to at step t of an episode, [A].
void rest_targets(const Policy& policy, int t, std::span<double> targets);
// Actuator target of one network output, `rest` being what it is added to.
double target_of(const Policy& policy, double rest, double output);
double target_of(ActionMap map, double low, double high, double rest, double output);

// What a network sees and puts out, kept from call to call.
struct NetworkScratch {
  Matrix inputs;
  Activations activations;
};
// The deterministic controller: observations [E x D] at steps [E] of their episodes
// in, targets [E x A] out.
void act(const Policy& policy, std::span<const double> observations, std::span<const int> steps,
         std::span<double> targets, NetworkScratch& scratch);
void act(const Policy& policy, std::span<const double> observations, std::span<const int> steps,
         std::span<double> targets);

// All parameters as runs of floats, in one fixed order: actor, critic (weight,
// bias of every layer), log_std. The same for gradients, run by run.
template <typename Parameters>
class ParameterBlocks {
 public:
  using Block = std::span<std::conditional_t<std::is_const_v<Parameters>, const float, float>>;

  explicit ParameterBlocks(Parameters& parameters) : parameters_(&parameters) {}

  std::size_t size() const { return of_actor() + 2 * parameters_->critic.layers.size() + 1; }
  Block operator[](std::size_t i) const {
    if (i + 1 == size()) return block(parameters_->log_std);
    const bool actor = i < of_actor();
    auto& network = actor ? parameters_->actor : parameters_->critic;
    const std::size_t k = actor ? i : i - of_actor();
    auto& layer = network.layers[k / 2];
    return k % 2 == 0 ? block(layer.weight) : block(layer.bias);
  }

 private:
  std::size_t of_actor() const { return 2 * parameters_->actor.layers.size(); }
  template <typename Values>
  static Block block(Values& values) {
    return {values.data(), static_cast<std::size_t>(values.size())};
  }

  Parameters* parameters_;
};
std::size_t parameter_count(const Policy& policy);

// Gradients of the policy's shape, all zero.
Gradients zero_gradients(const Policy& policy);

}  // namespace evo
