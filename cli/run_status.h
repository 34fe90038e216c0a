// How far a run folder has come, for those who wait for it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/progress.h"
#include "formats/run/run.h"

namespace evo::cli {

// A text and how often it comes.
struct Count {
  std::string text;
  std::size_t times = 0;
};

// What continues in a run.
struct RunWork {
  std::vector<Count> launches;  // processes that train, by machine
  std::size_t waiting = 0;      // robots proposed and not begun
  std::vector<Count> failures;  // robots by why their training failed
};

class RunStatus {
 public:
  // Throws Error(data) for a folder that is no run or has damaged settings.
  explicit RunStatus(const std::filesystem::path& folder);

  // Reads what is new.
  void update() { history_.update(); }

  const RunHistory& history() const { return history_; }
  const RunFolder& folder() const { return history_.folder(); }
  int evaluations() const { return evaluations_; }  // robots to train in all
  int trained() const { return static_cast<int>(history_.robots().size()); }
  int left() const { return trained() < evaluations_ ? evaluations_ - trained() : 0; }
  std::vector<double> best_so_far() const;  // robot by robot, from the first with a fitness
  bool over() const;
  RunWork work() const;  // by frequency, the most frequent first

  // Slots whose training said something since this object was made.
  std::vector<SlotStatus> running() const;
  TrainingView view(const SlotStatus& slot) const;

 private:
  RunHistory history_;
  std::filesystem::file_time_type made_;
  int evaluations_ = 0;
};

// "7 on n1, 5 on n2"; of more than eight texts the most frequent, and how many more.
std::string tally(const std::vector<Count>& counts, const char* join);

// Follows a run: a line on standard output for every generation that ends, and on a
// terminal the body of a new champion and, drawn anew below, how the run stands, the best so
// far and the curves of what is being trained. Waits for a run to begin in a folder that is empty
// or not there. Runs side by side (evo evolve compare) have one line for all. Returns when the run
// is over, on SIGINT or SIGTERM, or when the calling process has gone.
void watch_run(const std::filesystem::path& folder, Progress style);

}  // namespace evo::cli
