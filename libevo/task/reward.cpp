// Reward terms: for each what it measures of a step. See docs/tasks.md, "Rewards and ends".
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "libevo/base/overloaded.h"
#include "libevo/task/binder.h"

namespace evo {
namespace {

using compiled::Step;
using compiled::StepSlopes;
using compiled::Term;

constexpr double pi = std::numbers::pi;

double sign(double x) { return x < 0.0 ? -1.0 : 1.0; }

// How much a quantity grows.
Term change(std::size_t quantity) {
  return {[quantity](const Step& step) { return step.post[quantity] - step.pre[quantity]; },
          [quantity](const Step&, double share, StepSlopes& slopes) {
            slopes.post[quantity] += share;
            slopes.pre[quantity] -= share;
          }};
}

Term bind_one(const reward::Displacement& term, Binder& bind) {
  return change(bind.centre(term.of, term.axis));
}

Term bind_one(const reward::Distance& term, Binder& bind) {
  const std::size_t centre = bind.centre(term.of, term.axis);
  return {[centre](const Step& step) { return std::abs(step.post[centre] - step.pre[centre]); },
          [centre, change = change(centre)](const Step& step, double share, StepSlopes& slopes) {
            change.pull_back(step, share * sign(step.post[centre] - step.pre[centre]), slopes);
          }};
}

// |distance before| - |distance after| of a quantity from `target`, which looks at one of its
// own or at none.
template <typename Target>
Term nearness(std::size_t centre, Target target, std::optional<std::size_t> own = {}) {
  return {[=](const Step& step) {
            return std::abs(target(step, step.pre) - step.pre[centre]) -
                   std::abs(target(step, step.post) - step.post[centre]);
          },
          [=](const Step& step, double share, StepSlopes& slopes) {
            const auto add = [&](std::span<const double> at, double by, std::span<double> slope) {
              by *= sign(target(step, at) - at[centre]);
              slope[centre] -= by;
              if (own) slope[*own] += by;
            };
            add(step.pre, share, slopes.pre);
            add(step.post, -share, slopes.post);
          }};
}

Term bind_one(const reward::Approach& term, Binder& bind) {
  const std::size_t centre = bind.centre(term.of, term.axis);
  return std::visit(
      Overloaded{[&](const std::string& object) {
                   const std::size_t other = bind.centre(object, term.axis);
                   const auto target = [other](const Step&, std::span<const double> quantities) {
                     return quantities[other];
                   };
                   return nearness(centre, target, other);
                 },
                 [&](double place) {
                   const auto target = [raw = bind.raw(place)](const Step&, auto) { return raw; };
                   return nearness(centre, target);
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
  const std::size_t angle = bind.orientation(term.of);
  return {[angle](const Step& step) {
            const double before = step.pre[angle];
            const double after = step.post[angle];
            double turns = 0.0;
            if (before < pi / 3.0 && after > 5.0 * pi / 3.0) turns = -1.0;
            if (before > 5.0 * pi / 3.0 && after < pi / 3.0) turns = 1.0;
            return 2.0 * pi * turns + after - before;
          },
          change(angle).pull_back};
}

Term bind_one(const reward::GoalApproach& term, Binder& bind) {
  bind.need_goals(term.name);
  return nearness(bind.centre(robot_name, Axis::x),
                  [voxel = bind.voxel_length()](const Step& step, std::span<const double>) {
                    return current_goal(step.episode, voxel);
                  });
}

Term bind_one(const reward::Effort&, Binder&) {
  return {[](const Step& step) {
            double sum = 0.0;
            for (const double target : step.targets) sum += (target - 1.0) * (target - 1.0);
            return sum;
          },
          [](const Step& step, double share, StepSlopes& slopes) {
            for (std::size_t i = 0; i < step.targets.size(); ++i)
              slopes.targets[i] += 2.0 * share * (step.targets[i] - 1.0);
          }};
}

double target_before(const Step& step, std::size_t i) {
  return step.episode.targets.empty() ? 1.0 : step.episode.targets[i];
}

Term bind_one(const reward::ActionChange&, Binder&) {
  return {[](const Step& step) {
            double sum = 0.0;
            for (std::size_t i = 0; i < step.targets.size(); ++i) {
              const double before = target_before(step, i);
              sum += (step.targets[i] - before) * (step.targets[i] - before);
            }
            return sum;
          },
          [](const Step& step, double share, StepSlopes& slopes) {
            for (std::size_t i = 0; i < step.targets.size(); ++i) {
              const double by = 2.0 * share * (step.targets[i] - target_before(step, i));
              slopes.targets[i] += by;
              slopes.targets_before[i] -= by;
            }
          }};
}

}  // namespace

compiled::Term bind_term(const reward::Term& term, Binder& bind) {
  return std::visit([&](const auto& t) { return bind_one(t, bind); }, term);
}

}  // namespace evo
