#include "libevo/control/planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libevo/base/elementary.h"
#include "libevo/control/replay.h"

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

void Planner::targets_of(const Plan& plan, std::size_t k, std::span<double> targets) const {
  const Physics& physics = arena_->task().physics;
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i] = recorded_target(middle_ + half_ * math::tanh(plan[k * targets.size() + i]),
                                 physics.min_target, physics.max_target);
}

Plan Planner::plan_of(std::span<const double> targets) const {
  const double end = math::tanh(farthest);
  Plan plan;
  for (const double target : targets)
    plan.push_back(arctanh(std::clamp((target - middle_) / half_, -end, end)));
  return plan;
}

Plan Planner::faint(std::size_t steps, Stream& random) const {
  Plan plan;
  for (std::size_t i = 0; i < steps * actuators(); ++i)
    plan.push_back(0.3 * random.gaussian() - 0.2);
  return plan;
}

Plan Planner::continued(const Plan& plan, std::size_t done, std::size_t steps) const {
  const std::size_t a = actuators();
  const std::size_t left = plan.size() / a - done;
  const std::size_t half = std::max<std::size_t>(1, std::min(left, steps / 2));
  Plan next;
  for (std::size_t k = 0; k < steps; ++k) {
    const std::size_t from = done + (k < left ? k : left - half + (k - left) % half);
    next.insert(next.end(), plan.begin() + static_cast<std::ptrdiff_t>(from * a),
                plan.begin() + static_cast<std::ptrdiff_t>((from + 1) * a));
  }
  return next;
}

Plan Planner::noisy(Plan plan, double size, Stream& random) const {
  constexpr double kept = 0.85;  // of noise, from step to step
  std::vector<double> noise(actuators());
  for (double& value : noise) value = random.gaussian();
  for (std::size_t i = 0; i < plan.size(); ++i) {
    double& value = noise[i % noise.size()];
    value = kept * value + std::sqrt(1.0 - kept * kept) * random.gaussian();
    plan[i] += size * value;
  }
  return plan;
}

void Planner::begin(std::vector<Plan> plans, std::span<const Vec2> way) {
  window_ = plans.front().size() / actuators();
  way_.assign(way.begin(), way.end());
  lanes_.resize(plans.size());
  for (std::size_t i = 0; i < plans.size(); ++i) {
    const std::size_t size = plans[i].size();
    lanes_[i] = {std::move(plans[i]), std::vector<double>(size), std::vector<double>(size), 0, {}};
  }
  tapes_.resize(std::max(tapes_.size(), window_));
}

// What a step off the way costs: the squares of all points' distances.
double Planner::stray(Lane& lane, std::size_t step, std::span<const Vec2> points) const {
  double value = 0.0;
  const auto aims = std::span(way_).subspan(step * points.size(), points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Vec2 off{points[p].x - aims[p].x, points[p].y - aims[p].y};
    lane.off.push_back(off);
    value -= off.x * off.x + off.y * off.y;
  }
  return value;
}

const std::vector<Planner::Outcome>& Planner::simulate(VecEnv& env,
                                                       std::span<const std::uint8_t> from,
                                                       const Stepped& stepped) {
  environments_ = static_cast<std::size_t>(env.environments());
  outcomes_.assign(lanes_.size(), {});
  std::vector<std::uint8_t> active(environments_, 0);
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    env.load(static_cast<int>(i), from);
    active[i] = 1;
    lanes_[i].steps = 0;
    lanes_[i].off.clear();
  }
  std::vector<double> targets(active.size() * actuators(), 1.0);
  for (std::size_t k = 0; k < window_; ++k) {
    if (std::find(active.begin(), active.end(), std::uint8_t{1}) == active.end()) break;
    const auto row = [&](std::size_t lane) {
      return std::span(targets).subspan(lane * actuators(), actuators());
    };
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (active[i] != 0) targets_of(lanes_[i].plan, k, row(i));
    env.step(targets, active, nullptr, &tapes_[k]);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (active[i] == 0) continue;
      Outcome& outcome = outcomes_[i];
      lanes_[i].steps = k + 1;
      const bool is_unstable = env.status(static_cast<int>(i)) == LaneStatus::unstable;
      outcome.is_over = env.terminated()[i] != 0 || env.truncated()[i] != 0;
      outcome.value +=
          way_.empty() ? env.rewards()[i] : stray(lanes_[i], k, env.positions(static_cast<int>(i)));
      if (is_unstable) outcome = {-std::numeric_limits<double>::infinity(), true};
      if (outcome.is_over) active[i] = 0;
      if (way_.empty() && k + 1 == window_ && !outcome.is_over)
        outcome.value += goes_on * env.rewards()[i];
      if (!way_.empty() && k + 1 < window_ && outcome.is_over)  // and the way leads on
        outcome.value = -std::numeric_limits<double>::infinity();
      if (!is_unstable) stepped(i);
    }
  }
  return outcomes_;
}

void Planner::climb() {
  const std::size_t a = actuators();
  std::vector<Gradient> gradients(environments_, zero_gradient(arena_->model()));
  const bool pays = way_.empty();
  std::vector<double> by_rewards(environments_, pays ? 1.0 + goes_on : 0.0);
  std::vector<double> by_actions(environments_ * a);
  std::size_t longest = 0;
  for (const Lane& lane : lanes_) longest = std::max(longest, lane.steps);
  for (std::size_t k = longest; k-- > 0;) {
    if (pays && k + 1 < window_) std::fill(by_rewards.begin(), by_rewards.end(), 1.0);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (pays && outcomes_[i].is_over) by_rewards[i] = 1.0;
      const std::size_t points = gradients[i].state.x.size();
      for (std::size_t p = 0; !pays && lanes_[i].steps > k && p < points; ++p) {
        const Vec2 off = lanes_[i].off[k * points + p];
        gradients[i].state.x[p] -= 2.0 * off.x;
        gradients[i].state.y[p] -= 2.0 * off.y;
      }
    }
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
