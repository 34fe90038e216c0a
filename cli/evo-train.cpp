// evo-train: a controller for every robot read.
#include <fmt/ranges.h>

#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>
#include <string>

#include "cli/command.h"
#include "cli/data.h"
#include "cli/outputs.h"
#include "cli/robots.h"
#include "cli/task_options.h"
#include "cli/train.h"
#include "formats/io/data_folders.h"
#include "formats/io/values.h"
#include "formats/robot/writer.h"
#include "formats/training/policy.h"
#include "formats/training/training.h"
#include "libevo/base/error.h"
#include "libevo/control/evaluate.h"
#include "libevo/control/methods.h"

namespace {

using namespace evo;
namespace fs = std::filesystem;

// ---- options ----------------------------------------------------------------------------

// And what they mean as a plan.
struct TrainingOptions {
  cli::TaskOptions task;
  std::vector<std::string> train;  // profiles and settings (profile_words)
  std::optional<std::string> steps;
  std::optional<std::string> founder_steps;
  bool by_sequence = false;
  TrainingPlan files;  // and how they are treated

  // All of them, --seed, --output, --jobs and --progress included.
  void add_to(cli::Command& command);
  // Throws Error(usage) for settings that make no sense, and what a task or profile that
  // cannot be read throws.
  TrainingPlan plan(std::uint64_t seed) const;
};

std::int64_t parse_steps(const std::string& text, const char* option) {
  return parse_whole(text, option, 1, std::numeric_limits<std::int64_t>::max());
}

void TrainingOptions::add_to(cli::Command& command) {
  command.section("Task");
  task.add_to(command);
  command.section("Training");
  command.option("--train", train, "PROFILE|KEY=VALUE",
                 "a training profile by name or file (adapt, default, feedback, gait, lineage, "
                 "long, modular, moments, paper, sequence), or one setting, such as "
                 "learning_rate=3e-4 (repeatable); 'evo-inspect training' lists them [default]");
  command.option("--steps", steps, "N", "environment steps [the profile's]");
  const cli::Option of_founders =
      command.option("--founder-steps", founder_steps, "N",
                     "environment steps of robots without parents [--steps]");
  const cli::Option start =
      command.option("--init", files.init, "POLICY|DIR",
                     "start from this policy, or in a folder from the parent's (<id>.policy.h5); "
                     "robots without one start from scratch");
  const cli::Option founders_start = command.option(
      "--founder-init", files.founders_from, "POLICY|DIR",
      "start robots without parents from this policy, or in a folder from their own");
  command.seed_option();
  command.section("Files");
  command.option("--out-dir", files.policies, "DIR", "where <id>.policy.h5 and <id>.log go");
  const cli::Option for_all = command.option(
      "--shared", files.shared, "FILE.policy.h5",
      "one controller for all robots read, instead of one for each (--train modular)");
  command.output_option("where the robots go, with fitness, steps and policy");
  command.option("--checkpoint-every", files.checkpoint_every, "N",
                 "save a checkpoint after this many steps; 0: on interruption only");
  const cli::Option kept =
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
    return cli::profiles_and_settings("training", assignments(training_profiles().rows({})));
  });
}

