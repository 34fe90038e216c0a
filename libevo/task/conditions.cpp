// Conditions of rules and reward terms: for each what it compares. All look at the
// state after the step. See docs/tasks.md, "Rewards and ends".
#include <limits>
#include <numbers>

#include "libevo/task/binder.h"

namespace evo {
namespace {

using compiled::Step;
using compiled::Test;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double pi = std::numbers::pi;

Test bind_one(const condition::Position& position, Binder& bind) {
  const auto raw = [&](const std::optional<double>& bound, double none) {
    return bound ? bind.raw(*bound) : none;
  };
  return [centre = bind.centre(position.of, position.axis), above = raw(position.above, -infinity),
          below = raw(position.below, infinity), at_least = raw(position.at_least, -infinity),
          at_most = raw(position.at_most, infinity)](const Step& step) {
    const double value = step.post[centre];
    return value > above && value < below && value >= at_least && value <= at_most;
  };
}

Test bind_one(const condition::Tilt& tilt, Binder& bind) {
  const double lean = pi * (90.0 - tilt.degrees) / 180.0;
  return [angle = bind.orientation(tilt.of), above = pi / 2.0 - lean,
          below = 3.0 * pi / 2.0 + lean](const Step& step) {
    return step.post[angle] > above && step.post[angle] < below;
  };
}

Test bind_one(const condition::GoalsReached& condition, Binder& bind) {
  bind.need_goals(condition.name);
  return [](const Step& step) {
    return step.episode.goal == static_cast<int>(step.episode.draws.goals.size());
  };
}

}  // namespace

compiled::Test bind_condition(const Condition& condition, Binder& bind) {
  return std::visit([&](const auto& c) { return bind_one(c, bind); }, condition);
}

}  // namespace evo
