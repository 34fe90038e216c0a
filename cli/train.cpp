#include "cli/train.h"

#include <atomic>
#include <cmath>
#include <deque>
#include <span>
#include <string_view>
#include <system_error>

#include "formats/io/files.h"
#include "formats/rollout/episodes.h"
#include "formats/task/text.h"
#include "formats/training/identity.h"
#include "formats/training/policy.h"
#include "formats/training/training_log.h"
#include "libevo/base/digest.h"
#include "libevo/base/error.h"
#include "libevo/control/checkpoint.h"
#include "libevo/control/methods.h"
#include "libevo/control/open_loop.h"
#include "libevo/control/transfer.h"

namespace evo {
namespace {

namespace fs = std::filesystem;

Robot failed(const TrainingPlan& plan, const Robot& robot, const TrainingFailure& failure) {
  Robot result = robot.failed({failure.why, failure.step, failure.seed});
  result.document["task"] = plan.task.name;
  result.document["steps"] = failure.step;
  return result;
}

// ---- what a training starts from ------------------------------------------------------

// Nothing, the controller of a parent, or a checkpoint of the same training.
struct TrainingStart {
  std::optional<Inheritance> inheritance;
  TrainingOrigin origin;
  TrainingIdentity identity;             // of the whole training
  std::optional<Checkpoint> checkpoint;  // to continue from
};

// A robot's policy in the folder.
std::optional<fs::path> policy_in(const fs::path& folder, const std::string& id) {
  if (const fs::path path = folder / (id + ".policy.h5"); fs::exists(path)) return path;
  return std::nullopt;
}

// The policy that a robot starts from. Founders may have one of their own; in a folder of
// parents' it is that of the first parent which has one. Nothing: from scratch.
std::optional<fs::path> inherited_policy(const TrainingPlan& plan, const Robot& robot) {
  if (plan.own) return policy_in(*plan.own, robot.id);
  const std::vector<std::string> parents = robot.parents();
  if (parents.empty() && plan.founders_from) {
    if (fs::is_regular_file(*plan.founders_from)) return plan.founders_from;
    if (auto own = policy_in(*plan.founders_from, robot.id)) return own;
    throw error(Failure::no_input, "{}: has no policy of robot {} to continue from",
                *plan.founders_from, robot.id);
  }
  if (!plan.init) return std::nullopt;
  if (plan.shared && fs::is_directory(*plan.init))
    throw error(Failure::usage,
                "--init {}: one controller for all robots starts from one policy, not from those "
                "of a folder",
                *plan.init);
  if (!fs::is_directory(*plan.init)) return plan.init;
  for (const std::string& parent : parents)
    if (auto path = policy_in(*plan.init, parent)) return path;
  return std::nullopt;
}

// How many robots, and which.
std::string names_of_all(const std::vector<const Arena*>& robots) {
  std::string ids;
  for (const Arena* robot : robots) ids += identity(robot->robot()) + "\n";
  return fmt::format("{} {}", robots.size(), sha256_hex(ids));
}

TrainingIdentity identity_of(const TrainingPlan& plan, const Robot& robot, std::int64_t steps,
                             const TrainingOrigin& origin) {
  TrainingSettings settings = plan.settings(robot);
  settings.steps = steps;
  return identify(robot.body, plan.task, settings, plan.seed, origin);
}

// What names the random streams of a training.
std::string stream_name(const TrainingPlan& plan, const Robot& robot) {
  return plan.shared ? "shared" : robot.id;
}

// The trainer in the state of the checkpoint, which came from `path`.
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
void go_on(const TrainingPlan& plan, const Robot& robot, const std::vector<const Arena*>& robots,
           const fs::path& path, TrainingStart& start) {
  const TrainingSettings& settings = plan.settings(robot);
  const auto span = span_of_same(read_checkpoint_identity(path), start.identity.lines);
  if (!span || span->steps > settings.steps) {
    start.checkpoint = read_checkpoint(path, start.identity);  // an old one, or says what differs
    return;
  }
  start.origin.parts = span->parts;
  start.checkpoint = read_checkpoint(path, identity_of(plan, robot, span->steps, start.origin));
  if (span->steps < settings.steps) {
    TrainingSettings of_part = settings;
    of_part.steps = span->steps;
    Trainer part(robots, of_part, plan.seed, stream_name(plan, robot), start.inheritance);
    restore(part, *start.checkpoint, path);
    if (!part.done())
      throw error(Failure::cannot_create,
                  "{}: belongs to a training of {} steps that has not ended; finish it first, or "
                  "remove it to start afresh",
                  path.string(), span->steps);
    start.origin.parts.push_back(span->steps);
  }
  start.identity = identity_of(plan, robot, settings.steps, start.origin);
}

// Whether the policy with this identity is of the training, but perhaps for its span.
bool is_part(const std::string& identity, const TrainingStart& start) {
  return start.checkpoint && span_of_same(identity, start.identity.lines);
}

// Throws Error(no_input) for a founder without the controller that it is to have,
// Error(cannot_create) where the checkpoint is of another training, Error(data).
// `robots` are all that get the same controller.
TrainingStart find_start(const TrainingPlan& plan, const Robot& robot,
                         const std::vector<const Arena*>& robots) {
  TrainingStart start;
  if (plan.shared) start.origin.robots = names_of_all(robots);
  if (const auto path = inherited_policy(plan, robot)) {
    const PolicyFile file = read_policy(*path);
    start.inheritance = Inheritance{file.controller, anatomy(file.robot.body, file.layout)};
    start.origin.inherited = file.settings_hash;
  }
  start.identity = identity_of(plan, robot, plan.settings(robot).steps, start.origin);
  if (const fs::path path = training_paths(plan, robot.id).checkpoint;
      plan.resume && fs::exists(path))
    go_on(plan, robot, robots, path, start);
  return start;
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