TrainingPlan TrainingOptions::plan(std::uint64_t seed) const {
  TrainingPlan plan = files;
  plan.task = task.load();
  const auto [profile, settings] = profile_words(train);
  plan.children = training_profiles().load(profile.value_or("default"), cli::data_folders());
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

// ---- files ------------------------------------------------------------------------------

// None of the files that the trainings write is another one's.
void check_files(const TrainingPlan& plan, const std::vector<Robot>& robots,
                 const std::string& output) {
  std::vector<cli::FileName> outputs{{"--output", output}};
  std::set<std::string> ids;
  for (const Robot& robot : robots) {
    if (!ids.insert(robot.id).second) continue;
    if (plan.shared && ids.size() > 1) continue;
    const TrainingPaths paths = training_paths(plan, robot.id);
    const std::string of = plan.shared ? "all robots" : "robot " + robot.id;
    outputs.push_back({"the policy of " + of, paths.policy.string()});
    outputs.push_back({"the checkpoint of " + of, paths.checkpoint.string()});
    outputs.push_back({"the log of " + of, paths.log.string()});
  }
  cli::check_outputs(outputs);
}

// Where whole updates cut the number of steps by more than a tenth, that is told.
void warn_of_fewer_steps(const TrainingSettings& settings) {
  const std::int64_t trained = settings.updates() * settings.batch();
  if (!abilities(settings.algorithm).whole_updates || 10 * trained >= 9 * settings.steps) return;
  cli::log::warn(
      fmt::format("{} of {} steps are trained: an update takes {} (environments x rollout)",
                  trained, settings.steps, settings.batch()));
}

// ---- robots that are not to be trained ------------------------------------------------

// One whose training was killed, if that is to count as its failure.
std::optional<Robot> given_up(const TrainingPlan& plan, const Robot& robot,
                              const cli::Journal& journal) {
  const auto machine = journal.killed_on(robot.id);
  if (!machine) return std::nullopt;
  Robot failed = robot.failed({fmt::format("its training was killed on {}", *machine)});
  failed.document["task"] = plan.task.name;
  return failed;
}

// Steps are those of a robot's own environments: of a training of all an equal share, and with
// those before where an unscored robot (evo-select) continues from a given controller, as in a run
// of modular.
void count_steps(const TrainingPlan& plan, const Robot& before, std::size_t robots, Robot& robot) {
  std::int64_t steps = robot.steps().value_or(0);
  if (plan.shared) steps /= static_cast<std::int64_t>(robots);
  const bool continues = plan.shared || (plan.init && !fs::is_directory(*plan.init));
  if (continues && !before.document.contains("fitness")) steps += before.steps().value_or(0);
  robot.document["steps"] = steps;
}

int end(OrderedWriter& out, int status) {
  if (status == 0)
    out.finish();
  else
    cli::log::warn("interrupted; give the same command with --resume to continue");
  return status;
}

struct Options {
  std::optional<std::string> pick;
  std::optional<std::string> journal;
  bool give_up = false;
  bool check = false;
};

int train(const cli::Command& command, const TrainingPlan& plan, std::vector<Robot> robots,
          const Options& options) {
  const cli::Journal journal(options.journal);
  OrderedWriter out(command.output);
  std::vector<Robot> trained_now;
  std::vector<std::size_t> places;  // of these in the output
  for (std::size_t k = 0; k < robots.size(); ++k) {
    std::optional<Robot> ended;
    if (plan.resume && robots[k].failure())
      ended = robots[k];  // it stays so when it is gone on with
    else if (options.give_up && !plan.shared)
      ended = given_up(plan, robots[k], journal);
    if (ended) {
      journal.ended(journal_name(plan, robots[k]));
      out.put(k, *ended);
      continue;
    }
    trained_now.push_back(std::move(robots[k]));
    places.push_back(k);
  }
  return end(out,
             train_robots(command, plan, trained_now, journal, [&](std::size_t k, Robot robot) {
               count_steps(plan, trained_now[k], trained_now.size(), robot);
               out.put(places[k], std::move(robot));
             }));
}

// ---- a network by way of a sequence of actions (docs/recipes.md) ------------------------

// An eighth of the steps searches for a sequence, an eighth trains a network that corrects it, and
// the rest one of its own, whose episodes begin along it (profiles `sequence`, `feedback`,
// `moments`). The network that earns more from 64 perturbed starts stays, and this mean is its
// fitness.

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

// As train(), by the options: steps are those of all stages, whose files go to folders
// of --out-dir named by profile. Each stage has a seed of its own: with one for all, a parent would
// enter with its lucky value on the same starts.
int train_by_sequence(const cli::Command& command, const TrainingOptions& options,
                      const std::vector<Robot>& robots) {
  OrderedWriter out(command.output);
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
    if (const int status = train_robots(command, stage, robots, cli::Journal(std::nullopt),
                                        [](std::size_t, const Robot&) {});
        status != 0)
      return end(out, status);
  cli::Workers workers(command, robots.size());
  workers.pool.run(robots.size(), [&](std::size_t i, int /*worker*/) {
    out.put(i, keep_better(plan, plans, robots[i]));
  });
  return end(out, 0);
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-train");
  TrainingOptions options;
  Options more;
  std::vector<std::string> files;
  command.arguments(files, "FILE", "robots [standard input]");
  options.add_to(command);
  command.section("As part of a run");
  command.option("--pick", more.pick, "K", cli::pick_help);
  command.option("--journal", more.journal, "DIR",
                 "keep there which trainings are under way on which machine, and what each took");
  command.flag("--give-up", more.give_up,
               "a robot whose training was killed, as its journal says, counts as failed");
  command.flag("--check", more.check,
               "only check that robots of this shape could be trained so, with or without parents");
  command.example("evo-sample -n 4 | evo-train --task Walker-v0 --steps 102400 --out-dir policies",
                  "four random robots, trained in parallel");
  command.example("evo-train best.json --task Climber-v0 --train paper --out-dir climb --resume",
                  "with the settings of the paper, continuing after an interruption");

  command.example("evo-train --train modular --task Walker-v0 --shared one.policy.h5 bodies.jsonl",
                  "one controller for all bodies of a file, which fits any other");

  return command.run(argc, argv, [&] {
    command.only(more.journal.has_value(), {"--give-up"}, "--journal");
    std::vector<Robot> robots = cli::pick(cli::read_robots(files), more.pick);
    const TrainingPlan plan = options.plan(command.seed);
    if (!more.pick) warn_of_fewer_steps(plan.children);
    if (more.check) {
      check_trainings(plan, robots);
      return 0;
    }
    check_files(plan, robots, command.output);
    command.only(!options.by_sequence, {"--journal"}, "trainings without --by-sequence");
    if (options.by_sequence) return train_by_sequence(command, options, robots);
    return train(command, plan, std::move(robots), more);
  });
}
