#include "training/train.h"

#include <atomic>
#include <chrono>
#include <exception>
#include <system_error>

#include "formats/io/files.h"
#include "formats/run/run.h"
#include "formats/task/text.h"
#include "formats/training/policy.h"
#include "formats/training/training_log.h"
#include "libevo/base/error.h"
#include "libevo/control/method.h"
#include "libevo/control/sine.h"
#include "training/episodes.h"
#include "training/rescue.h"
#include "training/start.h"

namespace evo {
namespace {

namespace fs = std::filesystem;
using SteadyClock = std::chrono::steady_clock;

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

// To the millisecond.
double seconds_since_1970() {
  using namespace std::chrono;
  const auto now = system_clock::now().time_since_epoch();
  return static_cast<double>(duration_cast<milliseconds>(now).count()) / 1000.0;
}

// ---- what a robot's document says of its training -----------------------------------

// The best evaluation once more, to look at: it has the same bits.
Json behaviour_of(const TrainingPlan& plan, const PolicyFile& file, const Arena& arena) {
  BehaviourGauge gauge;
  evaluate(arena, to_controller(file.controller),
           TrainingJob{arena, plan.settings(file.robot), plan.seed, file.robot.id}.evaluation(),
           [&](const EpisodeMoment& moment) { gauge.record(moment); });
  return gauge.mean();
}

Robot scored(const TrainingPlan& plan, const Robot& robot, const fs::path& policy,
             const Arena& arena) {
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
  if (plan.behaviour) result.document["behaviour"] = behaviour_of(plan, file, arena);
  return result;
}

Robot failed(const TrainingPlan& plan, const Robot& robot, const TrainingFailure& failure) {
  Robot result = robot;
  result.set_failure({failure.why, failure.step, failure.seed});
  result.document["task"] = plan.task.name;
  result.document["steps"] = failure.step;
  return result;
}

// ---- policies that are there ----------------------------------------------------------

Error trained_otherwise(const fs::path& policy, const std::string& difference) {
  return error(Failure::cannot_create,
               "{}: trained with other settings ({}); choose another --out-dir, or --force to "
               "replace it",
               policy.string(), difference);
}

// The robot as it was trained before with exactly these settings (with --resume:
// perhaps in parts), or nothing.
std::optional<Robot> trained_before(const TrainingPlan& plan, const Robot& robot,
                                    const Arena& arena, const fs::path& policy,
                                    const TrainingStart& start) {
  if (!fs::exists(policy)) return std::nullopt;
  try {
    const std::string there = read_policy_identity(policy);
    const auto span = span_of_same(there, start.identity.lines);
    const bool in_parts = plan.resume && span && span->steps == plan.settings(robot).steps;
    if (there == start.identity.lines || in_parts) return scored(plan, robot, policy, arena);
    if (!plan.replace && !is_part(there, start))
      throw trained_otherwise(policy, difference(there, start.identity.lines));
  } catch (const Error& e) {  // damaged, or no policy at all
    if (!plan.replace || e.kind() != Failure::data) throw;
  }
  return std::nullopt;
}

// Another process may have finished the same robot with other settings meanwhile;
// its work is not overwritten.
void save_policy(const fs::path& path, const PolicyFile& policy, bool replace) {
  try {
    write_policy(path, policy, replace ? Existing::replaced : Existing::refused);
  } catch (const Error& e) {
    if (e.kind() != Failure::cannot_create || !fs::exists(path)) throw;
    const std::string there = read_policy_identity(path);
    if (there != policy.identity) throw trained_otherwise(path, difference(there, policy.identity));
  }
}

void write_curve(const fs::path& path, const std::vector<CurvePoint>& curve) {
  std::string table = "step\treturn\tbest\n";
  for (const CurvePoint& point : curve)
    table += fmt::format("{}\t{}\t{}\n", point.step, point.evaluation, point.best);
  write_file(path, table);
}

// ---- one robot ------------------------------------------------------------------------

// One training from its start to its files, or to a checkpoint where it is interrupted.
class Training {
 public:
  Training(const TrainingPlan& plan, const Robot& robot, std::size_t index, Rescue& rescue,
           const TrainingObserver& observer)
      : plan_(plan),
        robot_(robot),
        index_(index),
        rescue_(rescue),
        observer_(observer),
        paths_(training_paths(plan, robot.id)),
        arena_(plan.task, robot.body) {}

  Trained run() {
    if (plan_.sharded)
      for (const fs::path& file : {paths_.policy, paths_.log}) make_folders(file.parent_path());
    start_ = find_start(plan_, robot_, arena_);
    Trained trained;
    trained.index = index_;
    trained.robot = trained_before(plan_, robot_, arena_, paths_.policy, start_);
    trained.known = trained.robot.has_value();
    if (!trained.known) train(trained);
    return trained;
  }

 private:
  void train(Trained& trained) {
    // What is there is an earlier end of the same training.
    const bool replaces_part = !plan_.replace && start_.checkpoint && fs::exists(paths_.policy) &&
                               is_part(read_policy_identity(paths_.policy), start_);
    Trainer trainer(arena_, plan_.settings(robot_), plan_.seed, robot_.id, start_.inheritance);
    begin(trainer);

    TrainingLog log(paths_.log);
    log.begin(plan_.created_by, plan_.task.name, start_.checkpoint.has_value());
    trained.started = seconds_since_1970();
    const auto began = SteadyClock::now();
    const bool ended = advance(trainer, log, trained, began);
    if (ended) {
      log.end(seconds_since(began));
      trained.robot = finish(trainer, replaces_part);
    } else {
      save(trainer);
    }
    trained.seconds = seconds_since(began);
  }

