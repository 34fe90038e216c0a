// How far a run folder has come (spec: formats, "Run folder"), for those who wait
// for it. Reads each file once, so that it can be asked again and again.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cli/progress.h"
#include "formats/robot.h"

namespace evo::cli {

class RunStatus {
 public:
  struct Generation {
    std::string name;  // "gen-003"
    bool finished = false;
    std::vector<double> scores;  // of the robots that have one
  };

  // Throws Error(data) for a folder that is no run or has damaged settings.
  explicit RunStatus(std::filesystem::path folder);

  // Reads what is new.
  void update();

  // A setting of run.yaml, which must be there.
  std::string setting(const std::string& name) const;
  int evaluations() const { return evaluations_; }  // robots to train in all
  int trained() const { return static_cast<int>(known_.size()); }
  int left() const { return trained() < evaluations_ ? evaluations_ - trained() : 0; }
  const std::vector<Generation>& generations() const { return generations_; }
  const std::optional<Robot>& best() const { return best_; }
  const std::vector<double>& best_so_far() const { return best_so_far_; }  // robot by robot
  bool over() const;

  // Seconds a training took on average, one core; nothing before the first has ended.
  std::optional<double> seconds_each() const;
  double seconds() const { return seconds_; }  // of all trainings

  // Trainings that said something since this object was made, of the generation
  // under way.
  std::vector<TrainingView> running() const;

 private:
  void read_generation(Generation& generation);
  void add(Robot robot);

  std::filesystem::path folder_;
  std::filesystem::file_time_type made_;
  std::map<std::string, std::string> settings_;
  int evaluations_ = 0;
  double steps_ = 0.0;
  std::vector<Generation> generations_;
  std::set<std::string> files_;  // read
  std::set<std::string> known_;  // robots
  std::optional<Robot> best_;
  std::vector<double> best_so_far_;
  double seconds_ = 0.0;
  int timed_ = 0;
};

// Follows a run: a line on standard output for every generation that ends, and on
// a terminal a live one with the curves of what is being trained. Returns when the
// run is over, on SIGINT or SIGTERM, or when the calling process has gone.
void watch_run(const std::filesystem::path& folder, bool live);

}  // namespace evo::cli
