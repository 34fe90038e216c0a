// A run folder: an evolution as files, so that it can be killed, continued,
// inspected with everyday tools and worked on by many machines. docs/run-folder.md lists them.
//
// Every file but those of the journal, to which lines are appended, appears whole under its name,
// and what exists is done. No result depends on a time of day or a machine: those are in logs and
// the journal alone.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/robot/robot.h"

namespace evo {

// ---- settings -------------------------------------------------------------------

struct RunSetting {
  std::string name;
  std::string value;  // as text; may be empty
  bool operator==(const RunSetting&) const = default;
};

// The method and the settings of a run in the order of its file.
class RunSettings {
 public:
  RunSettings() = default;
  // Throws Error(usage) for a setting that there is none of, that the method does not have,
  // or whose value is none of it (formats/run/settings.h).
  RunSettings(std::string method, std::vector<RunSetting> list);
  // Throws Error(no_input, data); a newer version is refused by name.
  static RunSettings read(const std::filesystem::path& file);
  static RunSettings parse(std::string_view text, const std::string& where);

  const std::vector<RunSetting>& list() const { return list_; }
  const std::string* find(const std::string& name) const;
  std::string value(const std::string& name) const;  // empty where there is none
  // Throws Error(data) for a setting that is missing, or is not a number from 0.
  const std::string& text(const std::string& name) const;
  int number(const std::string& name) const;
  // Those of each training in a generation, from its beginning: founders, in the first, may be
  // given more; in a race those of each rung have half of the next one's.
  int steps(int generation) const;
  // Whether one controller learns on all robots of a generation together (method modular):
  // in all generations but the last, in which the best robots train alone.
  bool shares(int generation) const;
  // What robots are scored by: the task, or the program of --evaluate.
  const std::string& scored_by() const;
  bool is_evaluated() const { return find("evaluate") != nullptr; }
  // What decided their fitness when the run began: a task by name or file, FILE.py, or the
  // file that a program is; and its digest. Empty where no file is named.
  const std::string& source() const { return source_; }
  const std::string& source_hash() const { return source_hash_; }
  void set_source(std::string source, std::string digest) {
    source_ = std::move(source);
    source_hash_ = std::move(digest);
  }
  // The digest of the Makefile as it was written, "" where none is told.
  const std::string& makefile() const { return makefile_; }
  void set_makefile(std::string digest) { makefile_ = std::move(digest); }

  std::string to_yaml() const;

 private:
  int rungs_left(int generation) const;  // of its race, after this one; 0 without races

  std::vector<RunSetting> list_;  // the method first
  std::string source_;
  std::string source_hash_;
  std::string makefile_;
  std::string file_ = "run.yaml";  // for messages
};

// What a run on this task is called after: a name, the stem of a file, CLASS of FILE.py:CLASS.
std::string task_label(const std::string& task);

// ---- machines ---------------------------------------------------------------------

// What this machine is called: by Slurm, where it runs us, else by itself.
std::string this_machine();
// The machine that a mark in the journal names, "?" where it names none.
std::string marked_machine(const std::filesystem::path& mark);

// ---- the folder -------------------------------------------------------------------

class RunFolder {
 public:
  // Throws Error(no_input) where nothing is, Error(data) where that is not a run.
  explicit RunFolder(std::filesystem::path path);
  const std::filesystem::path& path() const { return path_; }
  const RunSettings& settings() const { return settings_; }

  std::filesystem::path generation(int number) const;
  std::filesystem::path population(int number) const {
    return generation(number) / "population.jsonl";
  }
  std::filesystem::path scores(int number) const { return generation(number) / "scores.jsonl"; }
  std::filesystem::path policies() const { return path_ / "policies"; }
  std::filesystem::path policy(const std::string& id) const {
    return policies() / (id + ".policy.h5");
  }
  std::filesystem::path log(const std::string& id) const { return policies() / (id + ".log"); }
  // The one controller of all robots in a generation.
  std::filesystem::path shared_policy(int number) const {
    return policies() / (generation(number).filename().string() + ".policy.h5");
  }
  // The log of a robot's training in a generation: its own, or that of all.
  std::filesystem::path log(int number, const std::string& id) const {
    return settings_.shares(number) ? policies() / (generation(number).filename().string() + ".log")
                                    : log(id);
  }
  std::filesystem::path journal() const { return path_ / "journal"; }
  std::filesystem::path history() const { return path_ / "history.jsonl"; }
  std::filesystem::path best() const { return path_ / "best.json"; }

  // Whether its Makefile differs from the one that was written with run.yaml.
  bool is_edited() const;
  // Generations begun, in order.
  std::vector<int> generations() const;
  // Robots (or generations with one controller) in training, and on which machines; of a
  // process that was killed they stay.
  std::map<std::string, std::string> running() const;
  // Files of slots trained of a generation, by the first slot in each.
  std::map<int, std::filesystem::path> trained_slots(int generation) const;

