#include "libevo/control/replanner.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

// Windows are planned so far ahead, and where they end in a fall, so many of them are planned
// again, so often in an episode.
constexpr std::size_t farthest_ahead = 8;
constexpr int taken_back = 3;
constexpr int most_retreats = 24;

// Beyond the end of a window counts for so many steps more what its last step earned: else
// plans would end in a fall.
constexpr double steps_beyond = 10.0;

// A step of the ascent, in the root of the mean square of a plan's entries; means of the
// gradient and of its square go back about 5 and 10 rounds.
constexpr double step_length = 0.15;
constexpr double momentum = 0.8;
constexpr double square_memory = 0.9;
constexpr double farthest = 2.5;  // of entries: targets are within 1.4 % of their range's ends

double arctanh(double x) { return 0.5 * math::log((1.0 + x) / (1.0 - x)); }

// As many steps as a window of plans in so many lanes may have for its tapes to stay within some
// memory; one at least.
std::size_t longest_window(const Model& model, int lanes) {
  constexpr std::int64_t most_bytes = std::int64_t{256} << 20U;
  constexpr std::int64_t bytes_a_point = 80;  // and substep
  std::int64_t points = 0;
  for (const ModelObject& object : model.objects()) points += object.is_static ? 0 : object.points;
  const std::int64_t bytes =
      std::int64_t{lanes} * model.physics().substeps * bytes_a_point * points;
  return static_cast<std::size_t>(std::max(most_bytes / bytes, std::int64_t{1}));
}

}  // namespace

Replanner::Replanner(const Arena& arena, const PlannerController& settings)
    : arena_(&arena),
      settings_(&settings),
      middle_(0.5 * (arena.task().physics.max_target + arena.task().physics.min_target)),
      half_(0.5 * (arena.task().physics.max_target - arena.task().physics.min_target)),
      env_(arena, std::max(settings.lanes, 1)) {
  if (std::min({settings.window, settings.committed, settings.rounds, settings.lanes}) < 1)
    throw Error(Failure::usage, "planner: window, committed, rounds and lanes are at least 1");
}

// ---- plans ------------------------------------------------------------------------------

// What a plan aims for at step k.
void Replanner::targets_of(const Plan& plan, std::size_t k, std::span<double> targets) const {
  const Physics& physics = arena_->task().physics;
  for (std::size_t i = 0; i < targets.size(); ++i)
    targets[i] = recorded_target(middle_ + half_ * math::tanh(plan[k * targets.size() + i]),
                                 physics.min_target, physics.max_target);
}

// The plan that aims for these, or nearly where they are at an end of their range.
Replanner::Plan Replanner::plan_of(std::span<const double> targets) const {
  const double end = math::tanh(farthest);
  Plan plan;
  for (const double target : targets)
    plan.push_back(arctanh(std::clamp((target - middle_) / half_, -end, end)));
  return plan;
}

// Next to nothing, at random.
Replanner::Plan Replanner::faint(std::size_t steps, Stream& random) const {
  Plan plan;
  for (std::size_t i = 0; i < steps * actuators(); ++i)
    plan.push_back(0.3 * random.gaussian() - 0.2);
  return plan;
}

