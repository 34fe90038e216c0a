// evo-train: a controller for every robot read.
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>

#include "cli/command.h"
#include "cli/data.h"
#include "cli/progress.h"
#include "cli/robots.h"
#include "cli/task_options.h"
#include "formats/files.h"
#include "formats/policy.h"
#include "formats/training.h"
#include "libevo/base/parallel.h"
#include "libevo/control/trainer.h"

namespace {

using namespace evo;
namespace fs = std::filesystem;

struct Settings {
  cli::TaskOptions task;
  std::string profile = "default";
  std::vector<std::string> set;
  std::optional<std::string> algorithm;
  std::optional<std::string> steps;
  std::string out_dir = ".";
  std::optional<std::string> log_dir;
  std::optional<std::string> curve;
  int checkpoint_every = 100'000;
  std::optional<int> final_episodes;
  std::optional<double> jitter;
  bool resume = false;
  bool force = false;
  std::string failures = "stop";
};

TrainingSettings training_settings(const Settings& settings) {
  TrainingSettings training = load_training(settings.profile, cli::data_folders());
  const auto apply = [&](const std::string& key, const auto& value) {
    if (value) apply_override(training, fmt::format("{}={}", key, *value));
  };
  apply("algorithm", settings.algorithm);
  apply("steps", settings.steps);
  apply("final_episodes", settings.final_episodes);
  apply("final_jitter", settings.jitter);
  for (const std::string& assignment : settings.set) apply_override(training, assignment);
  check(training);
  return training;
}

// ---- one robot ------------------------------------------------------------------

// A training's text log: wall-clock figures, kept out of the policy file so that
// the same training is the same file.
class Log {
 public:
  explicit Log(const fs::path& path) : out_(path, std::ios::app) {
    if (!out_) throw error(Failure::cannot_create, "{}: cannot be written", path.string());
  }

  void begin(const std::string& tool, const TaskSpec& task, bool resumed) {
    out_ << "# " << tool << ", " << task.name << (resumed ? ", resumed" : "") << std::endl;
  }
  void line(const TrainingReport& report, double steps_per_second) {
    out_ << "charts/global_step " << report.step << "\tcharts/SPS "
         << fmt::format("{:.0f}", steps_per_second);
    for (const Metric& metric : report.metrics)
      out_ << '\t' << metric.name << ' ' << fmt::format("{:.6g}", metric.value);
    out_ << std::endl;
  }
  void end(double seconds) {
    out_ << fmt::format("# trained in {:.2f} s\n", seconds) << std::flush;
  }

