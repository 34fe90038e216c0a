#include "libevo/control/sequence_training.h"

#include <algorithm>
#include <utility>

#include "libevo/control/wave_search.h"

namespace evo {
namespace {

SequenceSearchSettings search_settings(const TrainingSettings& s) {
  return {s.environments, s.shortest_period, s.longest_period};
}

// At most, in environment steps: of the episodes after a stretch, and of those that a
// search begins with.
std::int64_t evaluation_cost(const TrainingJob& job) {
  return std::int64_t{2} * job.settings.evaluation_episodes * job.arena.task().episode_steps;
}
std::int64_t first_cost(const TrainingJob& job) {
  return std::int64_t{job.inheritance ? 1 : job.settings.environments} *
         job.arena.task().episode_steps;
}

// As long as an episode, and within what the physics allows.
ReplayController fitted(ReplayController sequence, const TrainingJob& job) {
  fit(sequence, job.arena.task().episode_steps);
  const Physics& physics = job.arena.task().physics;
  for (double& target : sequence.actions)
    target = std::clamp(target, physics.min_target, physics.max_target);
  return sequence;
}

// What a controller of the job's robot does in the episode that counts.
ReplayController recorded(const Controller& controller, const TrainingJob& job) {
  ReplayController sequence{{}, job.arena.action_length()};
  EvaluationSettings first = job.evaluation();
  first.episodes = 1;
  evaluate(job.arena, controller, first, [&](const EpisodeMoment& moment) {
    sequence.actions.insert(sequence.actions.end(), moment.targets.begin(), moment.targets.end());
  });
  return sequence;
}

std::optional<ReplayController> inherited_sequence(const TrainingJob& job) {
  if (!job.inheritance) return std::nullopt;
  const Inheritance& old = *job.inheritance;
  const Anatomy to = anatomy(job.arena.robot(), job.arena.layout());
  if (const auto* sequence = std::get_if<ReplayController>(&old.controller))
    return fitted(transferred(*sequence, old.anatomy, to), job);
  if (const auto* policy = std::get_if<Policy>(&old.controller)) {
    const Policy fresh = initial_policy(job, inherited_gait(job));
    return fitted(recorded(transferred(*policy, old.anatomy, fresh, to), job), job);
  }
  return fitted(recorded(inherited_gait(job).value(), job), job);
}

}  // namespace

SequenceTraining::SequenceTraining(const TrainingJob& job)
    : search_(job.arena, search_settings(job.settings), job.evaluation(),
              Stream(job.seed, "train/search", job.robot_id), inherited_sequence(job)) {
  const std::int64_t least = first_cost(job) + evaluation_cost(job);
  if (job.settings.steps < least)
    throw error(Failure::usage,
                "training: {} steps are too few for a sequence here; give at least {}",
                job.settings.steps, least);
}

bool SequenceTraining::done(const TrainingJob& job, const Findings& findings) const {
  const std::int64_t first = findings.curve.empty() ? first_cost(job) : job.settings.environments;
  return findings.steps + first + evaluation_cost(job) > job.settings.steps;
}

void SequenceTraining::advance(const TrainingJob& job, Findings& findings, Metrics& metrics) {
  const std::int64_t left = job.settings.steps - evaluation_cost(job) - findings.steps;
  const std::int64_t stretch = job.settings.evaluation_interval * job.settings.batch();
  const std::int64_t first = findings.curve.empty() ? first_cost(job) : 0;
  findings.steps += search_.explore(std::min(left, first + stretch));

  // The episode from its beginning, whatever the archive says of it.
  const std::vector<ReplayController> news = search_.news();
  std::vector<double> means;
  if (!news.empty()) {
    const OpenLoopEvaluation result = evaluate_each(job.arena, news, job.evaluation());
    findings.steps += result.steps;
    means = result.means;
  }
  const auto best = std::max_element(means.begin(), means.end());
  if (best != means.end()) {
    findings.evaluated(*best, news[static_cast<std::size_t>(best - means.begin())]);
  } else {
    findings.evaluated(findings.fitness.value(), *findings.best);  // nothing new
  }
  metrics.push_back({"charts/levels", static_cast<double>(search_.levels())});
  metrics.push_back({"charts/highest_level", search_.highest()});
  report_evaluation(findings, metrics);
}

}  // namespace evo
