#include "libevo/control/sequence_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "libevo/base/elementary.h"
#include "libevo/base/error.h"

namespace evo {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

// The archive. A level of return is a twentieth of what first episodes reach; where returns grow
// to more than 200 levels, two become one. Times are every tenth step.
constexpr double levels_at_first = 20;
constexpr std::size_t most_levels = 200;
constexpr int slot = 10;  // control steps

// Where an attempt begins: a level's weight falls to 1/e six levels below the highest, and keeps a
// hundredth however low it is, since the highest may lead nowhere. Half of the attempts begin at
// a time instead, for what only counts at the end.
constexpr double depth = 6.0;
constexpr double anywhere = 0.01;
constexpr double time_share = 0.5;
constexpr double rest_share = 0.03;  // of attempts: a whole episode once more, after a rest

// How many control steps it lasts: a gait's shortest period (6) several times, or its longest (40)
// twice; and three steps more for every moment that it puts into the archive.
constexpr int shortest_attempt = 20;
constexpr int longest_attempt = 100;
constexpr int steps_gained = 3;

// What is tried from a moment on, all alike.
enum class AttemptKind {
  begin,   // a new gait
  change,  // the gait, changed
  push,    // a few targets held by groups of actuators, then the gait
  hold     // one target for each group
};
constexpr std::uint32_t attempt_kinds = 4;

}  // namespace

SequenceSearch::SequenceSearch(const Arena& arena, const TrainingSettings& settings,
                               const EvaluationSettings& evaluation, Stream random,
                               std::optional<OpenLoop> start)
    : arena_(&arena),
      settings_(settings),
      evaluation_(evaluation),
      places_(anatomy(arena.robot(), {}).actuators),
      random_(random),
      start_(std::move(start)),
      env_(arena, settings.environments),
      start_is_due_(start_.has_value()) {
  auto* gait = start_ ? std::get_if<SineController>(&*start_) : nullptr;
  if (gait != nullptr) gait->shift.resize(places_.size());
}

void SequenceSearch::offer(SineController gait) {
  gait.shift.resize(places_.size());
  start_ = std::move(gait);
  start_is_due_ = true;
}

int SequenceSearch::steps_of(const Moment& moment) const {
  return static_cast<int>(moment.actions.size() / places_.size());
}

std::int64_t SequenceSearch::level_of(double earned) const {
  return static_cast<std::int64_t>(std::floor(earned / level_height_));
}

double SequenceSearch::highest() const {
  return soonest_.empty() ? 0.0 : soonest_.rbegin()->second.earned;
}

// ---- what is tried -------------------------------------------------------------------

// Waves that travel over the body, each actuator for itself, or two groups against
// each other.
SineController SequenceSearch::new_gait() {
  enum Kind { travelling, independent, opposed };
  const int kind = random_.integer(travelling, opposed);
  const double half = 0.5 * (high() - low());
  const double amplitude = half * uniform(0.5, 2.5);  // beyond 1 it is cut off
  const double across = uniform(-1.5, 1.5);
  const double up = uniform(-1.5, 1.5);
  SineController gait;
  gait.middle = 0.0;
  gait.period = settings_.shortest_period *
                math::exp(math::log(settings_.longest_period / settings_.shortest_period) *
                          random_.uniform());
  for (const Anatomy::Place& place : places_) {
    const double phase = kind == travelling    ? across * place.col - up * place.row
                         : kind == independent ? two_pi * random_.uniform()
                                               : std::numbers::pi * random_.integer(0, 1);
    gait.phase.push_back(phase);
    gait.amplitude.push_back(amplitude * uniform(0.5, 1.0));
    gait.shift.push_back(low() + half + 0.3 * half * random_.gaussian());
  }
  return gait;
}

SineController SequenceSearch::changed(SineController gait) {
  constexpr double share = 0.3;  // of the numbers that change
  for (std::size_t i = 0; i < gait.phase.size(); ++i) {
    if (random_.uniform() < share) gait.phase[i] += 0.5 * random_.gaussian();
    if (random_.uniform() < share) gait.amplitude[i] *= math::exp(0.3 * random_.gaussian());
    if (random_.uniform() < share) gait.shift[i] += 0.1 * (high() - low()) * random_.gaussian();
  }
  gait.period = std::clamp(gait.period * math::exp(0.15 * random_.gaussian()),
                           settings_.shortest_period, 1.5 * settings_.longest_period);
  return gait;
}

