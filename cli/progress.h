// Live progress on standard error: one line that is redrawn.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
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

// How a long work shows that it continues: as a line that is redrawn, or as lines, one
// every ten seconds or every minute.
enum class Progress { none, drawn, often, rarely };

// The last lines of the terminal while this lives, one or several; cut to its width, and gone
// at the end. Or lines that stay.
class LiveLine {
 public:
  explicit LiveLine(Progress style) : style_(style) {}
  ~LiveLine() { erase(); }
  LiveLine(const LiveLine&) = delete;
  LiveLine& operator=(const LiveLine&) = delete;

  // Whether it is time to draw again, at most ten times per second, or to write.
  bool due() const;
  void draw(const std::string& text) { draw(std::vector{text}); }
  void draw(const std::vector<std::string>& lines);
  void erase();
  bool drawn() const { return style_ == Progress::drawn; }
  double seconds() const { return clock_.seconds(); }  // since it began

 private:
  Progress style_;
  std::size_t drawn_ = 0;  // lines on the terminal
  Clock clock_;
  double last_drawn_ = -1.0;

  // To where it began, with nothing after it.
  const char* home() const { return drawn_ > 1 ? "\r\x1b[J" : "\r\x1b[K"; }
};

// What a training shows of itself while it runs.
struct TrainingView {
  std::string id;
  double done = 0.0;                // share of its steps
  std::vector<double> evaluations;  // so far, drawn as a small curve
  double best = 0.0;
  double steps = 0.0;  // taken
};

// A curve in one character per column, "▁▂▅█", scaled to its own range; "_.=#" where a
// terminal has no such characters.
std::string sparkline(const std::vector<double>& values, std::size_t width);

// The same, so many lines tall, the top one first, with its ends beside it.
std::vector<std::string> tall_curve(const std::vector<double>& values, std::size_t width,
                                    std::size_t height);

// "0a3bb6 ▁▃▅█ 4.21 (best 5.02)"; nothing before the first evaluation.
std::string training_curve(const TrainingView& view, std::size_t width = 12);

// "12 min 05 s left" of a work when this share of it took so long; nothing at the
// beginning.
std::string time_left(double share, double seconds);

// Shows `total` trainings or evaluations of one process. Thread-safe.
class TrainingProgress {
 public:
  TrainingProgress(Progress style, std::size_t total) : line_(style), total_(total) {}

  // The training with this number stands so.
  void update(std::size_t index, const TrainingView& view);
  void finish(std::size_t index);

 private:
  void draw();

  LiveLine line_;
  std::size_t total_;
  std::mutex mutex_;
  std::size_t finished_ = 0;
  double steps_ = 0.0;
  std::map<std::size_t, TrainingView> running_;
};

}  // namespace evo::cli
