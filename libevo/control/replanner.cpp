#include "libevo/control/replanner.h"

#include <algorithm>
#include <limits>

#include "libevo/base/error.h"

namespace evo {
namespace {

// Windows are planned so far ahead, and where they end in a fall, so many of them are planned
// again, so often in an episode.
constexpr std::size_t farthest_ahead = 8;
constexpr int taken_back = 3;
constexpr int most_retreats = 24;

}  // namespace

Replanner::Replanner(const Arena& arena, const PlannerController& settings)
    : arena_(&arena),
      settings_(&settings),
      planner_(arena),
      env_(arena, std::max(settings.lanes, 1)) {
  if (std::min({settings.window, settings.committed, settings.rounds, settings.lanes}) < 1)
    throw Error(Failure::usage, "planner: window, committed, rounds and lanes are at least 1");
}

std::vector<Vec2> Replanner::way_of(const EpisodeStart& start) {
  env_.reset(0, {start.draws, 0.0, 0});
  const auto a = static_cast<std::size_t>(arena_->action_length());
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

// What is left of the last plan, or of the sequence; the same with noise.
std::vector<Plan> Replanner::first_plans(const Part& before, int t, std::size_t window,
                                         Stream& random) const {
  const auto a = static_cast<std::size_t>(arena_->action_length());
  std::vector<Plan> plans;
  if (settings_->sequence) {
    std::vector<double> targets(window * a);
    for (std::size_t k = 0; k < window; ++k)
      evo::act(*settings_->sequence, t + static_cast<int>(k), std::span(targets).subspan(k * a, a));
    plans.push_back(planner_.plan_of(targets));
  }
  const auto done = static_cast<std::size_t>(before.steps);
  if (before.plan.size() > done * a) {
    plans.push_back(planner_.continued(before.plan, done, window));
  } else if (plans.empty()) {
    plans.push_back(planner_.faint(window, random));
  }
  const std::size_t bases = plans.size();
  const double size = settings_->sequence ? 0.1 : 0.23;
  for (std::size_t lane = bases; lane < static_cast<std::size_t>(settings_->lanes); ++lane)
    plans.push_back(
        planner_.noisy(plans[lane % bases], size * static_cast<double>(lane % 4 + 1), random));
  plans.resize(static_cast<std::size_t>(settings_->lanes));
  return plans;
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
  const auto longest = static_cast<std::size_t>(
      std::max(1, std::min(settings_->window, planner_.longest_window(settings_->lanes))));
  const std::size_t window = std::min(steps_of(episode) - done, longest);
  std::vector<Plan> plans = first_plans(before, t, window, random);
  Part best{plans.front(), std::min(settings_->committed, static_cast<int>(window)), {}, false};
  std::span<const Vec2> way;
  if (settings_->sequence) way = std::span(episode.way).subspan(done * points, window * points);
  planner_.begin(std::move(plans), way);
  double value = -std::numeric_limits<double>::infinity();
  for (int round = 0; round < settings_->rounds; ++round) {
    if (round > 0) planner_.climb();
    const auto lanes = static_cast<std::size_t>(settings_->lanes);
    std::vector<std::vector<std::uint8_t>> after(lanes);
    std::vector<int> stepped(lanes, 0);
    const auto& outcomes = planner_.simulate(env_, before.after, [&](std::size_t lane) {
      if (++stepped[lane] == best.steps) after[lane] = env_.save(static_cast<int>(lane));
    });
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (!(outcomes[lane].value > value)) continue;
      value = outcomes[lane].value;
      const bool is_over = stepped[lane] <= best.steps && outcomes[lane].is_over;
      best = {planner_.plan(lane), best.steps,
              is_over ? std::vector<std::uint8_t>() : std::move(after[lane]),
              outcomes[lane].is_over && value < 0.0};
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
  planner_.targets_of(episode.now.plan, static_cast<std::size_t>(std::min(t - episode.since, last)),
                      targets);
}

}  // namespace evo