// The moment of a level to continue from: weights fall off below the highest, and with
// every visit. None where all have come to the end of the episode.
SequenceSearch::Moment* SequenceSearch::choose_level() {
  std::vector<Moment*> moments;
  std::vector<double> weights;
  double rank = 0.0;
  for (auto it = soonest_.rbegin(); it != soonest_.rend(); ++it, rank += 1.0) {
    if (steps_of(it->second) >= episode_steps() - 1) continue;
    moments.push_back(&it->second);
    weights.push_back((math::exp(-rank / depth) + anywhere) / math::sqrt(it->second.visits + 1.0));
  }
  return moments.empty() ? nullptr : moments[random_.discrete(weights)];
}

// A moment of any time, little visited ones rather. None where there is none yet.
SequenceSearch::Moment* SequenceSearch::choose_time() {
  std::vector<Moment*> moments;
  std::vector<double> weights;
  for (auto& [time, moment] : highest_) {
    if (steps_of(moment) >= episode_steps() - 1) continue;
    moments.push_back(&moment);
    weights.push_back(1.0 / math::sqrt(moment.visits + 1.0));
  }
  return moments.empty() ? nullptr : moments[random_.discrete(weights)];
}

// A moment of a time or a level; none where all have come to the end of the episode.
SequenceSearch::Moment* SequenceSearch::choose() {
  const double place = random_.bits() * 0x1p-32;
  Moment* from = place < time_share ? choose_time() : nullptr;
  if (from == nullptr) from = choose_level();
  if (from != nullptr) ++from->visits;
  return from;
}

// The highest level that no episode has had at its end, of those not yet delayed.
SequenceSearch::Moment* SequenceSearch::choose_early() {
  if (ended_.empty()) return nullptr;
  const auto early = std::find_if(soonest_.rbegin(), soonest_.rend(),
                                  [](const auto& place) { return !place.second.delayed; });
  if (early == soonest_.rend() || early->second.earned < ended_return_ + level_height_)
    return nullptr;
  return &early->second;
}

// The end of the episode becomes the moment.
ReplayController SequenceSearch::after_a_rest(const Moment& moment) const {
  const auto rest = static_cast<std::size_t>(episode_steps() - steps_of(moment));
  ReplayController sequence{std::vector<double>(rest * places_.size(), target(1.0)),
                            static_cast<int>(places_.size())};
  sequence.actions.insert(sequence.actions.end(), moment.actions.begin(), moment.actions.end());
  return sequence;
}

SequenceSearch::Attempt SequenceSearch::whole_episode(OpenLoop replayed) {
  Attempt attempt;
  attempt.at = soonest_.at(level_of(0.0));
  attempt.steps_left = episode_steps();
  if (const auto* gait = std::get_if<SineController>(&replayed)) attempt.at.gait = *gait;
  attempt.replayed = std::move(replayed);
  return attempt;
}

SequenceSearch::Attempt SequenceSearch::attempt() {
  if (std::exchange(start_is_due_, false)) return whole_episode(*start_);
  if (random_.uniform() < rest_share) {
    if (Moment* early = choose_early()) {
      early->delayed = true;
      return whole_episode(after_a_rest(*early));
    }
  }
  Attempt attempt;
  Moment* from = choose();
  if (from == nullptr) return attempt;
  attempt.at = *from;
  attempt.steps_left = random_.integer(shortest_attempt, longest_attempt);
  SineController& gait = attempt.at.gait;
  using enum AttemptKind;
  const auto kind = static_cast<AttemptKind>(random_.below(attempt_kinds));
  if (gait.phase.empty() || kind == begin) gait = new_gait();
  if (kind == change) gait = changed(std::move(gait));
  if (kind == push || kind == hold) {
    attempt.pushes_left = kind == push ? random_.integer(4, 24) : episode_steps();
    attempt.held = kind == push ? random_.integer(2, 8) : episode_steps();
    attempt.values.resize(static_cast<std::size_t>(random_.integer(1, 3)));
    for (std::size_t i = 0; i < places_.size(); ++i)
      attempt.group.push_back(random_.below(static_cast<std::uint32_t>(attempt.values.size())));
  }
  return attempt;
}

