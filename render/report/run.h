// A run folder (docs/run-folder.md) as far as it has come, in memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "formats/io/json.h"
#include "formats/robot/robot.h"
#include "formats/run/run.h"
#include "formats/training/policy.h"

namespace evo::report {

// A number the trainer logged, against environment steps.
struct LogSeries {
  std::string name;  // "entropy"
  std::vector<std::pair<double, double>> points;
};

// What is known of how one robot was trained: by its policy file and its log.
struct Training {
  std::vector<CurvePoint> curve;
  std::optional<FinalScore> final_score;
  std::int64_t best_step = 0;
  std::int64_t steps = 0;
  std::string created_by;  // tool, version, commit
  std::vector<LogSeries> log;
};

// A trained robot, where it was scored first.
struct Entry {
  Robot robot;
  int generation = 0;
  std::optional<double> fitness;  // nothing: its training failed
  std::string failure;            // why, if it did
  Training training;              // empty without a policy file
  std::string policy = {};        // that file, within the run's folder; empty: there is none
  // The generation whose robots all have this policy, so that `training` is not the robot's.
  std::optional<int> sharing = {};
};

// The training of one controller on all robots of a generation.
struct SharedTraining {
  int generation = 0;
  Training training;
};

struct Generation {
  int number = 0;
  std::vector<std::size_t> members;           // in Run::robots, by slot; survivors are there again
  std::vector<std::optional<double>> scores;  // of each member, then; nothing: it failed
  std::size_t planned = 0;                    // robots of the population, trained or not

  std::optional<double> best() const;  // of its scores
};

// The way of a robot in one picture, for paper, and where there is no JavaScript: SVG documents.
struct Film {
  std::string light;
  std::string dark;
};

struct Run {
  std::string label;  // the folder's name
  // As commands name it: as it was given, from the folder in which the page was made; by its
  // name alone where that would say something about the machine ("/home/..", "..").
  std::string folder;
  // What the task is for, "Walk to the right over flat ground."; empty where no policy says it.
  std::string purpose;
  // The lines of run.yaml. Folders are cut off values that are paths, so that a page says
  // nothing about the machine it was made on.
  std::vector<RunSetting> settings;
  std::vector<Entry> robots;  // in the order they were trained
  std::map<std::string, std::size_t> by_id;
  std::vector<Generation> generations;
  std::vector<SharedTraining> shared;  // by generations, of runs that have such
  // In `robots`, those that the page shows one by one (choice.h), in order; the others
  // have a part in curves and figures alone, and `training` is empty.
  std::vector<std::size_t> shown;

  // The fittest robot, the first of equals, and its way.
  std::optional<std::size_t> champion;
  std::optional<Film> film;
  // Episodes (replay.h) of robots whose policies are there, and what stands still around
  // them. An episode takes a tenth of the policy it came from, so that all of them fit a page.
  std::map<std::size_t, Json> replays;
  Json world;

  double seconds = 0.0;  // of all trainings, one core each; 0: not recorded
  // When the first began and the last ended, seconds since 1970; 0: not recorded.
  std::int64_t began = 0;
  std::int64_t ended = 0;
  std::vector<std::string> machines;

  // A setting's value; empty where run.yaml has none.
  std::string setting(const std::string& name) const;
  // The method, by the name that the run gives it.
  std::string method() const;
  // What robots are scored by: the task, or "own fitness: ./score" where --evaluate named a
  // program.
  std::string subject() const;
  bool is_evaluated() const { return !setting("evaluate").empty(); }
  const char* done() const { return is_evaluated() ? "scored" : "trained"; }  // with its robots
  // The number of robots this run is to train, if run.yaml says so.
  std::optional<std::size_t> evaluations() const;
  // Robots whose training failed.
  std::size_t failures() const;
  bool shows(std::size_t robot) const;
  // Decimals of every fitness of the run, so that columns line up: two of 3.42, three of 0.342.
  int decimals() const;
  std::string text(const std::optional<double>& fitness) const;  // "failed" for nothing
};
// The same of several runs, and of a number, with a true minus.
int decimals_of(double largest);
std::string number(double value, int decimals);

// How much of a run is shown.
struct Extent {
  std::size_t robots = 1500;  // one by one; of more a choice. 0: their scores alone
  // Episodes: of the fittest of those robots, beside the champion and its ancestors.
  std::size_t replays = std::numeric_limits<std::size_t>::max();
};

// Finished or not; episodes are run again on `threads` threads. Throws
// Error(no_input) for a folder that is not there, Error(data) for one that is no run
// or has a damaged file.
Run read_run(const std::filesystem::path& folder, const Extent& extent, int threads);

// Gives runs whose folders have the same name that of the folder above, too, and
// numbers where that is not enough.
void tell_apart(std::vector<Run>& runs, const std::vector<std::filesystem::path>& folders);

}  // namespace evo::report
