// Live progress of several jobs on standard error: one line that is redrawn.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace evo::cli {

class Clock {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// What a training shows of itself while it runs.
struct TrainingView {
  std::string id;
  double done = 0.0;                // share of its steps
  std::vector<double> evaluations;  // so far, drawn as a small curve
  double best = 0.0;
};

// A curve in one character a column, "▁▂▅█", scaled to its own range.
std::string sparkline(const std::vector<double>& values, std::size_t width);

// Shows `total` trainings. Thread-safe; draws at most ten times a second, and
// nothing at all when `enabled` is false.
class TrainingProgress {
 public:
  TrainingProgress(bool enabled, std::size_t total) : enabled_(enabled), total_(total) {}
  ~TrainingProgress();
  TrainingProgress(const TrainingProgress&) = delete;
  TrainingProgress& operator=(const TrainingProgress&) = delete;

  // The training with this number stands so; `steps` more were taken.
  void update(std::size_t index, const TrainingView& view, double steps);
  void finish(std::size_t index);

 private:
  void draw();
  void erase();

  bool enabled_;
  std::size_t total_;
  std::mutex mutex_;
  Clock clock_;
  double last_drawn_ = -1.0;
  std::size_t finished_ = 0;
  double steps_ = 0.0;
  std::vector<std::pair<std::size_t, TrainingView>> running_;
  bool drawn_ = false;
};

}  // namespace evo::cli
