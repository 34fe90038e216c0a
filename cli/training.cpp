#include "cli/training.h"

#include <atomic>
#include <chrono>
#include <filesystem>

#include "cli/data.h"
#include "cli/progress.h"
#include "formats/files.h"
#include "formats/policy.h"
#include "formats/run.h"
#include "formats/training.h"
#include "formats/training_log.h"
#include "libevo/base/parallel.h"
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
};

struct Paths {
  fs::path policy;
  fs::path checkpoint;
  fs::path log;
};

void make_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure)
    throw error(Failure::cannot_create, "{}: cannot make this folder: {}", folder.string(),
                failure.message());
}

Paths paths_of(const TrainingOptions& options, const std::string& id) {
  fs::path out = options.out_dir;
  fs::path logs = options.log_dir.value_or(options.out_dir);
  if (options.sharded) {
    out /= run_shard(id);
    logs /= run_shard(id);
  }
  make_folder(out);
  make_folder(logs);
  return {out / (id + ".policy.h5"), out / (id + ".checkpoint.h5"), logs / (id + ".log")};
}

std::int64_t seconds_since_1970() {
  return std::chrono::duration_cast<std::chrono::seconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

Robot scored(const Robot& robot, const PolicyFile& file, const fs::path& policy) {
  Robot result = robot;
  result.document.erase("failure");
  result.document["fitness"] = file.fitness;
  result.document["task"] = file.task;
  result.document["steps"] = file.steps;
  result.document["policy"] = policy.string();
  if (const auto& score = file.final_score)
    result.document["final"] = {{"episodes", score->episodes},
                                {"mean", score->mean},
                                {"standard_error", score->standard_error}};
  return result;
}

Robot failed(const Robot& robot, const Job& job, const TrainingFailure& failure) {
  Robot result = robot;
  result.document["fitness"] = nullptr;
  result.document["task"] = job.task.name;
  result.document["steps"] = failure.step;
  result.document["failure"] = {
      {"why", failure.why}, {"step", failure.step}, {"seed", failure.seed}};
  return result;
}

// The robot as it was trained before with exactly these settings, or nothing.
std::optional<Robot> trained_before(const Robot& robot, const Job& job, const Paths& paths,
                                    const std::string& hash) {
  if (!fs::exists(paths.policy)) return std::nullopt;
  if (read_policy_hash(paths.policy) == hash)
    return scored(robot, read_policy(paths.policy), paths.policy);
  if (job.options.force) return std::nullopt;
  throw error(Failure::cannot_create,
              "{}: trained with other settings; choose another --out-dir, or --force to replace it",
              paths.policy.string());
}

void write_curve(const std::string& path, const std::vector<CurvePoint>& curve) {
  std::string table = "step\treturn\tbest\n";
  for (const CurvePoint& point : curve)
    table += fmt::format("{}\t{}\t{}\n", point.step, point.evaluation, point.best);
  write_file(path, table);
}

// Without a robot when interrupted: a checkpoint then lies beside the policy.
Trained train_robot(const Robot& robot, const Job& job,
                    const std::function<void(const TrainingReport&)>& show) {
  const Paths paths = paths_of(job.options, robot.id);
  const Arena arena(job.task, robot.body);
  const std::string hash = settings_hash(robot.body, job.task, job.training, job.seed);
  Trained trained;
  trained.robot = trained_before(robot, job, paths, hash);
  trained.known = trained.robot.has_value();
  if (trained.known) return trained;

  Trainer trainer(arena, job.training, job.seed, robot.id);
  const bool resumed = job.options.resume && fs::exists(paths.checkpoint);
  if (resumed) trainer.restore(read_checkpoint(paths.checkpoint, hash));
  const auto save = [&] { write_checkpoint(paths.checkpoint, trainer.checkpoint(), hash); };

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
  if (!result.failure)
    write_policy(paths.policy, make_policy_file(robot, arena, job.training, job.seed, result,
                                                created_by(trained_by)));
  std::error_code ignored;
  fs::remove(paths.checkpoint, ignored);
  if (job.options.curve) write_curve(*job.options.curve, result.curve);
  trained.robot = result.failure ? failed(robot, job, *result.failure)
                                 : scored(robot, read_policy(paths.policy), paths.policy);
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
  const auto failure = robot.document.find("failure");
  if (failure == robot.document.end() || options.failures != "stop") return;
  throw error(Failure::work, "training failed at step {} with seed {}: {}",
              (*failure)["step"].dump(), (*failure)["seed"].dump(),
              (*failure)["why"].get<std::string>());
}

}  // namespace

void TrainingOptions::add_to(Command& command) {
  command.section("Task");
  task.add_to(command);
  command.section("Training");
  command.option("--train", profile, "PROFILE",
                 "training profile by name or file: default, paper, release2");
  command.option("--train-set", set, "KEY=VALUE",
                 "one setting of the profile, such as learning_rate=3e-4 (repeatable)");
  command.option("--algo", algorithm, "NAME",
                 "ppo, sine (open loop, by evolution strategy) or random [the profile's]");
  command.option("--steps", steps, "N", "environment steps [the profile's]");
  command.option("--final-episodes", final_episodes, "N",
                 "episodes of the best policy from shifted starts, after training [the profile's]");
  command.option("--jitter", jitter, "VOXELS",
                 "how far their start coordinates are shifted [the profile's]");
  command.seed_option();
  command.section("Files");
  command.option("--out-dir", out_dir, "DIR", "where <id>.policy.h5 goes");
  command.option("--log-dir", log_dir, "DIR", "where <id>.log goes [--out-dir]");
  command.option("--curve", curve, "FILE.tsv", "learning curve of one robot as a table");
  command.output_option("where the robots go, with fitness, steps and policy");
  command.option("--checkpoint-every", checkpoint_every, "N",
                 "save a checkpoint after this many steps; 0: on interruption only");
  command.flag("--resume", resume, "go on from checkpoints where there are any");
  command.flag("--force", force, "replace policies trained with other settings");
  command.option("--failures", failures, "WHAT",
                 "a training that diverges: stop, or skip (fitness null, go on)");
  command.jobs_option();
  command.progress_option();
}

TrainingSettings TrainingOptions::settings() const {
  TrainingSettings training = load_training(profile, data_folders());
  const auto apply = [&](const std::string& key, const auto& value) {
    if (value) apply_override(training, fmt::format("{}={}", key, *value));
  };
  apply("algorithm", algorithm);
  apply("steps", steps);
  apply("final_episodes", final_episodes);
  apply("final_jitter", jitter);
  for (const std::string& assignment : set) apply_override(training, assignment);
  check(training);
  return training;
}

int train_robots(const Command& command, const TrainingOptions& options,
                 const std::vector<Robot>& robots,
                 const std::function<void(const Trained&)>& ended) {
  check_options(options, robots.size());
  const TaskSpec task = options.task.load();
  const TrainingSettings training = options.settings();
  make_folder(options.out_dir);
  make_folder(options.log_dir.value_or(options.out_dir));

  catch_interrupts();
  TrainingProgress progress(command.show_progress(), robots.size());
  std::atomic<bool> stopped = false;
  const Job job{options, task, training, command.seed};
  ThreadPool pool(command.jobs);
  pool.run(robots.size(), [&](std::size_t i, int /*worker*/) {
    if (interrupted() != 0 || stopped) return;
    TrainingView view{robots[i].id, 0.0, {}, 0.0};
    std::int64_t last_step = 0;
    try {
      Trained trained = train_robot(robots[i], job, [&](const TrainingReport& report) {
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