// The plan after its first steps have been done, as long as `steps`: what is missing at its end
// is what came half a window before.
Replanner::Plan Replanner::continued(const Plan& plan, std::size_t done, std::size_t steps) const {
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

// The plan with noise that changes slowly, of this deviation.
Replanner::Plan Replanner::noisy(Plan plan, double size, Stream& random) const {
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

// What is left of the last plan, or of the sequence; the same with noise.
std::vector<Replanner::Plan> Replanner::first_plans(const Part& before, int t, std::size_t window,
                                                    Stream& random) const {
  const std::size_t a = actuators();
  std::vector<Plan> plans;
  if (settings_->sequence) {
    std::vector<double> targets(window * a);
    for (std::size_t k = 0; k < window; ++k)
      evo::act(*settings_->sequence, t + static_cast<int>(k), std::span(targets).subspan(k * a, a));
    plans.push_back(plan_of(targets));
  }
  const auto done = static_cast<std::size_t>(before.steps);
  if (before.plan.size() > done * a) {
    plans.push_back(continued(before.plan, done, window));
  } else if (plans.empty()) {
    plans.push_back(faint(window, random));
  }
  const std::size_t bases = plans.size();
  const double size = settings_->sequence ? 0.1 : 0.23;
  for (std::size_t lane = bases; lane < static_cast<std::size_t>(settings_->lanes); ++lane)
    plans.push_back(noisy(plans[lane % bases], size * static_cast<double>(lane % 4 + 1), random));
  plans.resize(static_cast<std::size_t>(settings_->lanes));
  return plans;
}

// ---- the ascent -------------------------------------------------------------------------

void Replanner::simulate(std::span<const std::uint8_t> from, std::size_t window,
                         std::size_t committed, std::span<const Vec2> way) {
  std::vector<std::uint8_t> active(static_cast<std::size_t>(env_.environments()), 0);
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    env_.load(static_cast<int>(i), from);
    active[i] = 1;
    Lane& lane = lanes_[i];
    lane = {std::move(lane.plan), std::move(lane.mean), std::move(lane.square)};
  }
  tapes_.resize(std::max(tapes_.size(), window));
  std::vector<double> targets(active.size() * actuators(), 1.0);
  for (std::size_t k = 0; k < window; ++k) {
    if (std::find(active.begin(), active.end(), std::uint8_t{1}) == active.end()) break;
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (active[i] != 0)
        targets_of(lanes_[i].plan, k, std::span(targets).subspan(i * actuators(), actuators()));
    env_.step(targets, active, nullptr, way.empty() ? &tapes_[k] : nullptr);
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (active[i] == 0) continue;
      Lane& lane = lanes_[i];
      const int environment = static_cast<int>(i);
      lane.steps = k + 1;
      lane.is_over = env_.terminated()[i] != 0 || env_.truncated()[i] != 0;
      if (way.empty()) {
        lane.value += env_.rewards()[i];
        if (k + 1 == window && !lane.is_over) lane.value += steps_beyond * env_.rewards()[i];
      } else {
        // What a step off the way costs: the squares of all points' distances.
        double off_way = 0.0;
        const std::span<const Vec2> points = env_.positions(environment);
        for (std::size_t p = 0; p < points.size(); ++p) {
          const Vec2 aim = way[k * points.size() + p];
          for (const double off : {points[p].x - aim.x, points[p].y - aim.y}) {
            lane.off.push_back(off);
            off_way += off * off;
          }
        }
        lane.value -= off_way;
        if (k + 1 < window && lane.is_over)  // and the way leads on
          lane.value = -std::numeric_limits<double>::infinity();
      }
      if (env_.status(environment) == LaneStatus::unstable) {
        lane.value = -std::numeric_limits<double>::infinity();
        lane.is_over = true;
      } else if (lane.steps == committed) {
        lane.after = env_.save(environment);
      }
      if (lane.is_over) active[i] = 0;
    }
  }
}

