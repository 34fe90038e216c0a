#include "cli/training.h"

#include <fmt/ranges.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <limits>
#include <set>

#include "cli/data.h"
#include "cli/episodes.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "cli/rescue.h"
#include "cli/values.h"
#include "formats/io/files.h"
#include "formats/run/run.h"
#include "formats/training/policy.h"
#include "formats/training/training.h"
#include "formats/training/training_log.h"
#include "libevo/base/parallel.h"
#include "libevo/control/method.h"
#include "libevo/control/trainer.h"

namespace evo::cli {
namespace {

namespace fs = std::filesystem;

// Policies name the tool whose training they hold, whoever started it.
constexpr const char* trained_by = "evo-train";

struct Job {
  const TrainingOptions& options;
  const TaskSpec& task;
  const TrainingSettings& training;
  std::uint64_t seed;
  const Command& command;
  Rescue& rescue;
};

struct Paths {
  fs::path policy;
  fs::path checkpoint;
  fs::path log;
};

Paths paths_of(const TrainingOptions& options, const std::string& id) {
  fs::path out = options.out_dir;
  fs::path logs = options.log_dir.value_or(options.out_dir);
  if (options.sharded) {
    out /= run_shard(id);
    logs /= run_shard(id);
  }
  return {out / (id + ".policy.h5"), out / (id + ".checkpoint.h5"), logs / (id + ".log")};
}

// To the millisecond.
double seconds_since_1970() {
  using namespace std::chrono;
  const auto now = system_clock::now().time_since_epoch();
  return static_cast<double>(duration_cast<milliseconds>(now).count()) / 1000.0;
}

// The best evaluation once more, to look at: it has the same bits.
Json behaviour_of(const PolicyFile& file, const Job& job, const Arena& arena) {
  BehaviourGauge gauge;
  evaluate(arena, to_controller(file.controller),
           TrainingJob{arena, job.training, job.seed, file.robot.id}.evaluation(),
           [&](const EpisodeMoment& moment) { gauge.record(moment); });
  return gauge.mean();
}

Robot scored(const Robot& robot, const fs::path& policy, const Job& job, const Arena& arena) {
  const PolicyFile file = read_policy(policy);
  Robot result = robot;
  result.set_fitness(file.fitness);
  result.document["task"] = file.task;
  result.document["steps"] = file.steps;
  result.document["policy"] = policy.string();
  if (const auto& score = file.final_score)
    result.document["final"] = {{"episodes", score->episodes},
                                {"mean", score->mean},
                                {"standard_error", score->standard_error}};
  if (job.options.behaviour) result.document["behaviour"] = behaviour_of(file, job, arena);
  return result;
}

Robot failed(const Robot& robot, const Job& job, const TrainingFailure& failure) {
  Robot result = robot;
  result.set_failure({failure.why, failure.step, failure.seed});
  result.document["task"] = job.task.name;
  result.document["steps"] = failure.step;
  return result;
}

Error trained_otherwise(const fs::path& policy, const std::string& difference) {
  return error(Failure::cannot_create,
               "{}: trained with other settings ({}); choose another --out-dir, or --force to "
               "replace it",
               policy.string(), difference);
}

// ---- what a training starts from ----------------------------------------------------

// Nothing for a robot that was sampled.
const Json* parents_of(const Robot& robot) {
  const auto parents = robot.document.find("parents");
  return parents != robot.document.end() && parents->is_array() && !parents->empty() ? &*parents
                                                                                     : nullptr;
}

// A robot's policy in the folder, or in its part of a folder of many.
std::optional<fs::path> policy_in(const fs::path& folder, const std::string& id) {
  for (const fs::path& part : {folder, folder / run_shard(id)})
    if (const fs::path path = part / (id + ".policy.h5"); fs::exists(path)) return path;
  return std::nullopt;
}

// The policy that a robot starts from: where founders go on, a founder's own; else what
// --init means, the one given, or in a folder that of the first parent which has one
// there. Nothing: from scratch.
std::optional<fs::path> inherited_policy(const Robot& robot, const TrainingOptions& options) {
  const Json* parents = parents_of(robot);
  if (parents == nullptr && options.founders_from) {
    if (auto own = policy_in(*options.founders_from, robot.id)) return own;
    throw error(Failure::no_input, "{}: has no policy of robot {} to go on from",
                *options.founders_from, robot.id);
  }
  if (!options.init) return std::nullopt;
  if (!fs::is_directory(*options.init)) return fs::path(*options.init);
  if (parents == nullptr) return std::nullopt;
  for (const Json& parent : *parents)
    if (parent.is_string())
      if (auto path = policy_in(*options.init, parent.get<std::string>())) return path;
  return std::nullopt;
}

struct Start {
  std::optional<Inheritance> inheritance;
  TrainingOrigin origin;
  TrainingIdentity identity;             // of the whole training
  std::optional<Checkpoint> checkpoint;  // to go on from
};

TrainingIdentity identify(const Robot& robot, const Job& job, std::int64_t steps,
                          const TrainingOrigin& origin) {
  TrainingSettings settings = job.training;
  settings.steps = steps;
  return evo::identify(robot.body, job.task, settings, job.seed, origin);
}

void restore(Trainer& trainer, const Checkpoint& checkpoint, const fs::path& path) {
  try {
    trainer.restore(checkpoint);
  } catch (const Error& e) {
    throw error(
        e.kind(),
        "{}: {}; perhaps it is from another version of evo-train: remove it to start afresh",
        path.string(), e.what());
  }
}

// The checkpoint is of this training, or the end of one with fewer steps.
void go_on(const Robot& robot, const Job& job, const Arena& arena, const fs::path& path,
           Start& start) {
  const auto span = span_of_same(read_checkpoint_identity(path), start.identity.lines);
  if (!span || span->steps > job.training.steps) {
    start.checkpoint = read_checkpoint(path, start.identity);  // an old one, or says what differs
    return;
  }
  start.origin.parts = span->parts;
  start.checkpoint = read_checkpoint(path, identify(robot, job, span->steps, start.origin));
  if (span->steps < job.training.steps) {
    TrainingSettings settings = job.training;
    settings.steps = span->steps;
    Trainer shorter(arena, settings, job.seed, robot.id, start.inheritance);
    restore(shorter, *start.checkpoint, path);
    if (!shorter.done())
      throw error(Failure::cannot_create,
                  "{}: belongs to a training of {} steps that has not ended; finish it first, or "
                  "remove it to start afresh",
                  path.string(), span->steps);
    start.origin.parts.push_back(span->steps);
  }
  start.identity = identify(robot, job, job.training.steps, start.origin);
}

Start find_start(const Robot& robot, const Job& job, const Arena& arena, const Paths& paths) {
  Start start;
  if (const auto path = inherited_policy(robot, job.options)) {
    const PolicyFile file = read_policy(*path);
    start.inheritance = Inheritance{file.controller, anatomy(file.robot.body, file.layout)};
    start.origin.inherited = file.settings_hash;
  }
  start.identity = identify(robot, job, job.training.steps, start.origin);
  if (job.options.resume && fs::exists(paths.checkpoint))
    go_on(robot, job, arena, paths.checkpoint, start);
  return start;
}

// ---- one robot ----------------------------------------------------------------------

// Whether the policy with this identity is of the training, but perhaps for its span.
bool is_part(const std::string& there, const Start& start) {
  return start.checkpoint && span_of_same(there, start.identity.lines);
}

// The robot as it was trained before with exactly these settings (with --resume:
// perhaps in parts), or nothing.
std::optional<Robot> trained_before(const Robot& robot, const Job& job, const Arena& arena,
                                    const Paths& paths, const Start& start) {
  if (!fs::exists(paths.policy)) return std::nullopt;
  try {
    const std::string there = read_policy_identity(paths.policy);
    const auto span = span_of_same(there, start.identity.lines);
    const bool in_parts = job.options.resume && span && span->steps == job.training.steps;
    if (there == start.identity.lines || in_parts) return scored(robot, paths.policy, job, arena);
    if (!job.options.force && !is_part(there, start))
      throw trained_otherwise(paths.policy, difference(there, start.identity.lines));
  } catch (const Error& e) {  // damaged, or no policy at all
    if (!job.options.force || e.kind() != Failure::data) throw;
  }
  return std::nullopt;
}

// Another process may have finished the same robot with other settings meanwhile;
// its work is not overwritten.
void save_policy(const fs::path& path, const PolicyFile& policy, bool force) {
  try {
    write_policy(path, policy, force ? Existing::replaced : Existing::refused);
  } catch (const Error& e) {
    if (e.kind() != Failure::cannot_create || !fs::exists(path)) throw;
    const std::string there = read_policy_identity(path);
    if (there != policy.identity) throw trained_otherwise(path, difference(there, policy.identity));
  }
}

void write_curve(const std::string& path, const std::vector<CurvePoint>& curve) {
  std::string table = "step\treturn\tbest\n";
  for (const CurvePoint& point : curve)
    table += fmt::format("{}\t{}\t{}\n", point.step, point.evaluation, point.best);
  write_file(path, table);
}

// Without a robot when interrupted: a checkpoint then lies beside the policy.
Trained train_robot(const Robot& robot, std::size_t index, const Job& job,
                    const std::function<void(const TrainingReport&)>& show) {
  const Paths paths = paths_of(job.options, robot.id);
  if (job.options.sharded)
    for (const fs::path& file : {paths.policy, paths.log}) make_folders(file.parent_path());
  const Arena arena(job.task, robot.body);
  const Start start = find_start(robot, job, arena, paths);
  Trained trained;
  trained.robot = trained_before(robot, job, arena, paths, start);
  trained.known = trained.robot.has_value();
  if (trained.known) return trained;

  // What is there is an earlier end of the same training.
  const bool replaces_part = !job.options.force && start.checkpoint && fs::exists(paths.policy) &&
                             is_part(read_policy_identity(paths.policy), start);

  Trainer trainer(arena, job.training, job.seed, robot.id, start.inheritance);
  const bool resumed = start.checkpoint.has_value();
  if (resumed) {
    restore(trainer, *start.checkpoint, paths.checkpoint);
    if (!job.options.in_rungs)
      job.command.note(
          fmt::format("robot {}: goes on from {}", robot.id, paths.checkpoint.string()));
  } else if (fs::exists(paths.checkpoint)) {
    job.command.note(fmt::format("robot {}: begins anew; --resume would go on from {}", robot.id,
                                 paths.checkpoint.string()));
  }
  const auto save = [&] {
    write_checkpoint(paths.checkpoint, trainer.checkpoint(), start.identity);
  };

  TrainingLog log(paths.log);
  log.begin(created_by(trained_by), job.task.name, resumed);
  trained.started = seconds_since_1970();
  const Clock clock;
  const std::int64_t first_step = trainer.result().steps;  // of this process
  std::int64_t saved_step = first_step;
  while (!trainer.done()) {
    const TrainingReport report = trainer.advance();
    trained.steps = report.step - first_step;
    trained.seconds = clock.seconds();
    if (metric(report, "eval/return"))
      log.line(report, static_cast<double>(trained.steps) / std::max(trained.seconds, 1e-9));
    show(report);
    if (trainer.done()) break;
    job.rescue.keep(index, trainer.checkpoint(), paths.checkpoint, start.identity);
    if (interrupted() != 0) {
      save();
      trained.seconds = clock.seconds();
      return trained;
    }
    if (job.options.checkpoint_every > 0 &&
        report.step - saved_step >= job.options.checkpoint_every) {
      save();
      saved_step = report.step;
    }
  }
  const TrainResult result = trainer.result();
  log.end(clock.seconds());
  // Before the policy, which says that the training has ended.
  const bool keeps = job.options.keep_checkpoint && !result.failure;
  if (keeps) save();
  if (!result.failure)
    save_policy(paths.policy,
                make_policy_file(robot, arena, job.training, job.seed, result,
                                 created_by(trained_by), start.origin),
                job.options.force || replaces_part);
  job.rescue.forget(index);
  std::error_code ignored;
  if (!keeps) fs::remove(paths.checkpoint, ignored);
  if (job.options.curve) write_curve(*job.options.curve, result.curve);
  trained.robot = result.failure ? failed(robot, job, *result.failure)
                                 : scored(robot, paths.policy, job, arena);
  trained.seconds = clock.seconds();
  return trained;
}

void check_options(const TrainingOptions& options, std::size_t robots) {
  if (options.failures != "stop" && options.failures != "skip")
    throw error(Failure::usage, "--failures: '{}' is not stop or skip", options.failures);
  if (options.curve && robots != 1)
    throw error(Failure::usage,
                "--curve writes the curve of one robot, but {} were read; the "
                "policy files hold the curves of all",
                robots);
}

void stop_at_failure(const Robot& robot, const TrainingOptions& options) {
  const auto failure = robot.failure();
  if (!failure || options.failures != "stop") return;
  throw error(Failure::work, "training failed at step {} with seed {}: {}",
              failure->step.value_or(0), failure->seed.value_or(0), failure->why);
}

// None of the files that the trainings write is another one's.
void check_files(const TrainingOptions& options, const std::vector<Robot>& robots,
                 const std::string& output) {
  std::vector<FileName> outputs{{"--output", output}};
  if (options.curve) outputs.push_back({"--curve", *options.curve});
  std::set<std::string> ids;
  for (const Robot& robot : robots) {
    if (!ids.insert(robot.id).second) continue;
    const Paths paths = paths_of(options, robot.id);
    outputs.push_back({"the policy of robot " + robot.id, paths.policy.string()});
    outputs.push_back({"the checkpoint of robot " + robot.id, paths.checkpoint.string()});
    outputs.push_back({"the log of robot " + robot.id, paths.log.string()});
  }
  check_outputs(outputs);
}

}  // namespace

void TrainingOptions::add_to(Command& command) {
  command.section("Task");
  task.add_to(command);
  command.section("Training");
  command.option("--train", profile, "PROFILE",
                 "training profile by name or file: default, gait, lineage, moments, paper, "
                 "portfolio, release2, sequence");
  command.option("--train-set", set, "KEY=VALUE",
                 "one setting of the profile, such as learning_rate=3e-4 (repeatable); "
                 "'evo-inspect training' lists them");
  command.option("--algo", algorithm, "NAME",
                 fmt::format("{} [the profile's]", fmt::join(algorithm_names(), ", ")));
  command.option("--steps", steps, "N", "environment steps [the profile's]");
  command.option("--founder-steps", founder_steps, "N",
                 "environment steps of robots without parents [--steps]");
  command.option("--final-episodes", final_episodes, "N",
                 "episodes of the best policy from shifted starts, after training [the profile's]");
  command.option("--jitter", jitter, "VOXELS",
                 "how far their start coordinates are shifted [the profile's]");
  command.option("--init", init, "POLICY|DIR",
                 "start from this policy, or in a folder from the parent's (<id>.policy.h5); "
                 "robots without one start from scratch");
  command.seed_option();
  command.section("Files");
  command.option("--out-dir", out_dir, "DIR", "where <id>.policy.h5 goes");
  command.option("--log-dir", log_dir, "DIR", "where <id>.log goes [--out-dir]");
  command.option("--curve", curve, "FILE.tsv", "learning curve of one robot as a table");
  command.output_option("where the robots go, with fitness, steps and policy");
  command.flag("--behaviour", behaviour, behaviour_help);
  command.option("--checkpoint-every", checkpoint_every, "N",
                 "save a checkpoint after this many steps; 0: on interruption only");
  command.flag("--keep-checkpoint", keep_checkpoint,
               "keep the end of each training, to go on later (--resume with more --steps)");
  command.flag("--resume", resume, "go on from checkpoints where there are any");
  command.flag("--force", force, "replace policies trained with other settings");
  command.option("--failures", failures, "WHAT",
                 "a training that diverges: stop, or skip (fitness null, go on)");
  command.jobs_option();
  command.progress_option();
}

namespace {

std::int64_t parse_steps(const std::string& text, const char* option) {
  return parse_whole(text, option, 1, std::numeric_limits<std::int64_t>::max());
}

}  // namespace

TrainingSettings TrainingOptions::settings() const {
  TrainingSettings training = load_training(profile, data_folders());
  const auto apply = [&](const std::string& key, const auto& value) {
    if (value) apply_override(training, fmt::format("{}={}", key, *value));
  };
  apply("algorithm", algorithm);
  if (steps) apply("steps", std::optional(parse_steps(*steps, "--steps")));
  apply("final_episodes", final_episodes);
  apply("final_jitter", jitter);
  for (const std::string& assignment : set) apply_override(training, assignment);
  check(training);
  return training;
}

TrainingSettings TrainingOptions::founder_settings() const {
  TrainingSettings training = settings();
  if (founder_steps) training.steps = parse_steps(*founder_steps, "--founder-steps");
  check(training);
  return training;
}

int train_robots(const Command& command, const TrainingOptions& options,
                 const std::vector<Robot>& robots,
                 const std::function<void(const Trained&)>& ended) {
  check_options(options, robots.size());
  const TaskSpec task = options.task.load();
  const TrainingSettings of_children = options.settings();
  const TrainingSettings of_founders = options.founder_settings();
  check_files(options, robots, command.output);
  make_folders(options.out_dir);
  make_folders(options.log_dir.value_or(options.out_dir));

  catch_interrupts();
  TrainingProgress progress(command.progress_style(), robots.size());
  std::atomic<bool> stopped = false;
  Rescue rescue([&] { command.warn(how_to_go_on); });
  Workers workers(command, robots.size());
  workers.pool.run(robots.size(), [&](std::size_t i, int /*worker*/) {
    if (interrupted() != 0 || stopped) return;
    const bool founder = parents_of(robots[i]) == nullptr;
    const Job job{options,      task,    founder ? of_founders : of_children,
                  command.seed, command, rescue};
    TrainingView view{robots[i].id, 0.0, {}, 0.0};
    std::int64_t last_step = 0;
    try {
      Trained trained = train_robot(robots[i], i, job, [&](const TrainingReport& report) {
        view.done = static_cast<double>(report.step) / static_cast<double>(report.steps);
        if (const auto value = metric(report, "eval/return")) {
          view.evaluations.push_back(*value);
          view.best = metric(report, "eval/best").value_or(*value);
        }
        progress.update(i, view, static_cast<double>(report.step - last_step));
        last_step = report.step;
      });
      progress.finish(i);
      trained.index = i;
      if (trained.robot) stop_at_failure(*trained.robot, options);
      ended(trained);
    } catch (const Error& e) {
      stopped = true;
      throw e.at("robot " + robots[i].id);
    }
  });
  const int signal = interrupted();
  return signal == 0 ? 0 : 128 + signal;
}

}  // namespace evo::cli
