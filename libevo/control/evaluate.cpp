#include "libevo/control/evaluate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "libevo/base/overloaded.h"
#include "libevo/base/parallel.h"
#include "libevo/control/actor.h"

namespace evo {
namespace {

// An episode in progress.
struct Running {
  int job = -1;   // index in the work list; -1: idle
  int steps = 0;  // taken so far
  Stream random{0, "random"};
  EpisodeStart start;
};

// Targets [E x A] of all lanes that have a job.
using Choose = std::function<void(const VecEnv&, std::span<Running>, std::span<double>)>;

struct Work {
  int jobs = 0;                                 // job k is episode k % settings.episodes
  int limit = std::numeric_limits<int>::max();  // control steps of an episode
  Choose choose;
};

// Runs all jobs, each lane taking the next one when its episode has ended.
Evaluation run(const Arena& arena, const EvaluationSettings& settings, const Work& work,
               const EpisodeObserver& observer) {
  Evaluation result;
  result.returns.assign(static_cast<std::size_t>(work.jobs), 0.0);
  result.lengths.assign(static_cast<std::size_t>(work.jobs), 0);
  result.peaks.assign(static_cast<std::size_t>(work.jobs), 0.0);
  if (work.jobs == 0) return result;

  const auto count = static_cast<std::size_t>(std::clamp(settings.lanes, 1, work.jobs));
  const auto actions = static_cast<std::size_t>(arena.action_length());
  VecEnv env(arena, static_cast<int>(count));
  std::vector<Running> lanes(count);
  std::vector<std::uint8_t> active(count, 0);
  std::vector<double> targets(count * actions, 1.0);
  int next = 0;
  std::size_t running = 0;
  const auto begin = [&](std::size_t l) {
    Running& lane = lanes[l];
    lane.job = next < work.jobs ? next++ : -1;
    active[l] = lane.job >= 0 ? 1 : 0;
    if (active[l] == 0) return;
    ++running;
    const int episode = lane.job % settings.episodes;
    lane.steps = 0;
    lane.random = Stream(settings.seed, "random", static_cast<std::uint64_t>(episode));
    lane.start = start_of(arena, settings, episode);
    env.reset(static_cast<int>(l), lane.start);
    if (observer) observer({episode, env, static_cast<int>(l), {}, false, lane.start});
  };
  for (std::size_t l = 0; l < count; ++l) begin(l);

  while (running > 0) {
    work.choose(env, lanes, targets);
    env.step(targets, active);
    require_stable(env);
    for (std::size_t l = 0; l < count; ++l) {
      if (active[l] == 0) continue;
      Running& lane = lanes[l];
      const auto job = static_cast<std::size_t>(lane.job);
      ++lane.steps;
      result.returns[job] += env.rewards()[l];
      if (lane.steps == 1 || result.returns[job] > result.peaks[job])
        result.peaks[job] = result.returns[job];
      result.lengths[job] = lane.steps;
      const bool over = env.terminated()[l] != 0 || env.truncated()[l] != 0 ||
                        lane.steps >= work.limit ||
                        (settings.max_steps > 0 && lane.steps >= settings.max_steps);
      if (observer)
        observer({lane.job % settings.episodes, env, static_cast<int>(l),
                  std::span<const double>(targets).subspan(l * actions, actions), over,
                  lane.start});
      if (!over) continue;
      --running;
      begin(l);
    }
  }
  return result;
}

// ---- one chooser per kind of controller -------------------------------------------

template <typename PerLane>
Choose lane_by_lane(std::size_t actions, PerLane per_lane) {
  return [actions, per_lane](const VecEnv&, std::span<Running> lanes, std::span<double> targets) {
    for (std::size_t l = 0; l < lanes.size(); ++l)
      if (lanes[l].job >= 0) per_lane(lanes[l], targets.subspan(l * actions, actions));
  };
}

Work work_for(const Arena& arena, const Controller& controller,
              const EvaluationSettings& settings) {
  Work work;
  work.jobs = settings.episodes;
  const auto actions = static_cast<std::size_t>(arena.action_length());
  const Overloaded by_kind{
      [&](const TrainedController& trained) {
        work.choose = [actor = Actor(trained, arena), steps = std::vector<int>{}](
                          const VecEnv& env, std::span<Running> lanes,
                          std::span<double> targets) mutable {
          steps.clear();
          for (const Running& lane : lanes) steps.push_back(lane.steps);
          actor.act(env, 0, steps, targets);
        };
        if (const auto* sequence = std::get_if<ReplayController>(&trained))
          work.limit = sequence->steps();
      },
      [&](const RandomController& random) {
        work.choose = lane_by_lane(actions, [&random](Running& lane, std::span<double> targets) {
          for (double& target : targets)
            target = random.low + (random.high - random.low) * lane.random.uniform();
        });
      },
      [&](const PlannerController& planner) {
        if (planner.sequence) {
          require_fit(*planner.sequence, arena);
          work.limit = planner.sequence->steps();
        }
        const auto pool = std::make_shared<ThreadPool>(
            std::clamp(std::min(settings.threads, settings.lanes), 1, std::max(work.jobs, 1)));
        const auto planners = std::make_shared<std::vector<Replanner>>();
        for (int k = 0; k < pool->threads(); ++k) planners->emplace_back(arena, planner);
        work.choose = [pool, planners, actions](const VecEnv& env, std::span<Running> lanes,
                                                std::span<double> targets) {
          pool->run(planners->size(), [&](std::size_t k, int /*worker*/) {
            for (std::size_t l = k; l < lanes.size(); l += planners->size())
              if (Running& lane = lanes[l]; lane.job >= 0)
                (*planners)[k].act(env, static_cast<int>(l), lane.steps, lane.start, lane.random,
                                   targets.subspan(l * actions, actions));
          });
        };
      }};
  std::visit(by_kind, controller);
  return work;
}

}  // namespace

EpisodeStart start_of(const Arena& arena, const EvaluationSettings& settings, int episode) {
  const auto k = static_cast<std::uint64_t>(episode);
  return {settings.draws ? *settings.draws : arena.draw(settings.seed, k), settings.jitter,
          derive_seed(settings.seed, "jitter", k)};
}

double Evaluation::mean() const {
  return std::accumulate(returns.begin(), returns.end(), 0.0) / static_cast<double>(returns.size());
}

double Evaluation::standard_error() const {
  if (returns.size() < 2) return 0.0;
  const double centre = mean();
  double squares = 0.0;
  for (const double r : returns) squares += (r - centre) * (r - centre);
  const auto n = static_cast<double>(returns.size());
  return std::sqrt(squares / (n - 1.0) / n);
}

std::int64_t Evaluation::steps() const {
  return std::accumulate(lengths.begin(), lengths.end(), std::int64_t{0});
}

Evaluation evaluate(const Arena& arena, const Controller& controller,
                    const EvaluationSettings& settings, const EpisodeObserver& observer) {
  return run(arena, settings, work_for(arena, controller, settings), observer);
}

ReplayController recorded(const Arena& arena, const Controller& controller,
                          EvaluationSettings settings) {
  settings.episodes = 1;
  ReplayController sequence{{}, arena.action_length()};
  evaluate(arena, controller, settings, [&](const EpisodeMoment& moment) {
    sequence.actions.insert(sequence.actions.end(), moment.targets.begin(), moment.targets.end());
  });
  return sequence;
}

template <typename OpenLoopController>
OpenLoopEvaluation evaluate_each(const Arena& arena,
                                 const std::vector<OpenLoopController>& controllers,
                                 const EvaluationSettings& settings) {
  const int episodes = settings.episodes;
  Work work;
  work.jobs = episodes * static_cast<int>(controllers.size());
  work.choose = lane_by_lane(static_cast<std::size_t>(arena.action_length()),
                             [&](const Running& lane, std::span<double> targets) {
                               const auto c = static_cast<std::size_t>(lane.job / episodes);
                               act(controllers[c], lane.steps, targets);
                             });
  const Evaluation all = run(arena, settings, work, {});
  OpenLoopEvaluation result;
  result.steps = all.steps();
  const auto mean_of = [episodes](const std::vector<double>& values, std::size_t c) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(c) * episodes;
    return std::accumulate(first, first + episodes, 0.0) / episodes;
  };
  for (std::size_t c = 0; c < controllers.size(); ++c) {
    result.means.push_back(mean_of(all.returns, c));
    result.peaks.push_back(mean_of(all.peaks, c));
  }
  return result;
}

template OpenLoopEvaluation evaluate_each(const Arena&, const std::vector<SineController>&,
                                          const EvaluationSettings&);
template OpenLoopEvaluation evaluate_each(const Arena&, const std::vector<ReplayController>&,
                                          const EvaluationSettings&);

}  // namespace evo
