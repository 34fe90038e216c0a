#include "formats/training/controller_fields.h"

#include <fmt/format.h>

namespace evo {
namespace {

using Problem = std::optional<std::string>;

// `inputs`: what the first layer gets.
Problem misfit_of(const Network& network, const char* name, Eigen::Index inputs) {
  for (std::size_t l = 0; l < network.layers.size(); ++l) {
    const Layer& layer = network.layers[l];
    if (layer.weight.cols() != inputs)
      return fmt::format("{}: layer {} takes {} numbers, there are {}", name, l,
                         layer.weight.cols(), inputs);
    inputs = layer.weight.rows();
    if (layer.bias.size() != inputs)
      return fmt::format("{}: layer {} has {} biases for {} rows of weights", name, l,
                         layer.bias.size(), inputs);
  }
  if (inputs == 0 || network.layers.empty()) return fmt::format("{}: no layers", name);
  return std::nullopt;
}

Problem misfit_of(const Normalizer& normalizer, const char* name) {
  if (normalizer.mean.size() == normalizer.variance.size()) return std::nullopt;
  return fmt::format("{}: {} means and {} variances", name, normalizer.mean.size(),
                     normalizer.variance.size());
}

template <typename AnyPolicy>
Problem misfit_of_bounds(const AnyPolicy& policy) {
  if (policy.low <= policy.high) return std::nullopt;
  return "the bounds of actions: two numbers, the lower one first, are expected";
}

Problem misfit_of(const SineController& sine) {
  const std::size_t n = sine.amplitude.size();
  if (sine.phase.size() != n || (!sine.shift.empty() && sine.shift.size() != n))
    return "a wave has as many amplitudes as phases and shifts";
  if (!(sine.period > 0.0)) return "the period of a wave is greater than 0";
  return std::nullopt;
}

Problem misfit_of(const ReplayController& sequence) {
  if (!sequence.actions.empty()) return std::nullopt;
  return "actions: the sequence is empty";
}

Problem misfit_of(const Policy& policy) {
  const auto clock = static_cast<Eigen::Index>(2 * policy.clock.size());
  const Eigen::Index inputs = policy.normalizer.mean.size() + clock;
  if (auto problem = misfit_of(policy.normalizer, "normalizer")) return problem;
  if (auto problem = misfit_of(policy.actor, "actor", inputs)) return problem;
  if (auto problem = misfit_of(policy.critic, "critic", inputs)) return problem;
  if (policy.critic.layers.back().bias.size() != 1)
    return "critic: its last layer has more than one output";
  const Eigen::Index outputs = policy.actor.layers.back().bias.size();
  if (policy.log_std.size() != outputs)
    return fmt::format("log_std: {} numbers for {} outputs", policy.log_std.size(), outputs);
  if (policy.base)
    if (auto problem = std::visit([](const auto& base) { return misfit_of(base); }, *policy.base))
      return problem;
  return misfit_of_bounds(policy);
}

Problem misfit_of(const ModularPolicy& policy) {
  if (auto problem = misfit_of(policy.local, "normalizer/local")) return problem;
  if (auto problem = misfit_of(policy.task, "normalizer/task")) return problem;
  if (policy.local.mean.size() != VoxelViews::local_length)
    return "normalizer/local: it is not as long as a voxel's view";
  if (auto problem = misfit_of_bounds(policy)) return problem;
  return defect(policy);
}

}  // namespace

std::optional<std::string> misfit(const TrainedController& controller) {
  return std::visit([](const auto& one) { return misfit_of(one); }, controller);
}

}  // namespace evo