void Replanner::climb(std::size_t window) {
  const std::size_t a = actuators();
  const auto environments = static_cast<std::size_t>(env_.environments());
  std::vector<Gradient> gradients(environments, zero_gradient(arena_->model()));
  std::vector<double> by_rewards(environments, 1.0 + steps_beyond);
  std::vector<double> by_actions(environments * a);
  std::size_t longest = 0;
  for (Lane& lane : lanes_) {
    longest = std::max(longest, lane.steps);
    lane.mean.resize(lane.plan.size());
    lane.square.resize(lane.plan.size());
  }
  for (std::size_t k = longest; k-- > 0;) {
    if (k + 1 < window) std::fill(by_rewards.begin(), by_rewards.end(), 1.0);
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (lanes_[i].is_over) by_rewards[i] = 1.0;
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

// ---- back to the way --------------------------------------------------------------------

// Gauss-Newton without derivatives (Ralston and Jennrich, Technometrics 20, 1978): the Jacobian is
// known along the differences of the plans tried from the best one, [2 points x steps] x others.
void Replanner::come_back(int round, Stream& random) {
  using Eigen::Index;
  constexpr double damping = 0.01;  // of each difference alone
  for (Lane& lane : lanes_)
    if (std::isfinite(lane.value)) tried_.push_back(std::move(lane));
  if (tried_.empty()) return;
  std::iter_swap(tried_.begin(),
                 std::max_element(tried_.begin(), tried_.end(),
                                  [](const Lane& a, const Lane& b) { return a.value < b.value; }));
  const auto off = [&](Index i) {
    const std::vector<double>& values = tried_[static_cast<std::size_t>(i)].off;
    return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Index>(values.size()));
  };
  const auto others = static_cast<Index>(tried_.size()) - 1;
  Eigen::MatrixXd moved(off(0).size(), others);
  for (Index i = 0; i < others; ++i) moved.col(i) = off(i + 1) - off(0);
  Eigen::MatrixXd normal = moved.transpose() * moved;
  normal.diagonal() *= 1.0 + damping;
  normal.diagonal().array() += 1e-12;  // a plan may be there twice
  const Eigen::VectorXd shares = normal.ldlt().solve(-moved.transpose() * off(0));

  const Plan& best = tried_.front().plan;
  Plan next = best;
  for (std::size_t entry = 0; entry < next.size(); ++entry) {
    for (Index i = 0; i < others; ++i)
      next[entry] +=
          shares(i) * (tried_[static_cast<std::size_t>(i) + 1].plan[entry] - best[entry]);
    next[entry] = std::clamp(next[entry], -farthest, farthest);
  }
  const double size = std::ldexp(0.2, -round);
  for (Lane& lane : lanes_) lane = {&lane == &lanes_.front() ? next : noisy(next, size, random)};
}

// ---- windows ----------------------------------------------------------------------------

std::vector<Vec2> Replanner::way_of(const EpisodeStart& start) {
  env_.reset(0, {start.draws, 0.0, 0});
  const std::size_t a = actuators();
  std::vector<double> targets(a * static_cast<std::size_t>(env_.environments()), 1.0);
  std::vector<std::uint8_t> active(static_cast<std::size_t>(env_.environments()), 0);
  active[0] = 1;
  std::vector<Vec2> way;
  for (int t = 0; t < settings_->sequence->steps(); ++t) {
    evo::act(*settings_->sequence, t, std::span(targets).first(a));
    env_.step(targets, active);
    const auto points = env_.positions(0);
    way.insert(way.end(), points.begin(), points.end());
    if (env_.terminated()[0] != 0 || env_.truncated()[0] != 0) break;
  }
  return way;
}

// How long the episode is, or the way.
std::size_t Replanner::steps_of(const Episode& episode) const {
  return settings_->sequence ? episode.way.size() / env_.positions(0).size()
                             : static_cast<std::size_t>(arena_->task().episode_steps);
}

Replanner::Part Replanner::next_part(const Episode& episode, const Part& before, int t,
                                     Stream& random) {
  const auto done = static_cast<std::size_t>(t);
  const std::size_t points = env_.positions(0).size();
  std::size_t window =
      std::min(steps_of(episode) - done, static_cast<std::size_t>(settings_->window));
  std::span<const Vec2> way;
  if (settings_->sequence)
    way = std::span(episode.way).subspan(done * points, window * points);
  else
    window = std::min(window, longest_window(arena_->model(), settings_->lanes));
  lanes_.clear();
  tried_.clear();
  for (Plan& plan : first_plans(before, t, window, random)) lanes_.push_back({std::move(plan)});
  const std::size_t committed = std::min(static_cast<std::size_t>(settings_->committed), window);
  Part best{lanes_.front().plan, static_cast<int>(committed), {}, false};
  double value = -std::numeric_limits<double>::infinity();
  for (int round = 0; round < settings_->rounds; ++round) {
    if (round > 0 && way.empty())
      climb(window);
    else if (round > 0)
      come_back(round, random);
    simulate(before.after, window, committed, way);
    for (Lane& lane : lanes_) {
      if (!(lane.value > value)) continue;
      value = lane.value;
      best.plan = lane.plan;
      best.after.clear();
      if (!lane.is_over || lane.steps > committed) best.after = std::move(lane.after);
      best.is_lost = lane.is_over && value < 0.0;
    }
  }
  return best;
}

void Replanner::plan_ahead(Episode& episode, int t, Stream& random) {
  const std::size_t most = settings_->sequence ? 1 : farthest_ahead;
  while (episode.ahead.size() < most) {
    const Part& before = episode.ahead.empty() ? episode.now : episode.ahead.back();
    int then = t;
    for (const Part& part : episode.ahead) then += part.steps;
    if (before.after.empty() || static_cast<std::size_t>(then) >= steps_of(episode)) return;
    Part next = next_part(episode, before, then, random);
    if (next.is_lost && !episode.ahead.empty() && episode.retreats > 0) {
      --episode.retreats;
      for (int k = 0; k < taken_back && !episode.ahead.empty(); ++k) episode.ahead.pop_back();
    } else {
      episode.ahead.push_back(std::move(next));
    }
  }
}

void Replanner::act(const VecEnv& env, int lane, int t, const EpisodeStart& start, Stream& random,
                    std::span<double> targets) {
  const auto place = static_cast<std::size_t>(lane);
  if (episodes_.size() <= place) episodes_.resize(place + 1);
  Episode& episode = episodes_[place];
  if (t == 0) {
    episode = {};
    if (settings_->sequence) episode.way = way_of(start);
    episode.now.after = env.save(lane);
    episode.retreats = most_retreats;
  }
  if (t == episode.since + episode.now.steps) plan_ahead(episode, t, random);
  if (t == episode.since + episode.now.steps && !episode.ahead.empty()) {
    episode.now = std::move(episode.ahead.front());
    episode.ahead.pop_front();
    episode.since = t;
  }
  // Beyond its end, a way's last targets stay.
  const int last = static_cast<int>(episode.now.plan.size() / targets.size()) - 1;
  targets_of(episode.now.plan, static_cast<std::size_t>(std::min(t - episode.since, last)),
             targets);
}

}  // namespace evo
