#include "libevo/control/sequence_training.h"

#include <algorithm>
#include <utility>

#include "libevo/control/ppo_training.h"

namespace evo {
namespace {

constexpr double memory = 0.8;          // of a search's pace, from one of its turns to the next
constexpr double horizon = 32768;       // steps after which the two are compared
constexpr std::int64_t exception = 12;  // of so many turns, the last goes to the other
constexpr std::int64_t known = 3;       // turns until the pace of exploration is

// What the episodes after a stretch take at most, environment steps.
std::int64_t evaluation_cost(const TrainingJob& job) {
  return std::int64_t{2} * job.settings.evaluation_episodes * job.arena().task().episode_steps;
}
// As long as an episode, and within what the physics allows.
ReplayController fitted(ReplayController sequence, const TrainingJob& job) {
  fit(sequence, job.arena().task().episode_steps);
  const Physics& physics = job.arena().task().physics;
  for (double& target : sequence.actions)
    target = std::clamp(target, physics.min_target, physics.max_target);
  return sequence;
}

std::optional<OpenLoop> inherited_start(const TrainingJob& job) {
  if (!job.inheritance) return std::nullopt;
  const TrainedController inherited = inherited_controller(job);
  if (const auto* gait = std::get_if<SineController>(&inherited)) return *gait;
  if (const auto* sequence = std::get_if<ReplayController>(&inherited))
    return fitted(*sequence, job);
  return fitted(recorded(job.arena(), inherited, job.evaluation()), job);
}

TrainingJob gait_part(TrainingJob job) {
  job.settings.steps =
      static_cast<std::int64_t>(job.settings.gait_share * static_cast<double>(job.settings.steps));
  return job;
}

}  // namespace

SequenceTraining::SequenceTraining(const TrainingJob& job)
    : gait_job_(std::make_unique<TrainingJob>(gait_part(job))) {
  if (!job.inheritance && gait_job_->settings.steps >= generation_cost(*gait_job_))
    gait_.emplace(*gait_job_);
  else
    explore_from(inherited_start(job));
  const std::int64_t least = first_cost(job) + evaluation_cost(job);
  if (job.settings.steps < least)
    throw error(Failure::usage,
                "training: {} steps are too few for a sequence here; give at least {}",
                job.settings.steps, least);
}

void SequenceTraining::explore_from(std::optional<OpenLoop> start) {
  const TrainingJob& job = *gait_job_;
  search_.emplace(job.arena(), job.settings, job.evaluation(),
                  Stream(job.seed, "train/explore", job.robot_id), std::move(start));
}

// What the episodes that a search begins with take at most, environment steps.
std::int64_t SequenceTraining::first_cost(const TrainingJob& job) const {
  const bool begins_with_one = !search_ || search_->start();
  return std::int64_t{begins_with_one ? 1 : job.settings.environments} *
         job.arena().task().episode_steps;
}

bool SequenceTraining::done(const TrainingJob& job, const TrainResult& result) const {
  if (!search_) return false;
  const std::int64_t first = search_->levels() == 0 ? first_cost(job) : job.settings.environments;
  return result.steps + first + evaluation_cost(job) > job.settings.steps;
}

void SequenceTraining::Pace::turn(double gained, std::int64_t steps) {
  per_step = memory * per_step + (1.0 - memory) * (gained / static_cast<double>(steps));
  ++turns;
}

bool SequenceTraining::gait_is_next(const TrainingJob& job, const TrainResult& result) const {
  if (!gait_) return false;
  if (!search_) return true;
  if (result.steps + generation_cost(job) + evaluation_cost(job) > job.settings.steps) return false;
  const bool ahead = exploration_pace_.turns >= known &&
                     best_gait_->best + gait_pace_.per_step * horizon >
                         *result.fitness + exploration_pace_.per_step * horizon;
  const std::int64_t turn = gait_pace_.turns + exploration_pace_.turns + 1;
  return (turn % exception == 0) != ahead;
}

void SequenceTraining::advance(const TrainingJob& job, TrainResult& result, Metrics& metrics) {
  if (gait_is_next(job, result))
    search_gait(job, result, metrics);
  else
    explore(job, result, metrics);
}

void SequenceTraining::search_gait(const TrainingJob& job, TrainResult& result, Metrics& metrics) {
  const std::int64_t before = result.steps;
  GaitTraining::Generation found = gait_->advance(job, result, metrics);
  const double gained = best_gait_ ? std::max(0.0, found.best - best_gait_->best) : 0.0;
  gait_pace_.turn(gained, result.steps - before);
  if (!best_gait_ || gained > 0.0) {
    best_gait_ = std::move(found);
    if (search_) search_->offer(best_gait_->gait);
  }
  if (!search_ && gait_->done(*gait_job_, result)) {
    explore_from(best_gait_->gait);
    gait_pace_.turns = 0;  // with exploration, from now on
  }
}

void SequenceTraining::explore(const TrainingJob& job, TrainResult& result, Metrics& metrics) {
  const std::int64_t before = result.steps;
  const double old_fitness = result.fitness.value_or(0.0);  // there, if there is a gait
  const std::int64_t left = job.settings.steps - evaluation_cost(job) - result.steps;
  const std::int64_t stretch = job.settings.evaluation_interval * job.settings.batch();
  const std::int64_t first = search_->levels() == 0 ? first_cost(job) : 0;
  result.steps += search_->explore(std::min(left, first + stretch));

  // The episode from its beginning, whatever the archive says of it.
  const std::vector<ReplayController> news = search_->news();
  std::vector<double> means;
  if (!news.empty()) {
    const OpenLoopEvaluation tried = evaluate_each(job.arena(), news, job.evaluation());
    result.steps += tried.steps;
    means = tried.means;
  }
  const auto best = std::max_element(means.begin(), means.end());
  if (best != means.end()) {
    result.evaluated(*best, news[static_cast<std::size_t>(best - means.begin())]);
  } else {
    result.evaluated(result.fitness.value(), *result.controller);  // nothing new
  }
  exploration_pace_.turn(*result.fitness - old_fitness, result.steps - before);
  metrics.push_back({"charts/levels", static_cast<double>(search_->levels())});
  metrics.push_back({"charts/highest_level", search_->highest()});
  report_evaluation(result, metrics);
}

void SequenceTraining::serialize(const Archive& archive) {
  const Archive of_gait = archive.part("gait");
  if (!of_gait.optional("search/generation", gait_.has_value()))
    gait_.reset();  // not looked for, with fewer steps
  if (gait_) {
    gait_->serialize(of_gait);
    if (of_gait.optional("turns/paces", best_gait_.has_value())) {
      if (!best_gait_) best_gait_.emplace();
      of_gait.numbers<double>("turns/paces", best_gait_->best, gait_pace_.per_step,
                              exploration_pace_.per_step);
      of_gait.numbers<std::uint64_t>("turns/counts", gait_pace_.turns, exploration_pace_.turns);
      evo::serialize(of_gait.part("best"), best_gait_->gait);
    }
  }
  if (gait_ && !archive.optional("search/random", search_.has_value())) return;
  if (!search_) explore_from(std::nullopt);
  search_->serialize(archive.part("search"));
}

}  // namespace evo