 private:
  std::ofstream out_;
};

struct Job {
  const Settings& settings;
  const TaskSpec& task;
  const TrainingSettings& training;
  std::uint64_t seed;
};

std::optional<double> metric(const TrainingReport& report, const std::string& name) {
  for (const Metric& m : report.metrics)
    if (m.name == name) return m.value;
  return std::nullopt;
}

struct Paths {
  fs::path policy;
  fs::path checkpoint;
  fs::path log;
};

Paths paths_of(const Settings& settings, const std::string& id) {
  const fs::path out = settings.out_dir;
  return {out / (id + ".policy.h5"), out / (id + ".checkpoint.h5"),
          fs::path(settings.log_dir.value_or(settings.out_dir)) / (id + ".log")};
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
  if (job.settings.force) return std::nullopt;
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

// Nothing when interrupted: a checkpoint then lies beside the policy.
std::optional<Robot> train_robot(const Robot& robot, const Job& job,
                                 const std::function<void(const TrainingReport&)>& show) {
  const Paths paths = paths_of(job.settings, robot.id);
  const Arena arena(job.task, robot.body);
  const std::string hash = settings_hash(robot.body, job.task, job.training, job.seed);
  if (auto before = trained_before(robot, job, paths, hash)) return before;

  Trainer trainer(arena, job.training, job.seed, robot.id);
  const bool resumed = job.settings.resume && fs::exists(paths.checkpoint);
  if (resumed) trainer.restore(read_checkpoint(paths.checkpoint, hash));
  const auto save = [&] { write_checkpoint(paths.checkpoint, trainer.checkpoint(), hash); };

  Log log(paths.log);
  log.begin(cli::created_by("evo-train"), job.task, resumed);
  const cli::Clock clock;
  std::optional<std::int64_t> first_step;  // of this process; the clock starts before it
  std::int64_t saved_step = 0;
  while (!trainer.done()) {
    const TrainingReport report = trainer.advance();
    if (!first_step) first_step = saved_step = report.step;
    if (metric(report, "eval/return"))
      log.line(report,
               static_cast<double>(report.step - *first_step) / std::max(clock.seconds(), 1e-9));
    show(report);
    if (trainer.done()) break;
    if (cli::interrupted() != 0) {
      save();
      return std::nullopt;
    }
    if (job.settings.checkpoint_every > 0 &&
        report.step - saved_step >= job.settings.checkpoint_every) {
      save();
      saved_step = report.step;
    }
  }
  const TrainResult result = trainer.result();
  log.end(clock.seconds());
  if (!result.failure)
    write_policy(paths.policy, make_policy_file(robot, arena, job.training, job.seed, result,
                                                cli::created_by("evo-train")));
  std::error_code ignored;
  fs::remove(paths.checkpoint, ignored);
  if (job.settings.curve) write_curve(*job.settings.curve, result.curve);
  return result.failure ? failed(robot, job, *result.failure)
                        : scored(robot, read_policy(paths.policy), paths.policy);
}

void check_options(const Settings& settings, std::size_t robots) {
  if (settings.failures != "stop" && settings.failures != "skip")
    throw error(Failure::usage, "--failures: '{}' is not stop or skip", settings.failures);
  if (settings.curve && robots != 1)
    throw error(Failure::usage,
                "--curve writes the curve of one robot, but {} were read; the "
                "policy files hold the curves of all",
                robots);
}

void make_folder(const std::string& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure)
    throw error(Failure::cannot_create, "{}: cannot make this folder: {}", folder,
                failure.message());
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-train", "trains a controller for each robot read");
  Settings settings;
  std::vector<std::string> files;
  command.arguments(files, "FILE", "robots [standard input]");
  command.section("Task");
  settings.task.add_to(command);
  command.section("Training");
  command.option("--train", settings.profile, "PROFILE",
                 "training profile by name or file: default, paper, release2");
  command.option("--train-set", settings.set, "KEY=VALUE",
                 "one setting of the profile, such as learning_rate=3e-4 (repeatable)");
  command.option("--algo", settings.algorithm, "NAME",
                 "ppo, sine (open loop, by evolution strategy) or random [the profile's]");
  command.option("--steps", settings.steps, "N", "environment steps [the profile's]");
  command.option("--final-episodes", settings.final_episodes, "N",
                 "episodes of the best policy from shifted starts, after training [the profile's]");
  command.option("--jitter", settings.jitter, "VOXELS",
                 "how far their start coordinates are shifted [the profile's]");
  command.seed_option();
  command.section("Files");
  command.option("--out-dir", settings.out_dir, "DIR", "where <id>.policy.h5 goes");
  command.option("--log-dir", settings.log_dir, "DIR", "where <id>.log goes [--out-dir]");
  command.option("--curve", settings.curve, "FILE.tsv", "learning curve of one robot as a table");
  command.output_option("where the robots go, with fitness, steps and policy");
  command.option("--checkpoint-every", settings.checkpoint_every, "N",
                 "save a checkpoint after this many steps; 0: on interruption only");
  command.flag("--resume", settings.resume, "go on from checkpoints where there are any");
  command.flag("--force", settings.force, "replace policies trained with other settings");
  command.option("--failures", settings.failures, "WHAT",
                 "a training that diverges: stop, or skip (fitness null, go on)");
  command.jobs_option();
  command.progress_option();
  command.example("evo-sample -n 4 | evo-train --task Walker-v0 --steps 102400 --out-dir policies",
                  "four random robots, trained in parallel");
  command.example("evo-train best.json --task Climber-v0 --train paper --out-dir climb --resume",
                  "with the settings of the paper, going on after an interruption");

  return command.run(argc, argv, [&] {
    const std::vector<Robot> robots = cli::read_robots(files);
    check_options(settings, robots.size());
    const TaskSpec task = settings.task.load();
    const TrainingSettings training = training_settings(settings);
    make_folder(settings.out_dir);
    make_folder(settings.log_dir.value_or(settings.out_dir));

    cli::catch_interrupts();
    cli::OrderedWriter out(command.output);
    cli::TrainingProgress progress(command.show_progress(), robots.size());
    std::atomic<bool> stopped = false;
    const Job job{settings, task, training, command.seed};
    ThreadPool pool(command.jobs);
    pool.run(robots.size(), [&](std::size_t i, int /*worker*/) {
      if (cli::interrupted() != 0 || stopped) return;
      const Robot& robot = robots[i];
      cli::TrainingView view{robot.id, 0.0, {}, 0.0};
      std::int64_t last_step = 0;
      try {
        const auto result = train_robot(robot, job, [&](const TrainingReport& report) {
          view.done = static_cast<double>(report.step) / static_cast<double>(report.steps);
          if (const auto value = metric(report, "eval/return")) {
            view.evaluations.push_back(*value);
            view.best = metric(report, "eval/best").value_or(*value);
          }
          progress.update(i, view, static_cast<double>(report.step - last_step));
          last_step = report.step;
        });
        progress.finish(i);
        if (!result) return;
        const auto failure = result->document.find("failure");
        if (failure != result->document.end() && settings.failures == "stop")
          throw error(Failure::work, "training failed at step {} with seed {}: {}",
                      (*failure)["step"].dump(), (*failure)["seed"].dump(),
                      (*failure)["why"].get<std::string>());
        out.put(i, *result);
      } catch (const Error& e) {
        stopped = true;
        throw e.at("robot " + robot.id);
      }
    });
    if (const int signal = cli::interrupted()) {
      fmt::print(stderr, "{}: interrupted; give the same command with --resume to go on\n",
                 command.name());
      return 128 + signal;
    }
    out.finish();
    return 0;
  });
}
