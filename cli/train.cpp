#include "cli/train.h"

#include <atomic>
#include <cmath>
#include <deque>
#include <span>
#include <string_view>
#include <system_error>

#include "cli/start.h"
#include "formats/io/files.h"
#include "formats/rollout/episodes.h"
#include "formats/task/text.h"
#include "formats/training/policy.h"
#include "formats/training/training_log.h"
#include "libevo/base/error.h"
#include "libevo/control/methods.h"
#include "libevo/control/open_loop.h"

namespace evo {
namespace {

namespace fs = std::filesystem;

Robot failed(const TrainingPlan& plan, const Robot& robot, const TrainingFailure& failure) {
  Robot result = robot.failed({failure.why, failure.step, failure.seed});
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

// Whether the policy is of a training with exactly these settings (with --resume: perhaps in
// parts).
bool trained_before(const TrainingPlan& plan, const Robot& robot, const fs::path& policy,
                    const TrainingStart& start) {
  if (!fs::exists(policy)) return false;
  try {
    const std::string there = read_policy_identity(policy);
    const auto span = span_of_same(there, start.identity.lines);
    const bool in_parts = plan.resume && span && span->steps == plan.settings(robot).steps;
    if (there == start.identity.lines || in_parts) return true;
    if (!plan.replace && !is_part(there, start))
      throw trained_otherwise(policy, difference(there, start.identity.lines));
  } catch (const Error& e) {  // damaged, or no policy at all
    if (!plan.replace || e.kind() != Failure::data) throw;
  }
  return false;
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

// ---- one training ---------------------------------------------------------------------

// One training from its start to its files, or to a checkpoint where it is interrupted: of
// one robot, or of one controller for several.
class Training {
 public:
  Training(const TrainingPlan& plan, std::span<const Robot> robots, std::size_t index,
           const cli::Journal& journal, cli::TrainingProgress& progress)
      : plan_(plan),
        robots_(robots),
        index_(index),
        journal_(journal),
        progress_(progress),
        view_{robots.front().id, 0.0, {}, 0.0, 0.0},
        paths_(training_paths(plan, robots.front().id)) {
    for (const Robot& robot : robots) {
      try {
        arenas_.emplace_back(plan.task, robot.body);
      } catch (const Error& e) {
        if (!plan.shared) throw;
        throw e.at("robot " + robot.id);
      }
    }
    for (const Arena& arena : arenas_) pointers_.push_back(&arena);
  }

  // The robots with their fitness or failure, or nothing: interrupted.
  std::vector<Robot> run() {
    start_ = find_start(plan_, first(), pointers_);
    if (trained_before(plan_, first(), paths_.policy, start_))
      return scored_by(read_policy(paths_.policy));
    return train();
  }

 private:
  const Robot& first() const { return robots_.front(); }

  std::vector<Robot> train() {
    // What is there is an earlier end of the same training.
    const bool replaces_part = !plan_.replace && start_.checkpoint && fs::exists(paths_.policy) &&
                               is_part(read_policy_identity(paths_.policy), start_);
    Trainer trainer(pointers_, plan_.settings(first()), plan_.seed, stream_name(plan_, first()),
                    start_.inheritance);
    begin(trainer);
    journal_.begun(journal_name(plan_, first()));

    TrainingLog log(paths_.log);
    log.begin(cli::created_by("evo-train"), plan_.task.name, start_.checkpoint.has_value());
    cli::Journal::Work work;
    work.started = cli::seconds_since_1970();
    const cli::Clock clock;
    work.finished = advance(trainer, log, work.steps, clock);
    std::vector<Robot> measured;
    if (work.finished) {
      log.end(clock.seconds());
      measured = finish(trainer, replaces_part);
    } else {
      save(trainer);
    }
    work.seconds = clock.seconds();
    journal_.add(journal_name(plan_, first()), work);
    return measured;
  }

  void begin(Trainer& trainer) {
    const std::string what = plan_.shared ? *plan_.shared : "robot " + first().id;
    if (start_.checkpoint) {
      restore(trainer, *start_.checkpoint, paths_.checkpoint);
      cli::log::info(fmt::format("{}: continues from {}", what, paths_.checkpoint.string()));
    } else if (fs::exists(paths_.checkpoint)) {
      cli::log::info(fmt::format("{}: begins anew; --resume would continue from {}", what,
                                 paths_.checkpoint.string()));
    }
  }

  void save(const Trainer& trainer) {
    write_checkpoint(paths_.checkpoint, trainer.checkpoint(), start_.identity);
  }

  void show(const TrainingReport& report) {
    view_.steps = static_cast<double>(report.step);
    view_.done = view_.steps / static_cast<double>(report.steps);
    if (const auto value = metric(report, "eval/return")) {
      view_.evaluations.push_back(*value);
      view_.best = metric(report, "eval/best").value_or(*value);
      cli::log::debug(fmt::format("robot {}: step {} of {}, return {:.4g}, best {:.4g}", view_.id,
                                  report.step, report.steps, *value, view_.best));
    }
    progress_.update(index_, view_);
  }

  // To the end of the training, or false: interrupted. `steps` are those taken.
  bool advance(Trainer& trainer, TrainingLog& log, std::int64_t& steps, const cli::Clock& clock) {
    const std::int64_t first_step = trainer.result().steps;  // of this process
    std::int64_t saved_step = first_step;
    while (!trainer.done()) {
      const TrainingReport report = trainer.advance();
      steps = report.step - first_step;
      if (metric(report, "eval/return"))
        log.line(report, static_cast<double>(steps) / std::max(clock.seconds(), 1e-9));
      show(report);
      if (trainer.done()) break;
      if (cli::interrupted() != 0) return false;
      if (plan_.checkpoint_every > 0 && report.step - saved_step >= plan_.checkpoint_every) {
        save(trainer);
        saved_step = report.step;
      }
    }
    return true;
  }

  // The policy comes last: it says that the training has ended.
  std::vector<Robot> finish(const Trainer& trainer, bool replaces_part) {
    const TrainResult& result = trainer.result();
    const bool keeps = plan_.keep_checkpoint && !result.failure;
    if (keeps) save(trainer);
    std::vector<Robot> measured;
    if (result.failure) {
      for (const Robot& robot : robots_) measured.push_back(failed(plan_, robot, *result.failure));
    } else {
      const PolicyFile file = policy_file(result);
      save_policy(paths_.policy, file, plan_.replace || replaces_part);
      measured = scored_by(file);
    }
    std::error_code ignored;
    if (!keeps) fs::remove(paths_.checkpoint, ignored);
    return measured;
  }

  PolicyFile policy_file(const TrainResult& result) const {
    const auto file_of = [&](std::size_t i) {
      return make_policy_file(robots_[i], arenas_[i], plan_.settings(first()), plan_.seed, result,
                              cli::created_by("evo-train"), start_.origin);
    };
    if (!plan_.shared) return file_of(0);
    // What each robot earns with the controller of all.
    std::vector<Robot> all(robots_.begin(), robots_.end());
    std::size_t best = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      try {
        // An unstable one once more, for the reason.
        const bool known = i < result.each.size() && !std::isnan(result.each[i]);
        all[i].set_fitness(known ? result.each[i]
                                 : evaluate(arenas_[i], *result.controller,
                                            evaluation_of(plan_.settings(all[i]), plan_.seed))
                                       .mean());
      } catch (const Error& e) {
        if (e.kind() != Failure::work) throw;
        all[i] = all[i].failed({e.what(), std::nullopt, plan_.seed});
      }
      if (all[i].fitness() && (!all[best].fitness() || *all[i].fitness() > *all[best].fitness()))
        best = i;
    }
    PolicyFile file = file_of(best);
    file.robot = all[best];
    file.robots = std::move(all);
    file.identity = start_.identity.lines;
    file.settings_hash = start_.identity.hash();
    return file;
  }

  // The robots with what their policy says of them.
  std::vector<Robot> scored_by(const PolicyFile& file) const {
    if (!plan_.shared)
      return {scored(plan_, first(), file.fitness, paths_.policy, file, arenas_.front())};
    std::vector<Robot> all;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      const Robot& known = file.robots.at(i);
      if (const auto fitness = known.fitness()) {
        all.push_back(scored(plan_, robots_[i], *fitness, paths_.policy, file, arenas_[i]));
      } else {
        const auto failure = known.failure();
        all.push_back(failed(plan_, robots_[i],
                             {failure ? failure->why : "no fitness", file.steps, file.seed}));
      }
    }
    return all;
  }

  const TrainingPlan& plan_;
  std::span<const Robot> robots_;
  std::size_t index_;  // of the first
  const cli::Journal& journal_;
  cli::TrainingProgress& progress_;
  cli::TrainingView view_;
  TrainingPaths paths_;
  std::deque<Arena> arenas_;  // of each robot
  std::vector<const Arena*> pointers_;
  TrainingStart start_;
};

void stop_at_failure(const TrainingPlan& plan, const Robot& robot) {
  const auto failure = robot.failure();
  if (!failure || plan.skip_failures) return;
  throw error(Failure::work, "training failed at step {} with seed {}: {}",
              failure->step.value_or(0), failure->seed.value_or(0), failure->why);
}

}  // namespace

Robot scored(const TrainingPlan& plan, const Robot& robot, double fitness, const fs::path& path,
             const PolicyFile& policy, const Arena& arena) {
  Robot result = robot;
  result.set_fitness(fitness);
  result.document["task"] = policy.task;
  result.document["steps"] = policy.steps;
  result.document["policy"] = path.string();
  if (plan.shared) return result;
  if (const auto& score = policy.final_score)
    result.document["final"] = {{"episodes", score->episodes},
                                {"mean", score->mean},
                                {"standard_error", score->standard_error}};
  // The best evaluation once more, to look at: it has the same bits.
  BehaviourGauge gauge;
  evaluate(arena, policy.controller, evaluation_of(plan.settings(robot), plan.seed),
           [&](const EpisodeMoment& moment) { gauge.record(moment); });
  result.document["behaviour"] = gauge.mean();
  return result;
}

const TrainingSettings& TrainingPlan::settings(const Robot& robot) const {
  return robot.parents().empty() && !shared ? founders : children;
}

TrainingPaths training_paths(const TrainingPlan& plan, const std::string& id) {
  if (plan.shared) {
    std::string stem = *plan.shared;
    for (const std::string_view end : {".h5", ".policy"})
      if (stem.size() > end.size() && stem.ends_with(end)) stem.resize(stem.size() - end.size());
    return {*plan.shared, stem + ".checkpoint.h5", stem + ".log"};
  }
  const fs::path folder = plan.policies;
  return {folder / (id + ".policy.h5"), folder / (id + ".checkpoint.h5"), folder / (id + ".log")};
}

std::string journal_name(const TrainingPlan& plan, const Robot& robot) {
  return plan.shared ? training_paths(plan, robot.id).log.stem().string() : robot.id;
}

std::string stream_name(const TrainingPlan& plan, const Robot& robot) {
  return plan.shared ? "shared" : robot.id;
}

void check_trainings(const TrainingPlan& plan, const std::vector<Robot>& robots) {
  if (robots.empty()) return;
  std::optional<Arena> arena;
  try {
    arena.emplace(plan.task, full_body(robots.front().body.rows, robots.front().body.cols));
  } catch (const Error&) {
    return;
  }
  const auto begin = [&](const TrainingSettings& settings, bool inherits, std::size_t count) {
    std::optional<Inheritance> inheritance;
    // A modular policy would have to be of the settings' own shape to say anything.
    if (inherits && !abilities(settings.algorithm).shares)
      inheritance = {travelling_wave(arena->action_length(), 0.5, 20.0, 0.5), anatomy(*arena)};
    const std::vector<const Arena*> all(count, &*arena);
    (void)Trainer(all, settings, plan.seed, "", std::move(inheritance));
  };
  if (plan.shared) return begin(plan.children, false, robots.size());
  const bool init_is_one = plan.init && !fs::is_directory(*plan.init);
  begin(plan.founders, plan.founders_from || init_is_one, 1);
  begin(plan.children, plan.init.has_value(), 1);
}

int train_robots(const cli::Command& command, const TrainingPlan& plan,
                 const std::vector<Robot>& robots, const cli::Journal& journal,
                 const std::function<void(std::size_t, Robot)>& put) {
  cli::catch_interrupts();
  make_folders(plan.shared ? fs::absolute(*plan.shared).parent_path() : fs::path(plan.policies));
  const std::size_t trainings =
      plan.shared ? std::min<std::size_t>(robots.size(), 1) : robots.size();
  for (std::size_t i = 0; i < trainings; ++i) journal.take(journal_name(plan, robots[i]));
  cli::TrainingProgress progress(command.progress_style(), robots.size());
  const auto train = [&](std::span<const Robot> of, std::size_t index) {
    const std::vector<Robot> measured = Training(plan, of, index, journal, progress).run();
    for (std::size_t i = 0; i < measured.size(); ++i) {
      stop_at_failure(plan, measured[i]);
      put(index + i, measured[i]);
    }
    for (std::size_t i = 0; i < of.size(); ++i) progress.finish(index + i);
    journal.ended(journal_name(plan, of.front()));
  };
  cli::Workers workers(command, plan.shared ? 1 : robots.size());
  std::atomic<bool> stopped = false;
  if (plan.shared) {
    if (!robots.empty()) train(robots, 0);
  } else {
    workers.pool.run(robots.size(), [&](std::size_t i, int /*worker*/) {
      if (cli::interrupted() != 0 || stopped) return;
      try {
        train(std::span(robots).subspan(i, 1), i);
      } catch (const Error& e) {
        stopped = true;
        throw e.at("robot " + robots[i].id);
      }
    });
  }
  return cli::interrupted() == 0 ? 0 : 128 + cli::interrupted();
}

}  // namespace evo