 private:
  std::filesystem::path path_;
  RunSettings settings_;
};

// ---- what has been done -------------------------------------------------------------

struct TrainedRobot {
  Robot robot;                    // scored last, if its training continued
  int generation = 0;             // where it was scored first
  std::optional<double> fitness;  // nothing: its training failed
  std::string failure;            // why, if it did
};

enum class SlotState { waiting, training, done, failed };

struct SlotStatus {
  int generation = 0;
  int slot = 0;       // from 0
  std::string robot;  // id
  SlotState state = SlotState::waiting;
  std::string why;  // failed
};

// The cores of a run: the most trainings side by side, and the share of their time in
// which they did not train, while any did. A run that was stopped for a night was not
// idle.
struct Utilisation {
  std::size_t cores = 0;
  double idle = 0.0;
};

// A run as far as it has come. update() reads only what is new, so that it can
// be called again and again while others work on the run.
class RunHistory {
 public:
  struct Generation {
    int number = 0;
    bool finished = false;
    std::vector<std::string> population;            // ids by slot, while slots are left
    std::vector<std::optional<std::size_t>> slots;  // in robots(); nothing: not trained yet
    // By slot, what the robot was scored with then; nothing: not yet, or it failed.
    std::vector<std::optional<double>> scores;
  };

  // Throws what a damaged file throws.
  explicit RunHistory(RunFolder folder);
  void update();

  const RunFolder& folder() const { return folder_; }
  const std::vector<Generation>& generations() const { return generations_; }
  // In the order of generations and slots as far as all were there when read.
  const std::vector<TrainedRobot>& robots() const { return robots_; }
  const std::map<std::string, std::size_t>& by_id() const { return by_id_; }  // in robots()
  // The fittest robot, the first of equals.
  const TrainedRobot* champion() const { return champion_ ? &robots_[*champion_] : nullptr; }
  std::optional<std::size_t> champion_index() const { return champion_; }
  // Every slot of a generation's population. `training`: as the journal says; of a process
  // that was killed it says so still.
  std::vector<SlotStatus> slots(const Generation& generation) const;

  // The sum over all trainings recorded, one core each.
  double seconds() const { return seconds_; }
  // When the first of them began and the last ended, seconds since 1970; 0 without any.
  double began() const;
  double ended() const;
  // That trained, by name.
  const std::set<std::string>& machines() const { return machines_; }
  // How busy the cores were that trained.
  Utilisation utilisation() const;
  // Per robot that was trained to the end; nothing before the first.
  std::optional<double> seconds_each() const;

 private:
  void read_generation(Generation& generation);
  void read_timings();
  void add(Generation& generation, std::size_t slot, Robot robot);

  RunFolder folder_;
  std::vector<Generation> generations_;
  std::vector<TrainedRobot> robots_;
  std::map<std::string, std::size_t> by_id_;
  std::optional<std::size_t> champion_;
  std::map<std::string, std::uintmax_t> timings_read_;  // bytes by file
  double seconds_ = 0.0;
  std::set<std::string> machines_;
  std::size_t timed_ = 0;  // trainings finished
  // When each training recorded began and ended, seconds since 1970.
  std::vector<std::pair<double, double>> worked_;
};

// ---- curves and lines of descent -------------------------------------------------------

// The best fitness after each of `robots` (each with its `fitness`, or nothing: it failed); NaN
// while all have failed.
template <typename Robots>
std::vector<double> best_so_far(const Robots& robots) {
  std::vector<double> curve;
  double best = std::numeric_limits<double>::quiet_NaN();
  for (const auto& robot : robots) {
    if (robot.fitness && !(*robot.fitness <= best)) best = *robot.fitness;
    curve.push_back(best);
  }
  return curve;
}

// From the first ancestor to the robot itself, each by the first parent it names that is
// among `robots` (each with its document as `robot`), whose places `by_id` tells. Files
// edited by hand may make a robot its own ancestor: the line ends there.
template <typename Robots>
std::vector<std::size_t> lineage(const Robots& robots,
                                 const std::map<std::string, std::size_t>& by_id,
                                 std::size_t robot) {
  std::vector<std::size_t> line;
  for (bool more = true; more;) {
    line.push_back(robot);
    more = false;
    for (const std::string& id : robots[robot].robot.parents())
      if (const auto known = by_id.find(id); known != by_id.end()) {
        robot = known->second;
        more = std::find(line.begin(), line.end(), robot) == line.end();
        break;
      }
  }
  std::reverse(line.begin(), line.end());
  return line;
}

}  // namespace evo