  void begin(Trainer& trainer) {
    if (start_.checkpoint) {
      restore(trainer, *start_.checkpoint, paths_.checkpoint);
      if (plan_.note_resumed)
        observer_.note(
            fmt::format("robot {}: goes on from {}", robot_.id, paths_.checkpoint.string()));
    } else if (fs::exists(paths_.checkpoint)) {
      observer_.note(fmt::format("robot {}: begins anew; --resume would go on from {}", robot_.id,
                                 paths_.checkpoint.string()));
    }
  }

  void save(const Trainer& trainer) {
    write_checkpoint(paths_.checkpoint, trainer.checkpoint(), start_.identity);
  }

  // To the end of the training, or false: interrupted.
  bool advance(Trainer& trainer, TrainingLog& log, Trained& trained,
               SteadyClock::time_point began) {
    const std::int64_t first_step = trainer.result().steps;  // of this process
    std::int64_t saved_step = first_step;
    while (!trainer.done()) {
      const TrainingReport report = trainer.advance();
      trained.steps = report.step - first_step;
      if (metric(report, "eval/return"))
        log.line(report, static_cast<double>(trained.steps) / std::max(seconds_since(began), 1e-9));
      observer_.progress(index_, report);
      if (trainer.done()) break;
      rescue_.keep(index_, trainer.checkpoint(), paths_.checkpoint, start_.identity);
      if (observer_.interrupted() != 0) return false;
      if (plan_.checkpoint_every > 0 && report.step - saved_step >= plan_.checkpoint_every) {
        save(trainer);
        saved_step = report.step;
      }
    }
    return true;
  }

  // The policy comes last: it says that the training has ended.
  Robot finish(const Trainer& trainer, bool replaces_part) {
    const TrainResult result = trainer.result();
    const bool keeps = plan_.keep_checkpoint && !result.failure;
    if (keeps) save(trainer);
    if (!result.failure)
      save_policy(paths_.policy,
                  make_policy_file(robot_, arena_, plan_.settings(robot_), plan_.seed, result,
                                   plan_.created_by, start_.origin),
                  plan_.replace || replaces_part);
    rescue_.forget(index_);
    std::error_code ignored;
    if (!keeps) fs::remove(paths_.checkpoint, ignored);
    if (plan_.curve) write_curve(*plan_.curve, result.curve);
    return result.failure ? failed(plan_, robot_, *result.failure)
                          : scored(plan_, robot_, paths_.policy, arena_);
  }

  const TrainingPlan& plan_;
  const Robot& robot_;
  std::size_t index_;
  Rescue& rescue_;
  const TrainingObserver& observer_;
  TrainingPaths paths_;
  Arena arena_;
  TrainingStart start_;
};

void stop_at_failure(const TrainingPlan& plan, const Robot& robot) {
  const auto failure = robot.failure();
  if (!failure || plan.skip_failures) return;
  throw error(Failure::work, "training failed at step {} with seed {}: {}",
              failure->step.value_or(0), failure->seed.value_or(0), failure->why);
}

}  // namespace

const TrainingSettings& TrainingPlan::settings(const Robot& robot) const {
  return robot.parents().empty() ? founders : children;
}

TrainingPaths training_paths(const TrainingPlan& plan, const std::string& id) {
  const auto folder = [&](const fs::path& of_all) {
    return plan.sharded ? of_all / run_shard(id) : of_all;
  };
  return {folder(plan.policies) / (id + ".policy.h5"),
          folder(plan.policies) / (id + ".checkpoint.h5"), folder(plan.logs) / (id + ".log")};
}

void check_settings(const TrainingPlan& plan, const TrainingSettings& settings, int rows, int cols,
                    Inherits inherits) {
  std::optional<Arena> arena;
  try {
    arena.emplace(plan.task, full_body(rows, cols));
  } catch (const Error&) {
    return;
  }
  std::optional<Inheritance> inheritance;
  if (inherits == Inherits::yes)
    inheritance = {travelling_wave(arena->action_length(), 0.5, 20.0, 0.5),
                   anatomy(arena->robot(), arena->layout())};
  (void)Trainer(*arena, settings, plan.seed, "", std::move(inheritance));
}

int train_robots(const TrainingPlan& plan, const std::vector<Robot>& robots, ThreadPool& pool,
                 const TrainingObserver& observer) {
  if (plan.curve && robots.size() != 1)
    throw error(Failure::usage,
                "--curve writes the curve of one robot, but {} were read; the "
                "policy files hold the curves of all",
                robots.size());
  make_folders(plan.policies);
  make_folders(plan.logs);
  Rescue rescue(observer.interrupted, observer.farewell);
  std::atomic<bool> stopped = false;
  pool.run(robots.size(), [&](std::size_t i, int /*worker*/) {
    if (observer.interrupted() != 0 || stopped) return;
    try {
      const Trained trained = Training(plan, robots[i], i, rescue, observer).run();
      if (trained.robot) stop_at_failure(plan, *trained.robot);
      observer.ended(trained);
    } catch (const Error& e) {
      stopped = true;
      throw e.at("robot " + robots[i].id);
    }
  });
  return observer.interrupted();
}

}  // namespace evo
