#include "cli/training_options.h"

#include <limits>

#include "cli/data.h"
#include "formats/io/values.h"
#include "formats/training/training.h"

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
      command.option("--init", files.init, "POLICY|DIR",
                     "start from this policy, or in a folder from the parent's (<id>.policy.h5); "
                     "robots without one start from scratch");
  const Option founders_start = command.option(
      "--founder-init", files.founders_from, "POLICY|DIR",
      "start robots without parents from this policy, or in a folder from their own");
  command.seed_option();
  command.section("Files");
  command.option("--out-dir", files.policies, "DIR", "where <id>.policy.h5 and <id>.log go");
  const Option for_all = command.option(
      "--shared", files.shared, "FILE.policy.h5",
      "one controller for all robots read, instead of one for each (--train modular)");
  command.output_option("where the robots go, with fitness, steps and policy");
  command.option("--checkpoint-every", files.checkpoint_every, "N",
                 "save a checkpoint after this many steps; 0: on interruption only");
  const Option kept =
      command.flag("--keep-checkpoint", files.keep_checkpoint,
                   "keep the end of each training, to continue later (--resume with more --steps)");
  command.flag("--resume", files.resume, "continue from checkpoints where there are any");
  command.flag("--force", files.replace, "replace policies trained with other settings");
  command.choice("--failures", files.skip_failures, "WHAT", {{"stop", false}, {"skip", true}},
                 "a training that diverges: stop, or skip (fitness null, continue)");
  command
      .flag(
          "--by-sequence", by_sequence,
          "search for a sequence of actions, train two networks along it and keep the better one, "
          "which takes 2 000 000 steps unless --steps says")
      .excludes({of_founders, start, founders_start, for_all, kept});
  command.jobs_option();
  command.progress_option();
  command.suggestions("--train", [] {
    return profiles_and_settings("training", assignments(training_profiles().rows({})));
  });
}

TrainingPlan TrainingOptions::plan(std::uint64_t seed) const {
  TrainingPlan plan = files;
  plan.task = task.load();
  const auto [profile, settings] = profile_words(train);
  plan.children = training_profiles().load(profile.value_or("default"), data_folders());
  if (steps) plan.children.steps = parse_steps(*steps, "--steps");
  for (const std::string& assignment : settings)
    training_profiles().assign(plan.children, assignment);
  check(plan.children);
  plan.founders = plan.children;
  if (founder_steps) plan.founders.steps = parse_steps(*founder_steps, "--founder-steps");
  check(plan.founders);
  plan.seed = seed;
  return plan;
}

}  // namespace evo::cli
