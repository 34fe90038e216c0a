// Reward terms: for each what it measures of a step. See docs/tasks.md, "Rewards and ends".
#include <cmath>
#include <numbers>

#include "libevo/base/overloaded.h"
#include "libevo/task/binder.h"

namespace evo {
namespace {

using compiled::Step;
using compiled::Term;

constexpr double pi = std::numbers::pi;

Term change(std::size_t quantity) {
  return [quantity](const Step& step) { return step.post[quantity] - step.pre[quantity]; };
}

Term bind_one(const reward::Displacement& term, Binder& bind) {
  return change(bind.centre(term.of, term.axis));
}

Term bind_one(const reward::Distance& term, Binder& bind) {
  return [centre = bind.centre(term.of, term.axis)](const Step& step) {
    return std::abs(step.post[centre] - step.pre[centre]);
  };
}

Term bind_one(const reward::Approach& term, Binder& bind) {
  const std::size_t centre = bind.centre(term.of, term.axis);
  return std::visit(
      Overloaded{[&](const std::string& object) -> Term {
                   return [centre, target = bind.centre(object, term.axis)](const Step& step) {
                     return std::abs(step.pre[centre] - step.pre[target]) -
                            std::abs(step.post[centre] - step.post[target]);
                   };
                 },
                 [&](double place) -> Term {
                   return [centre, target = bind.raw(place)](const Step& step) {
                     return std::abs(target - step.pre[centre]) -
                            std::abs(target - step.post[centre]);
                   };
                 }},
      term.to);
}

Term bind_one(const reward::HullArea& term, Binder& bind) {
  return change(bind.hull_area(term.of));
}

Term bind_one(const reward::Extent& term, Binder& bind) {
  return change(bind.extent(term.of, term.axis));
}

// A jump from near 0 to near 2 pi, or back, is a whole turn begun (Flipper-v0).
Term bind_one(const reward::Rotation& term, Binder& bind) {
  return [angle = bind.orientation(term.of)](const Step& step) {
    const double before = step.pre[angle];
    const double after = step.post[angle];
    double turns = 0.0;
    if (before < pi / 3.0 && after > 5.0 * pi / 3.0) turns = -1.0;
    if (before > 5.0 * pi / 3.0 && after < pi / 3.0) turns = 1.0;
    return 2.0 * pi * turns + after - before;
  };
}

Term bind_one(const reward::GoalApproach& term, Binder& bind) {
  bind.need_goals(term.name);
  return [robot = bind.centre(robot_name, Axis::x), voxel = bind.voxel_length()](const Step& step) {
    const double goal = current_goal(step.episode, voxel);
    return std::abs(goal - step.pre[robot]) - std::abs(goal - step.post[robot]);
  };
}

Term bind_one(const reward::Effort&, Binder&) {
  return [](const Step& step) {
    double sum = 0.0;
    for (const double target : step.targets) sum += (target - 1.0) * (target - 1.0);
    return sum;
  };
}

Term bind_one(const reward::ActionChange&, Binder&) {
  return [](const Step& step) {
    double sum = 0.0;
    for (std::size_t i = 0; i < step.targets.size(); ++i) {
      const double before = step.episode.targets.empty() ? 1.0 : step.episode.targets[i];
      sum += (step.targets[i] - before) * (step.targets[i] - before);
    }
    return sum;
  };
}

}  // namespace

compiled::Term bind_term(const reward::Term& term, Binder& bind) {
  return std::visit([&](const auto& t) { return bind_one(t, bind); }, term);
}

}  // namespace evo
