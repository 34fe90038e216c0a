#include "cli/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "cli/terminal.h"
#include "formats/io/values.h"

namespace evo::cli {

std::string sparkline(const std::vector<double>& values, std::size_t width) {
  static constexpr std::array bars{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  if (values.empty()) return {};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double range = *high - *low;
  const std::size_t columns = std::min(width, values.size());
  std::string text;
  for (std::size_t column = 0; column < columns; ++column) {
    // The last value of the column's share, so that the newest is always seen.
    const double value = values[(column + 1) * values.size() / columns - 1];
    const double level = range > 0.0 ? (value - *low) / range : 0.0;
    text += bars[std::min(bars.size() - 1,
                          static_cast<std::size_t>(level * static_cast<double>(bars.size())))];
  }
  return text;
}

std::string training_curve(const TrainingView& view) {
  if (view.evaluations.empty()) return {};
  return fmt::format("{} {} {:.2f} (best {:.2f})", view.id.substr(0, 6),
                     sparkline(view.evaluations, 12), view.evaluations.back(), view.best);
}

std::string time_left(double share, double seconds) {
  if (!(share > 0.0)) return {};
  return duration(seconds * (1.0 - share) / share) + " left";
}

// ---- one line -------------------------------------------------------------------

bool LiveLine::due() const {
  constexpr double often = 10.0;  // s
  constexpr double rarely = 60.0;
  constexpr double drawn = 0.1;
  if (style_ == Progress::none) return false;
  const double pause = style_ == Progress::drawn   ? drawn
                       : style_ == Progress::often ? often
                                                   : rarely;
  return clock_.seconds() - last_drawn_ >= pause;
}

void LiveLine::draw(const std::string& text) {
  if (style_ == Progress::none) return;
  last_drawn_ = clock_.seconds();
  drawn_ = style_ == Progress::drawn;
  const std::string line =
      drawn_ ? "\r\x1b[K" + cut_to_width(text, terminal_columns() - 1) : text + "\n";
  std::fputs(line.c_str(), stderr);  // a terminal gone is no failure
  std::fflush(stderr);
}

void LiveLine::erase() {
  if (drawn_) std::fputs("\r\x1b[K", stderr);
  drawn_ = false;
}

// ---- trainings ------------------------------------------------------------------

void TrainingProgress::update(std::size_t index, const TrainingView& view, double steps) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(running_.begin(), running_.end(),
                                  [&](const auto& entry) { return entry.first == index; });
  steps_ += steps;
  if (found == running_.end()) {
    running_.emplace_back(index, view);
  } else {
    found->second = view;
  }
  draw();
}

void TrainingProgress::finish(std::size_t index) {
  const std::lock_guard lock(mutex_);
  std::erase_if(running_, [&](const auto& entry) { return entry.first == index; });
  ++finished_;
  draw();
}

void TrainingProgress::draw() {
  if (!line_.due()) return;
  const double seconds = line_.seconds();
  double share = static_cast<double>(finished_);
  for (const auto& [index, view] : running_) share += view.done;
  share /= static_cast<double>(std::max<std::size_t>(1, total_));
  std::string text = fmt::format("{:3.0f}%", 100.0 * share);
  if (total_ > 1) text += fmt::format("  {}/{} robots", finished_, total_);
  text += fmt::format("  {} steps/s",
                      grouped(static_cast<long long>(steps_ / std::max(seconds, 1e-9))));
  text += "  " + time_left(share, seconds);
  for (const auto& [index, view] : running_)
    if (!view.evaluations.empty()) text += "  " + training_curve(view);
  line_.draw(text);
}

}  // namespace evo::cli
