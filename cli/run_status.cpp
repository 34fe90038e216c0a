#include "cli/run_status.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>

#include "cli/command.h"
#include "cli/terminal.h"
#include "formats/io/text.h"
#include "formats/training/training_log.h"

namespace evo::cli {

namespace fs = std::filesystem;

RunStatus::RunStatus(const fs::path& folder)
    : history_(RunFolder(folder)), made_(fs::file_time_type::clock::now()) {
  const RunSettings& settings = history_.folder().settings();
  evaluations_ = settings.number("evals");
}

std::vector<double> RunStatus::best_so_far() const {
  std::vector<double> curve = evo::best_so_far(history_.robots());
  std::erase_if(curve, [](double best) { return std::isnan(best); });
  return curve;
}

bool RunStatus::over() const { return fs::exists(folder().best()); }

namespace {

std::vector<Count> counted(const std::vector<std::string>& texts) {
  std::map<std::string, std::size_t> times;
  for (const std::string& text : texts) ++times[text];
  std::vector<Count> counts;
  for (const auto& [text, count] : times) counts.push_back({text, count});
  std::stable_sort(counts.begin(), counts.end(),
                   [](const Count& a, const Count& b) { return a.times > b.times; });
  return counts;
}

}  // namespace

std::string tally(const std::vector<Count>& counts, const char* join) {
  constexpr std::size_t most = 8;
  std::string list;
  std::size_t more = 0;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (k < most)
      list += fmt::format("{}{}{}{}", k == 0 ? "" : ", ", counts[k].times, join,
                          printable(counts[k].text));
    else
      more += counts[k].times;
  }
  return more == 0 ? list
                   : fmt::format("{}, {}{}{} others", list, more, join, counts.size() - most);
}

RunWork RunStatus::work() const {
  RunWork work;
  std::vector<std::string> hosts;
  for (const auto& [robot, host] : folder().running()) hosts.push_back(host);
  for (const RunHistory::Generation& generation : history_.generations()) {
    if (generation.finished) continue;
    for (const SlotStatus& slot : history_.slots(generation))
      work.waiting += slot.state == SlotState::waiting;
  }
  std::vector<std::string> failures;
  for (const TrainedRobot& trained : history_.robots())
    if (!trained.fitness) failures.push_back(trained.failure);
  work.launches = counted(hosts);
  work.failures = counted(failures);
  return work;
}

std::vector<SlotStatus> RunStatus::running() const {
  std::vector<SlotStatus> found;
  for (const RunHistory::Generation& generation : history_.generations()) {
    if (generation.finished) continue;
    for (SlotStatus& slot : history_.slots(generation)) {
      if (slot.state != SlotState::training) continue;
      std::error_code gone;
      if (fs::last_write_time(folder().log(generation.number, slot.robot), gone) < made_) continue;
      found.push_back(std::move(slot));
      if (folder().settings().shares(generation.number)) break;  // one training of all
    }
  }
  return found;
}

TrainingView RunStatus::view(const SlotStatus& slot) const {
  const int generation = slot.generation;
  LoggedTraining log = read_training_log(folder().log(generation, slot.robot));
  const double steps = folder().settings().steps(generation);
  return {folder().settings().shares(generation) ? "all robots" : slot.robot,
          log.step / std::max(1.0, steps), std::move(log.evaluations), log.best};
}

// ---- watching -------------------------------------------------------------------

