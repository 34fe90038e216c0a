#include "libevo/task/step_tape.h"

#include <algorithm>
#include <utility>

#include "libevo/task/compiled.h"

namespace evo {
namespace {

using Step = StepTape::Impl::Step;

// Derivatives by points of the world to those by the points that can move.
void add_moving(const Model& model, std::span<const Vec2> by_points, std::vector<Vec2>& by_moving) {
  std::size_t to = 0;
  for (const ModelObject& object : model.objects()) {
    if (object.is_static) continue;
    for (int i = 0; i < object.points; ++i, ++to)
      by_moving[to] += by_points[static_cast<std::size_t>(object.first_point + i)];
  }
}

// What one step of one environment adds to the simulation's derivatives.
class StepAdjoint {
 public:
  explicit StepAdjoint(const Step& step)
      : step_(step),
        arena_(step.arena->compiled()),
        by_before_(arena_.quantities),
        by_after_(arena_.quantities),
        by_targets_(step.targets.size()),
        by_targets_before_(step.targets.size()) {
    for (const double target : step.targets) clipped_.push_back(arena_.task.physics.clip(target));
  }

  // By what counts after the step: the rest, when the simulation's part is done.
  void begin(double by_reward, std::span<const double> by_observations, Gradient& gradient) {
    reward(by_reward);
    std::vector<Vec2> by_positions(step_.after.size());
    std::vector<Vec2> by_velocities(step_.after.size());
    if (!by_observations.empty()) observation(by_observations, by_positions, by_velocities);
    pull_back_measures(arena_, step_.initial_shapes, step_.after, by_after_, by_positions);
    const Model& model = step_.world->model;
    add_moving(model, by_positions, gradient.state.positions);
    add_moving(model, by_velocities, gradient.state.velocities);
    std::vector<double>& targets = gradient.state.targets;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const bool is_free = clipped_[i] == step_.targets[i];
      targets[i] = is_free ? targets[i] + by_targets_[i] : 0.0;
    }
  }

  void end(Gradient& gradient, std::span<double> by_actions) {
    std::vector<Vec2> by_positions(step_.before.size());
    pull_back_measures(arena_, step_.initial_shapes, step_.before, by_before_, by_positions);
    add_moving(step_.world->model, by_positions, gradient.state.positions);
    std::copy(gradient.state.targets.begin(), gradient.state.targets.end(), by_actions.begin());
    gradient.state.targets = by_targets_before_;
  }

 private:
  void reward(double by_reward) {
    if (by_reward == 0.0) return;
    Episode episode = step_.episode;
    episode.goal = step_.goal;
    ++episode.steps;
    const compiled::Step seen{episode, step_.quantities_before, step_.quantities_after, clipped_};
    compiled::StepSlopes slopes{by_before_, by_after_, by_targets_, by_targets_before_};
    for (const compiled::WeightedTerm& term : arena_.terms)
      if (all_hold(term.when, seen)) term.term.pull_back(seen, by_reward * term.weight, slopes);
  }

  void observation(std::span<const double> by_observations, std::span<Vec2> by_positions,
                   std::span<Vec2> by_velocities) {
    const compiled::View seen{
        step_.episode, {step_.after, {}}, step_.quantities_after, step_.world->terrains};
    compiled::ViewSlopes slopes{by_positions, by_velocities, by_after_};
    for (std::size_t i = 0; i < arena_.parts.size(); ++i) {
      const auto& [name, offset, length] = arena_.layout[i];
      if (!arena_.parts[i].pull_back) continue;
      arena_.parts[i].pull_back(
          seen,
          by_observations.subspan(step_.observation_offset + static_cast<std::size_t>(offset),
                                  static_cast<std::size_t>(length)),
          slopes);
    }
  }

  const Step& step_;
  const Arena::Compiled& arena_;
  std::vector<double> clipped_;
  std::vector<double> by_before_, by_after_;  // quantities
  std::vector<double> by_targets_, by_targets_before_;
};

}  // namespace

StepTape::StepTape(double onset) : impl_(std::make_unique<Impl>(onset)) {}
StepTape::~StepTape() = default;
StepTape::StepTape(StepTape&&) noexcept = default;

void StepTape::pull_back(std::span<const double> by_rewards,
                         std::span<const double> by_observations, std::span<Gradient> gradients,
                         std::span<double> by_actions, ThreadPool* pool) const {
  const std::vector<Step>& steps = impl_->steps;
  std::vector<StepAdjoint> adjoints;
  const auto for_each = [&](auto visit) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < steps.size(); ++i)
      if (steps[i].is_active && steps[i].is_done) visit(i, adjoints[next++]);
  };
  for (const Step& step : steps)
    if (step.is_active && step.is_done) adjoints.emplace_back(step);
  for_each([&](std::size_t i, StepAdjoint& adjoint) {
    adjoint.begin(by_rewards[i], by_observations, gradients[i]);
  });
  impl_->simulation.pull_back(gradients, pool);
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (steps[i].is_active)
      std::fill_n(by_actions.begin() + static_cast<std::ptrdiff_t>(steps[i].action_offset),
                  steps[i].targets.size(), 0.0);
  for_each([&](std::size_t i, StepAdjoint& adjoint) {
    adjoint.end(gradients[i], by_actions.subspan(steps[i].action_offset));
  });
}

}  // namespace evo
