#include "cli/by_sequence.h"

#include <fmt/ranges.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "cli/data.h"
#include "formats/training/policy.h"
#include "libevo/base/error.h"
#include "libevo/control/evaluate.h"

namespace evo::cli {
namespace {

namespace fs = std::filesystem;

constexpr int starts = 64;
constexpr double compared_from = 1e-3;  // voxels that start coordinates are moved
constexpr double final_from = 1e-4;
constexpr std::int64_t steps_at_first = 2'000'000;

constexpr std::array<const char*, 3> stages{"sequence", "feedback", "moments"};

EvaluationSettings perturbed(double jitter, std::uint64_t seed) {
  EvaluationSettings settings;
  settings.episodes = starts;
  settings.jitter = jitter;
  settings.seed = seed;
  return settings;
}

// Writes the better one of the two networks; a robot without one has failed.
Robot keep_better(const TrainingPlan& plan, const std::vector<TrainingPlan>& stage_plans,
                  const Robot& robot) {
  const Arena arena(plan.task, robot.body);
  std::optional<PolicyFile> best;
  double most = 0.0;
  std::int64_t steps = 0;
  for (const TrainingPlan& stage : stage_plans) {
    const fs::path path = training_paths(stage, robot.id).policy;
    if (!fs::exists(path)) continue;  // it failed, and failures are skipped
    PolicyFile file = read_policy(path);
    steps += file.steps;
    if (&stage == &stage_plans.front()) continue;
    const double mean = evaluate(arena, file.controller,
                                 perturbed(compared_from, derive_seed(plan.seed, "compared")))
                            .mean();
    if (best && mean <= most) continue;
    most = mean;
    best = std::move(file);
    best->fitness = mean;  // its training's own value is the best of many on a few starts
  }
  if (!best) return robot.failed({"no network was trained", steps, plan.seed});
  const Evaluation last =
      evaluate(arena, best->controller, perturbed(final_from, derive_seed(plan.seed, "final")));
  best->final_score = FinalScore{starts, last.mean(), last.standard_error()};
  const fs::path path = training_paths(plan, robot.id).policy;
  write_policy(path, *best);
  Robot kept = scored(plan, robot, best->fitness, path, *best, arena);
  kept.document["steps"] = steps;
  return kept;
}

}  // namespace

int train_by_sequence(const Command& command, const TrainingOptions& options,
                      const std::vector<Robot>& robots,
                      const std::function<void(std::size_t, Robot)>& put) {
  if (const auto profile = profile_words(options.train).profile)
    throw error(Failure::usage,
                "--train {} excludes --by-sequence, whose profiles are {}; settings may change "
                "them",
                *profile, fmt::join(stages, ", "));
  const TrainingPlan plan = options.plan(command.seed);
  const std::int64_t steps = options.steps ? plan.children.steps : steps_at_first;
  std::vector<TrainingPlan> plans;
  for (const char* stage : stages) {
    TrainingOptions of_stage = options;
    of_stage.train.insert(of_stage.train.begin(), {stage, "final_episodes=0"});
    const bool last = stage == stages.back();
    of_stage.steps = std::to_string(last ? steps - 2 * (steps / 8) : steps / 8);
    of_stage.files.policies = (fs::path(options.files.policies) / stage).string();
    try {
      plans.push_back(of_stage.plan(derive_seed(command.seed, stage)));
    } catch (const Error& e) {
      throw e.at(fmt::format("{}, with {} of the {} steps", stage, *of_stage.steps, steps));
    }
    if (plans.size() > 1) plans.back().own = plans.front().policies;
  }
  for (const TrainingPlan& stage : plans)
    if (const int status = train_robots(command, stage, robots, Journal(std::nullopt),
                                        [](std::size_t, const Robot&) {});
        status != 0)
      return status;
  Workers workers(command, robots.size());
  workers.pool.run(robots.size(), [&](std::size_t i, int /*worker*/) {
    put(i, keep_better(plan, plans, robots[i]));
  });
  return 0;
}

}  // namespace evo::cli