namespace {

// "   87/250 robots  best 5.67 ▁▂▅█  2 failed  1.31 core hours, 3 % idle  12 min 05 s left",
// in parts.
std::vector<std::string> standing(const RunStatus& run, std::size_t at_once) {
  constexpr std::size_t curve_columns = 16;
  const RunHistory& history = run.history();
  std::vector<std::string> parts{fmt::format("{:>{}}/{} robots", run.trained(),
                                             std::to_string(run.evaluations()).size(),
                                             run.evaluations())};
  if (const TrainedRobot* best = history.champion())
    parts.push_back(
        fmt::format("best {:.3f} {}", *best->fitness, sparkline(run.best_so_far(), curve_columns)));
  const auto failed = std::count_if(history.robots().begin(), history.robots().end(),
                                    [](const TrainedRobot& robot) { return !robot.fitness; });
  if (failed > 0) parts.push_back(fmt::format("{} failed", failed));
  const auto each = history.seconds_each();
  if (each)
    parts.push_back(fmt::format("{:.2f} core hours, {:.0f} % idle", history.seconds() / 3600.0,
                                100.0 * history.utilisation().idle));
  if (each && run.left() > 0)
    parts.push_back(
        fmt::format("{} left", duration(*each * run.left() / static_cast<double>(at_once))));
  return parts;
}

// "24 launches on 3 machines, 17 waiting"
std::string at_work(const RunWork& work) {
  std::size_t launches = 0;
  for (const Count& machine : work.launches) launches += machine.times;
  std::string text = fmt::format("{} launch{}", launches, launches == 1 ? "" : "es");
  if (work.launches.size() > 1) text += fmt::format(" on {} machines", work.launches.size());
  if (work.waiting > 0) text += fmt::format(", {} waiting", work.waiting);
  return text;
}

// In a line of a log.
std::vector<std::string> all_parts(const RunStatus& run, const std::vector<SlotStatus>& running,
                                   std::size_t at_once) {
  constexpr std::size_t most = 8;  // curves
  std::vector<std::string> parts = standing(run, at_once);
  parts.push_back(at_work(run.work()));
  for (std::size_t k = 0; k < std::min(running.size(), most); ++k)
    if (const TrainingView view = run.view(running[k]); !view.evaluations.empty())
      parts.push_back(training_curve(view));
  return parts;
}

// On a terminal: how the run stands, the best so far as a curve, and a line for each training
// under way, as many as there is room for.
std::vector<std::string> screen(const RunStatus& run, const std::vector<SlotStatus>& running,
                                std::size_t at_once) {
  const std::size_t columns = terminal_columns() - 1;
  const std::size_t room = std::max<std::size_t>(terminal_rows(), 3) - 2;
  std::vector<std::string> parts = standing(run, at_once);
  parts.push_back(at_work(run.work()));
  std::vector<std::string> lines{as_line(parts, columns)};
  constexpr std::size_t tallest = 16;
  const std::size_t tall = std::min(room / 3, tallest);
  if (const std::vector<double> best = run.best_so_far(); best.size() > 1 && tall > 2)
    for (std::string& row : tall_curve(best, columns, tall)) lines.push_back(std::move(row));
  for (const SlotStatus& slot : running) {
    if (lines.size() >= room) break;
    const TrainingView view = run.view(slot);
    if (view.evaluations.empty()) continue;
    constexpr std::size_t words = 40;  // columns of what stands beside the curve
    const std::size_t width = std::clamp<std::size_t>(columns, words + 12, words + 40) - words;
    lines.push_back(as_line(
        {training_curve(view, width), fmt::format("{:.0f} %", 100.0 * view.done)}, columns));
  }
  return lines;
}

// "gen-003  5.102 (median 3.310)"
std::string generation_result(const RunStatus& run, const RunHistory::Generation& generation) {
  const std::string name = run.folder().generation(generation.number).filename().string();
  std::vector<double> scores;
  for (const auto& robot : generation.slots)
    if (robot && run.history().robots()[*robot].fitness)
      scores.push_back(*run.history().robots()[*robot].fitness);
  if (scores.empty()) return name + "  every training failed";
  std::sort(scores.begin(), scores.end());
  return fmt::format("{}  {:.3f} (median {:.3f})", name, scores.back(), scores[scores.size() / 2]);
}

// A folder that a run may begin in.
bool not_begun(const fs::path& folder) {
  std::error_code unknown;
  return !fs::exists(folder, unknown) ||
         (fs::is_directory(folder, unknown) && fs::is_empty(folder, unknown));
}

// False if the wait was ended from outside.
bool wait_for_begin(const fs::path& folder, pid_t caller, Progress style) {
  if (!not_begun(folder)) return true;
  const std::string text = fmt::format("waiting for {} to begin", folder.string());
  LiveLine line(style == Progress::drawn ? style : Progress::none);
  if (style == Progress::drawn)
    line.draw(text);
  else if (style != Progress::none)
    log::info(text);
  while (not_begun(folder)) {
    ::poll(nullptr, 0, 200);
    if (interrupted() != 0 || ::getppid() != caller) return false;
  }
  // The settings are the first thing there; a moment later at most.
  for (int k = 0; k < 50 && !fs::exists(folder / "run.yaml"); ++k) ::poll(nullptr, 0, 100);
  return true;
}

// On a terminal, the body of the best robot whenever it is another one.
class ChampionShown {
 public:
  void show(const RunStatus& run) {
    const TrainedRobot* best = run.history().champion();
    if (!output_columns() || best == nullptr || best->robot.id == shown_) return;
    shown_ = best->robot.id;
    fmt::print("\n{}{}  {:.3f}\n\n", draw_body(best->robot.body), shown_, *best->fitness);
  }