void SequenceSearch::choose_targets(Attempt& attempt, std::span<double> targets) {
  const int t = steps_of(attempt.at);
  if (attempt.replayed) {
    std::visit([&](const auto& controller) { act(controller, t, targets); }, *attempt.replayed);
    for (double& value : targets) value = std::clamp(value, low(), high());
    return;
  }
  if (attempt.pushes_left > 0) {
    if (attempt.pushes_left-- % attempt.held == 0 || attempt.values.front() == 0.0)
      for (double& value : attempt.values) {
        const bool extreme = random_.uniform() < 0.6;
        const double any = random_.uniform();
        value = target(low() + (high() - low()) * (extreme ? std::round(any) : any));
      }
    for (std::size_t i = 0; i < targets.size(); ++i) targets[i] = attempt.values[attempt.group[i]];
    return;
  }
  act(attempt.at.gait, t, targets);
  for (double& value : targets) value = target(value);
}

// ---- exploration ---------------------------------------------------------------------

// Whole episodes, of random gaits or of what is inherited, say how high a level is.
std::int64_t SequenceSearch::measure_level_height(std::int64_t budget) {
  std::vector<ReplayController> episodes;
  const int count = start_ ? 1 : settings_.environments;
  if (budget < std::int64_t{count} * episode_steps()) return 0;
  for (int e = 0; e < count; ++e) {
    Attempt episode;
    episode.replayed = start_;
    if (!start_) episode.at.gait = new_gait();
    std::vector<double> targets(places_.size());
    for (int t = 0; t < episode_steps(); ++t) {
      choose_targets(episode, targets);
      episode.at.actions.insert(episode.at.actions.end(), targets.begin(), targets.end());
    }
    episodes.push_back(whole(episode.at.actions));
  }
  EvaluationSettings first = evaluation_;
  first.episodes = 1;
  const OpenLoopEvaluation result = evaluate_each(*arena_, episodes, first);
  const double peak = *std::max_element(result.peaks.begin(), result.peaks.end());
  const double least = *std::min_element(result.means.begin(), result.means.end());
  const double range = peak > 0.0 ? peak : peak - least;
  level_height_ = std::max(range / levels_at_first, 1e-6);
  return result.steps;
}

void SequenceSearch::begin() {
  env_.reset(0, start_of(*arena_, evaluation_, 0));
  Moment first;
  first.state = env_.save(0);
  soonest_[level_of(0.0)] = std::move(first);
}

// The state that an attempt has come to, at its place among the moments.
void SequenceSearch::enter(Moments& moments, std::int64_t place, Attempt& attempt, int lane) {
  const auto [there, is_new] = moments.try_emplace(place);
  const int visits = is_new ? 0 : there->second.visits / 2;
  there->second = attempt.at;
  there->second.state = env_.save(lane);
  there->second.visits = visits;
  there->second.delayed = false;
  attempt.steps_left += steps_gained;
}

void SequenceSearch::enter(Attempt& attempt, int lane) {
  const Moment& at = attempt.at;
  const std::int64_t level = level_of(at.earned);
  const auto old_level = soonest_.find(level);
  if (old_level == soonest_.end() || steps_of(at) < steps_of(old_level->second))
    enter(soonest_, level, attempt, lane);
  if (steps_of(at) % slot == 0) {
    const std::int64_t time = steps_of(at) / slot;
    const auto old_time = highest_.find(time);
    if (old_time == highest_.end() || at.earned > old_time->second.earned)
      enter(highest_, time, attempt, lane);
  }
  if (soonest_.size() > most_levels) coarsen();
}

// Levels twice as high; of two that become one, the sooner stays.
void SequenceSearch::coarsen() {
  level_height_ *= 2.0;
  Moments fine = std::exchange(soonest_, {});
  for (auto& [level, moment] : fine) {
    const auto [place, is_new] = soonest_.try_emplace(level_of(moment.earned), std::move(moment));
    if (!is_new && steps_of(moment) < steps_of(place->second)) place->second = std::move(moment);
  }
}

