#include "cli/training_options.h"

#include <limits>

#include "cli/data.h"
#include "formats/io/values.h"
#include "formats/training/training.h"
#include "formats/training/training_log.h"

namespace evo::cli {
namespace {

std::int64_t parse_steps(const std::string& text, const char* option) {
  return parse_whole(text, option, 1, std::numeric_limits<std::int64_t>::max());
}

}  // namespace

void TrainingOptions::add_to(Command& command) {
  command.section("Task");
  task.add_to(command);
  command.section("Training");
  command.option("--train", train, "PROFILE|KEY=VALUE",
                 "a training profile by name or file (adapt, default, feedback, gait, lineage, "
                 "long, modular, moments, paper, sequence), or one setting, such as "
                 "learning_rate=3e-4 (repeatable); 'evo-inspect training' lists them [default]");
  command.option("--steps", steps, "N", "environment steps [the profile's]");
  const Option of_founders =
      command.option("--founder-steps", founder_steps, "N",
                     "environment steps of robots without parents [--steps]");
  const Option start =
      command.option("--init", init, "POLICY|DIR",
                     "start from this policy, or in a folder from the parent's (<id>.policy.h5); "
                     "robots without one start from scratch");
  const Option founders_start = command.option(
      "--founder-init", founder_init, "POLICY|DIR",
      "start robots without parents from this policy, or in a folder from their own");
  const Option recorded = command.option(
      "--moments", moments, "ROLLOUT|DIR",
      "begin episodes at moments of this recording, in a folder of <id>.h5, instead of "
      "those of what --init does (with --train moments; repeatable)");
  command.seed_option();
  command.section("Files");
  command.option("--out-dir", out_dir, "DIR", "where <id>.policy.h5 and <id>.log go");
  const Option for_all = command.option(
      "--shared", shared, "FILE.policy.h5",
      "one controller for all robots read, instead of one for each (--train modular)");
  command.output_option("where the robots go, with fitness, steps and policy");
  command.option("--checkpoint-every", checkpoint_every, "N",
                 "save a checkpoint after this many steps; 0: on interruption only");
  const Option kept =
      command.flag("--keep-checkpoint", keep_checkpoint,
                   "keep the end of each training, to go on later (--resume with more --steps)");
  command.flag("--resume", resume, "go on from checkpoints where there are any");
  command.flag("--force", force, "replace policies trained with other settings");
  command.choice("--failures", skip_failures, "WHAT", {{"stop", false}, {"skip", true}},
                 "a training that diverges: stop, or skip (fitness null, go on)");
  command
      .flag(
          "--by-sequence", by_sequence,
          "search for a sequence of actions, train two networks along it and keep the better one, "
          "which takes 2 000 000 steps unless --steps says")
      .excludes({of_founders, start, founders_start, recorded, for_all, kept});
  command.jobs_option();
  command.progress_option();
  command.suggestions(
      "--train", [] { return profiles_and_settings("training", assignments(training_table({}))); });
}

TrainingPlan TrainingOptions::plan(std::uint64_t seed) const {
  TrainingPlan plan;
  plan.task = task.load();
  const auto [profile, settings] = profile_words(train);
  plan.children = load_training(profile.value_or("default"), data_folders());
  if (steps) plan.children.steps = parse_steps(*steps, "--steps");
  for (const std::string& assignment : settings) apply_override(plan.children, assignment);
  check(plan.children);
  plan.founders = plan.children;
  if (founder_steps) plan.founders.steps = parse_steps(*founder_steps, "--founder-steps");
  check(plan.founders);
  plan.seed = seed;
  // Policies name the tool whose training they hold, whoever started it.
  plan.created_by = created_by("evo-train");
  plan.policies = out_dir;
  plan.logs = out_dir;
  plan.init = init;
  plan.founders_from = founder_init;
  plan.moments.assign(moments.begin(), moments.end());
  if (shared) plan.shared = *shared;
  plan.checkpoint_every = checkpoint_every;
  plan.keep_checkpoint = keep_checkpoint;
  plan.resume = resume;
  plan.replace = force;
  plan.skip_failures = skip_failures;
  return plan;
}

int train_robots(const Command& command, const TrainingPlan& plan, const std::vector<Robot>& robots,
                 const std::function<void(std::size_t)>& begins,
                 const std::function<void(const Trained&)>& ended) {
  catch_interrupts();
  TrainingProgress progress(command.progress_style(), robots.size());
  std::vector<TrainingView> views(robots.size());  // each of one thread at a time
  std::vector<std::int64_t> last_steps(robots.size(), 0);
  TrainingObserver observer;
  observer.note = log::info;
  observer.interrupted = interrupted;
  observer.begins = begins;
  observer.progress = [&](std::size_t i, const TrainingReport& report) {
    TrainingView& view = views[i];
    view.id = robots[i].id;
    view.done = static_cast<double>(report.step) / static_cast<double>(report.steps);
    if (const auto value = metric(report, "eval/return")) {
      view.evaluations.push_back(*value);
      view.best = metric(report, "eval/best").value_or(*value);
      log::debug(fmt::format("robot {}: step {} of {}, return {:.4g}, best {:.4g}", view.id,
                             report.step, report.steps, *value, view.best));
    }
    progress.update(i, view, static_cast<double>(report.step - last_steps[i]));
    last_steps[i] = report.step;
  };
  observer.ended = [&](const Trained& trained) {
    progress.finish(trained.index);
    ended(trained);
  };
  Workers workers(command, robots.size());
  const int signal = evo::train_robots(plan, robots, workers.pool, observer);
  return signal == 0 ? 0 : 128 + signal;
}

}  // namespace evo::cli