 private:
  std::string shown_;
};

// Seconds, ended early by a signal: long enough that looking costs little.
void pause_after(const Clock& look) {
  constexpr double shortest = 0.25;
  constexpr double longest = 10.0;
  constexpr double per_look = 10.0;
  ::poll(nullptr, 0,
         static_cast<int>(1000.0 * std::clamp(per_look * look.seconds(), shortest, longest)));
}

// Runs side by side, TASK/METHOD-SEED.
std::vector<fs::path> compared_runs(const fs::path& folder) {
  std::vector<fs::path> runs;
  std::error_code unknown;
  if (fs::exists(folder / "run.yaml", unknown)) return runs;
  for (const auto& task : fs::directory_iterator(folder, unknown))
    for (const auto& run : fs::directory_iterator(task.path(), unknown))
      if (fs::exists(run.path() / "run.yaml", unknown)) runs.push_back(run.path());
  return runs;
}

// One line: "4 of 9 runs over  51/225 robots  12 min 05 s left".
void watch_comparison(const std::vector<fs::path>& folders, Progress style, pid_t caller) {
  std::vector<RunStatus> runs(folders.begin(), folders.end());
  const Clock begun;
  std::optional<int> done_before;
  LiveLine line(style);
  for (bool last = false; !last;) {
    const Clock look;
    last = interrupted() != 0 || ::getppid() != caller;
    int over = 0;
    int done = 0;
    int left = 0;
    for (RunStatus& run : runs) {
      run.update();
      over += static_cast<int>(run.over());
      done += run.trained();
      left += run.over() ? 0 : run.left();
    }
    if (!done_before) done_before = done;
    std::vector<std::string> parts{fmt::format("{} of {} runs over", over, runs.size()),
                                   fmt::format("{}/{} robots", done, done + left)};
    if (done > *done_before && left > 0)
      parts.push_back(
          fmt::format("{} left", duration(begun.seconds() * left / (done - *done_before))));
    if (line.due())
      line.draw(as_line(parts, style == Progress::drawn ? output_columns() : std::nullopt));
    last = last || over == std::ssize(runs);
    if (!last) pause_after(look);
  }
}

}  // namespace

void watch_run(const fs::path& folder, Progress style) {
  catch_interrupts();
  const pid_t caller = ::getppid();
  if (const std::vector<fs::path> runs = compared_runs(folder); !runs.empty())
    return watch_comparison(runs, style, caller);
  if (!wait_for_begin(folder, caller, style)) return;
  RunStatus run(folder);
  ChampionShown champion;
  // Its results are lines already.
  LiveLine line(style == Progress::drawn ? style : Progress::none);
  // Where a run stands that is there: its last generation that has ended.
  std::set<int> told;
  for (const RunHistory::Generation& generation : run.history().generations())
    if (generation.finished) told.insert(generation.number);
  if (!told.empty()) told.erase(std::prev(told.end()));
  std::size_t at_once = 1;  // most trainings seen side by side
  for (bool last = false; !last;) {
    const Clock look;
    last = run.over() || interrupted() != 0 || ::getppid() != caller;
    run.update();
    const std::vector<SlotStatus> running = run.running();
    at_once = std::max(at_once, running.size());
    for (const RunHistory::Generation& generation : run.history().generations()) {
      if (!generation.finished || !told.insert(generation.number).second) continue;
      line.erase();
      std::vector<std::string> parts = standing(run, at_once);
      parts.insert(parts.begin(), generation_result(run, generation));
      fmt::print("{}\n", as_line(parts, output_columns()));
      champion.show(run);
      std::fflush(stdout);
    }
    if (last) return;
    if (line.due()) {
      line.draw(style == Progress::drawn
                    ? screen(run, running, at_once)
                    : std::vector{as_line(all_parts(run, running, at_once), std::nullopt)});
    }
    pause_after(look);
  }
}

}  // namespace evo::cli
