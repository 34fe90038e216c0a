#include "cli/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "cli/log.h"
#include "cli/terminal.h"
#include "formats/io/values.h"

namespace evo::cli {

namespace {

// Eighths of a line, from one to all of them.
const char* bar(std::size_t eighths) {
  static constexpr std::array blocks{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  static constexpr std::array plain{"_", ".", ":", "-", "=", "+", "*", "#"};
  return (shows_blocks() ? blocks : plain).at(std::clamp<std::size_t>(eighths, 1, 8) - 1);
}

}  // namespace

std::string sparkline(const std::vector<double>& values, std::size_t width) {
  if (values.empty()) return {};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double range = *high - *low;
  std::string text;
  const std::size_t columns = std::min(width, values.size());
  for (std::size_t column = 0; column < columns; ++column) {
    // The last value of the column's share, so that the newest is always seen.
    const double value = values[(column + 1) * values.size() / columns - 1];
    const double level = range > 0.0 ? (value - *low) / range : 0.0;
    text += bar(1 + static_cast<std::size_t>(level * 8.0));
  }
  return text;
}

std::vector<std::string> tall_curve(const std::vector<double>& values, std::size_t width,
                                    std::size_t height) {
  if (values.empty() || height == 0) return {};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const std::string top = fmt::format("{:.2f} ", *high);
  const std::string bottom = fmt::format("{:.2f} ", *low);
  const std::size_t margin = std::max(top.size(), bottom.size());
  const std::size_t room = width > margin ? width - margin : 1;
  std::vector<double> columns;  // few values are wide
  for (std::size_t column = 0; column < room; ++column)
    columns.push_back(values.size() > room ? values[(column + 1) * values.size() / room - 1]
                                           : values[column * values.size() / room]);
  std::vector<std::string> lines;
  for (std::size_t line = 0; line < height; ++line) {
    std::string text = fmt::format("{:>{}}",
                                   line == 0            ? top
                                   : line + 1 == height ? bottom
                                                        : "",
                                   margin);
    const std::size_t below = 8 * (height - 1 - line);  // eighths under this line
    for (const double value : columns) {
      const double level = *high > *low ? (value - *low) / (*high - *low) : 0.0;
      const auto eighths =
          1 + static_cast<std::size_t>(level * static_cast<double>(8 * height - 1));
      text += eighths > below ? bar(eighths - below) : " ";
    }
    text.erase(text.find_last_not_of(' ') + 1);
    lines.push_back(std::move(text));
  }
  return lines;
}

std::string training_curve(const TrainingView& view, std::size_t width) {
  if (view.evaluations.empty()) return {};
  return fmt::format("{} {} {:.2f} (best {:.2f})", view.id.substr(0, 6),
                     sparkline(view.evaluations, width), view.evaluations.back(), view.best);
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

// Erases what it drew before, and leaves the cursor where that began.
void LiveLine::draw(const std::vector<std::string>& lines) {
  if (style_ == Progress::none || lines.empty()) return;
  last_drawn_ = clock_.seconds();
  if (!drawn()) {
    for (const std::string& line : lines) log::info(line);
    return;
  }
  std::string text = home();
  for (std::size_t k = 0; k < lines.size(); ++k)
    text += fmt::format("{}{:.{}}", k == 0 ? "" : "\n", lines[k], terminal_columns() - 1);
  drawn_ = lines.size();
  if (drawn_ > 1) text += fmt::format("\x1b[{}A\r", drawn_ - 1);
  std::fputs(text.c_str(), stderr);  // a terminal gone is no failure
  std::fflush(stderr);
}

void LiveLine::erase() {
  if (drawn_ > 0) std::fputs(home(), stderr);
  drawn_ = 0;
}

// ---- trainings ------------------------------------------------------------------

void TrainingProgress::update(std::size_t index, const TrainingView& view) {
  const std::lock_guard lock(mutex_);
  TrainingView& shown = running_[index];
  steps_ += view.steps - shown.steps;
  shown = view;
  draw();
}

void TrainingProgress::finish(std::size_t index) {
  const std::lock_guard lock(mutex_);
  running_.erase(index);
  ++finished_;
  draw();
}

void TrainingProgress::draw() {
  if (!line_.due()) return;
  const double seconds = line_.seconds();
  double share = static_cast<double>(finished_);
  for (const auto& [index, view] : running_) share += view.done;
  share /= static_cast<double>(std::max<std::size_t>(1, total_));
  std::vector<std::string> parts{fmt::format("{:3.0f}%", 100.0 * share)};
  if (total_ > 1) parts.push_back(fmt::format("{}/{} robots", finished_, total_));
  parts.push_back(
      fmt::format("{} steps/s", grouped(static_cast<long long>(steps_ / std::max(seconds, 1e-9)))));
  if (share > 0.0) parts.push_back(time_left(share, seconds));
  for (const auto& [index, view] : running_)
    if (!view.evaluations.empty()) parts.push_back(training_curve(view));
  line_.draw(as_line(parts, line_.drawn() ? std::optional(terminal_columns() - 1) : std::nullopt));
}

}  // namespace evo::cli