// What a step of a lane came to. False where nothing can follow in its episode.
bool SequenceSearch::note(Attempt& attempt, std::size_t lane, std::span<const double> targets) {
  Moment& at = attempt.at;
  at.actions.insert(at.actions.end(), targets.begin(), targets.end());
  at.earned += env_.rewards()[lane];
  --attempt.steps_left;
  if (env_.status(static_cast<int>(lane)) == LaneStatus::unstable || !std::isfinite(at.earned))
    return false;
  if (env_.terminated()[lane] != 0 || env_.truncated()[lane] != 0) {
    if (ended_.empty() || at.earned > ended_return_) {
      ended_ = at.actions;
      ended_return_ = at.earned;
      ended_is_new_ = true;
    }
    return false;
  }
  enter(attempt, static_cast<int>(lane));
  return true;
}

std::int64_t SequenceSearch::explore(std::int64_t budget) {
  std::int64_t taken = 0;
  if (soonest_.empty()) {
    taken += measure_level_height(budget);
    if (level_height_ == 0.0) return 0;
    begin();
  }
  const auto lanes = static_cast<std::size_t>(settings_.environments);
  std::vector<Attempt> attempts(lanes);
  std::vector<std::uint8_t> active(lanes, 0);
  std::vector<double> targets(lanes * places_.size(), 1.0);
  const auto start = [&](std::size_t lane) {
    attempts[lane] = attempt();
    active[lane] = attempts[lane].steps_left > 0 ? 1 : 0;
    if (active[lane] != 0)
      env_.load(static_cast<int>(lane), std::exchange(attempts[lane].at.state, {}));
  };
  for (std::size_t lane = 0; lane < lanes; ++lane) start(lane);
  while (true) {
    const std::int64_t running = std::count(active.begin(), active.end(), std::uint8_t{1});
    if (running == 0 || taken + running > budget) return taken;
    for (std::size_t lane = 0; lane < lanes; ++lane)
      if (active[lane] != 0)
        choose_targets(attempts[lane],
                       std::span(targets).subspan(lane * places_.size(), places_.size()));
    env_.step(targets, active);
    taken += running;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (active[lane] == 0) continue;
      const auto row = std::span(targets).subspan(lane * places_.size(), places_.size());
      if (!note(attempts[lane], lane, row) || attempts[lane].steps_left <= 0) start(lane);
    }
  }
}

ReplayController SequenceSearch::whole(const std::vector<double>& actions) const {
  ReplayController sequence{actions, static_cast<int>(places_.size())};
  if (actions.empty()) sequence.actions.assign(places_.size(), target(1.0));
  fit(sequence, episode_steps());
  return sequence;
}

std::vector<ReplayController> SequenceSearch::news() {
  std::vector<ReplayController> sequences;
  if (ended_is_new_) sequences.push_back(whole(ended_));
  ended_is_new_ = false;
  if (soonest_.empty()) return sequences;
  const Moment& top = soonest_.rbegin()->second;
  const bool further = ended_.empty() || top.earned > ended_return_;
  if (further && top.earned > shown_) {
    shown_ = top.earned;
    sequences.push_back(whole(top.actions));
  }
  return sequences;
}

// ---- checkpoints ---------------------------------------------------------------------

void SequenceSearch::serialize(const Archive& archive) {
  // A gait may have been offered; another start follows from the job.
  const bool from_gait = start_ && std::holds_alternative<SineController>(*start_);
  if (archive.optional("start/period", from_gait)) {
    if (!from_gait) start_ = SineController{};
    evo::serialize(archive.part("start"), std::get<SineController>(*start_));
  }
  archive.stream("random", random_);
  archive.numbers<double>("numbers", level_height_, ended_return_, shown_);
  archive.numbers<std::uint8_t>("flags", start_is_due_, ended_is_new_);
  archive.array("ended", ended_);
  archive.bytes("soonest", soonest_);
  if (!soonest_.empty() && !soonest_.contains(level_of(0.0)))
    throw Error(Failure::data, "checkpoint: its archive does not begin where episodes do");
  archive.bytes("highest", highest_);
}

void SequenceSearch::Moment::pass(Bytes& bytes) {
  bytes(state, actions, earned, visits, delayed);
  bytes(gait.period, gait.middle, gait.phase, gait.amplitude, gait.shift);
}

}  // namespace evo
