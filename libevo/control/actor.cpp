#include "libevo/control/actor.h"

#include <variant>

#include "libevo/base/error.h"
#include "libevo/base/overloaded.h"

namespace evo {
namespace {

void require_length(const char* what, std::ptrdiff_t has, int needs) {
  if (has != needs)
    throw error(Failure::data, "the controller has {} {}, robot and task need {}", has, what,
                needs);
}

void require_fit(const SineController& sine, const Arena& arena) {
  require_length("amplitudes", std::ssize(sine.amplitude), arena.action_length());
  require_length("phases", std::ssize(sine.phase), arena.action_length());
  if (!sine.shift.empty()) require_length("shifts", std::ssize(sine.shift), arena.action_length());
}

void require_fit(const Policy& policy, const Arena& arena) {
  require_length("inputs", policy.observation_length(), arena.observation_length());
  require_length("outputs", policy.action_length(), arena.action_length());
  if (policy.base) std::visit([&](const auto& base) { require_fit(base, arena); }, *policy.base);
}

}  // namespace

void require_fit(const ReplayController& sequence, const Arena& arena) {
  const auto actions = static_cast<std::size_t>(arena.action_length());
  if (sequence.actions.empty() || sequence.actuators != arena.action_length() ||
      sequence.actions.size() % actions != 0)
    throw error(Failure::data, "{} recorded actions for {} actuators do not fit {} actuators",
                sequence.actions.size(), sequence.actuators, actions);
}

Actor::Actor(const TrainedController& controller, const Arena& arena) : controller_(&controller) {
  std::visit(Overloaded{[&](const ModularPolicy& policy) { modular_.emplace(policy, arena); },
                        [&](const auto& for_one_body) { require_fit(for_one_body, arena); }},
             controller);
}

void Actor::act(const VecEnv& env, int first, std::span<const int> steps,
                std::span<double> targets) {
  const Overloaded by_kind{
      [&](const ModularPolicy&) { modular_->act(env, first, steps, targets); },
      [&](const Policy& policy) {
        const auto seen = static_cast<std::size_t>(policy.observation_length());
        evo::act(policy,
                 env.observations().subspan(env.observation_offset(first), steps.size() * seen),
                 steps, targets, scratch_);
      },
      [&](const auto& open_loop) {
        const std::size_t actions = targets.size() / steps.size();
        for (std::size_t e = 0; e < steps.size(); ++e)
          evo::act(open_loop, steps[e], targets.subspan(e * actions, actions));
      }};
  std::visit(by_kind, *controller_);
}

}  // namespace evo
