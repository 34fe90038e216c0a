#include "libevo/control/planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libevo/base/elementary.h"

namespace evo {
namespace {

// Beyond the end of a window counts for so many steps more what its last step earned: else
// plans would end in a fall.
constexpr double goes_on = 10.0;

// A step of the ascent, in the root of the mean square of a plan's entries; means of the
// gradient and of its square go back about 5 and 10 rounds.
constexpr double step_length = 0.15;
constexpr double momentum = 0.8;
constexpr double square_memory = 0.9;
constexpr double farthest = 2.5;  // of entries: targets are within 1.4 % of their range's ends

constexpr std::int64_t most_bytes = std::int64_t{256} << 20U;  // of tapes
constexpr std::int64_t bytes_a_point = 80;                     // and substep

double arctanh(double x) { return 0.5 * math::log((1.0 + x) / (1.0 - x)); }

}  // namespace

Planner::Planner(const Arena& arena)
    : arena_(&arena),
      middle_(0.5 * (arena.task().physics.max_target + arena.task().physics.min_target)),
      half_(0.5 * (arena.task().physics.max_target - arena.task().physics.min_target)) {}

int Planner::longest_window(int lanes) const {
  const Model& model = arena_->model();
  std::int64_t bytes = std::int64_t{lanes} * model.physics().substeps * bytes_a_point;
  std::int64_t points = 0;
  for (const ModelObject& object : model.objects()) points += object.is_static ? 0 : object.points;
  return static_cast<int>(most_bytes / (bytes * points));
}

double Planner::target(double value) const {
  constexpr double resolution = 1024.0;
  const Physics& physics = arena_->task().physics;
  const double least = std::ceil(physics.min_target * resolution);
  const double most = std::floor(physics.max_target * resolution);
  return std::clamp(std::round(value * resolution), least, most) / resolution;
}

void Planner::targets_of(const Plan& plan, std::size_t k, std::span<double> targets) const {
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i] = target(middle_ + half_ * math::tanh(plan[k * targets.size() + i]));
}

Plan Planner::plan_of(std::span<const double> targets) const {
  const double end = math::tanh(farthest);
  Plan plan;
  for (const double target : targets)
    plan.push_back(arctanh(std::clamp((target - middle_) / half_, -end, end)));
  return plan;
}

void Planner::begin(std::vector<Plan> plans) {
  window_ = plans.front().size() / actuators();
  lanes_.resize(plans.size());
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const std::size_t size = plans[i].size();
    lanes_[i] = {std::move(plans[i]), std::vector<double>(size), std::vector<double>(size)};
  }
  tapes_.resize(std::max(tapes_.size(), window_));
}

const std::vector<Planner::Outcome>& Planner::simulate(VecEnv& env,
                                                       std::span<const std::uint8_t> from,
                                                       std::int64_t& steps,
                                                       const Stepped& stepped) {
  environments_ = static_cast<std::size_t>(env.environments());
  outcomes_.assign(lanes_.size(), {});
  std::vector<std::uint8_t> active(environments_, 0);
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    env.load(static_cast<int>(i), from);
    active[i] = 1;
    lanes_[i].steps = 0;
  }
  std::vector<double> targets(active.size() * actuators(), 1.0);
  for (std::size_t k = 0; k < window_; ++k) {
    const std::int64_t running = std::count(active.begin(), active.end(), std::uint8_t{1});
    if (running == 0) break;
    const auto row = [&](std::size_t lane) {
      return std::span(targets).subspan(lane * actuators(), actuators());
    };
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (active[i] != 0) targets_of(lanes_[i].plan, k, row(i));
    env.step(targets, active, nullptr, &tapes_[k]);
    steps += running;
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (active[i] == 0) continue;
      Outcome& outcome = outcomes_[i];
      lanes_[i].steps = k + 1;
      const bool is_unstable = env.status(static_cast<int>(i)) == LaneStatus::unstable;
      outcome.value += env.rewards()[i];
      outcome.is_over = env.terminated()[i] != 0 || env.truncated()[i] != 0;
      if (is_unstable) outcome = {-std::numeric_limits<double>::infinity(), true};
      if (outcome.is_over) active[i] = 0;
      if (k + 1 == window_ && !outcome.is_over) outcome.value += goes_on * env.rewards()[i];
      if (!is_unstable) stepped(i, row(i));
    }
  }
  return outcomes_;
}

void Planner::climb() {
  const std::size_t a = actuators();
  std::vector<Gradient> gradients(environments_, zero_gradient(arena_->model()));
  std::vector<double> by_rewards(environments_, 1.0 + goes_on);
  std::vector<double> by_actions(environments_ * a);
  std::size_t longest = 0;
  for (const Lane& lane : lanes_) longest = std::max(longest, lane.steps);
  for (std::size_t k = longest; k-- > 0;) {
    if (k + 1 < window_) std::fill(by_rewards.begin(), by_rewards.end(), 1.0);
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (outcomes_[i].is_over) by_rewards[i] = 1.0;
    tapes_[k].pull_back(by_rewards, {}, gradients, by_actions);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      Lane& lane = lanes_[i];
      if (lane.steps <= k) continue;
      for (std::size_t j = 0; j < a; ++j) {
        const std::size_t entry = k * a + j;
        const double squashed = math::tanh(lane.plan[entry]);
        double by_entry = by_actions[i * a + j] * half_ * (1.0 - squashed * squashed);
        if (!std::isfinite(by_entry)) by_entry = 0.0;
        lane.mean[entry] = momentum * lane.mean[entry] + (1.0 - momentum) * by_entry;
        lane.square[entry] =
            square_memory * lane.square[entry] + (1.0 - square_memory) * by_entry * by_entry;
      }
    }
  }
  for (Lane& lane : lanes_) {
    double square = 0.0;
    for (const double value : lane.square) square += value;
    const double norm = math::sqrt(square / static_cast<double>(lane.plan.size()));
    if (!(norm > 0.0) || !std::isfinite(norm)) continue;
    for (std::size_t entry = 0; entry < lane.plan.size(); ++entry)
      lane.plan[entry] =
          std::clamp(lane.plan[entry] + step_length * lane.mean[entry] / norm, -farthest, farthest);
  }
}

}  // namespace evo
