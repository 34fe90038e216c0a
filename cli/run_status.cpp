#include "cli/run_status.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "cli/command.h"
#include "cli/terminal.h"
#include "formats/training_log.h"

namespace evo::cli {

namespace fs = std::filesystem;

RunStatus::RunStatus(const fs::path& folder)
    : history_(RunFolder(folder)), made_(fs::file_time_type::clock::now()) {
  const RunSettings& settings = history_.folder().settings();
  evaluations_ = settings.number("evaluations");
  steps_ = settings.number("steps");
}

std::vector<double> RunStatus::best_so_far() const {
  std::vector<double> curve;
  for (const TrainedRobot& trained : history_.robots()) {
    const bool better = trained.fitness && (curve.empty() || *trained.fitness > curve.back());
    if (better)
      curve.push_back(*trained.fitness);
    else if (!curve.empty())
      curve.push_back(curve.back());
  }
  return curve;
}

bool RunStatus::over() const { return fs::exists(folder().best()); }

std::vector<TrainingView> RunStatus::running() const {
  std::vector<TrainingView> views;
  for (const RunHistory::Generation& generation : history_.generations()) {
    if (generation.finished) continue;
    for (const SlotStatus& slot : history_.slots(generation)) {
      if (slot.state != SlotState::training) continue;
      const fs::path file = folder().log(slot.robot);
      std::error_code gone;
      if (fs::last_write_time(file, gone) < made_) continue;
      LoggedTraining log = read_training_log(file);
      views.push_back(
          {slot.robot, log.step / std::max(1.0, steps_), std::move(log.evaluations), log.best});
    }
  }
  return views;
}

// ---- watching -------------------------------------------------------------------

namespace {

// "   87/250 robots   best 5.67 ▁▂▅█   12 min 05 s left"
std::string standing(const RunStatus& run, std::size_t at_once) {
  constexpr std::size_t curve_columns = 16;
  std::string text = fmt::format("{:>{}}/{} robots", run.trained(),
                                 std::to_string(run.evaluations()).size(), run.evaluations());
  if (const TrainedRobot* best = run.history().champion())
    text += fmt::format("  best {:.3f} {}", *best->fitness,
                        sparkline(run.best_so_far(), curve_columns));
  if (const auto each = run.history().seconds_each(); each && run.left() > 0)
    text += fmt::format("  {} left", duration(*each * run.left() / static_cast<double>(at_once)));
  return text;
}

// "gen-003  5.102 (median 3.310)  "
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

}  // namespace

void watch_run(const fs::path& folder, Progress style) {
  constexpr int pause_milliseconds = 250;
  catch_interrupts();
  const pid_t caller = ::getppid();
  RunStatus run(folder);
  // Its results are lines already.
  LiveLine line(style == Progress::drawn ? style : Progress::none);
  std::set<int> told;
  for (const RunHistory::Generation& generation : run.history().generations())
    if (generation.finished) told.insert(generation.number);
  std::size_t at_once = 1;  // most trainings seen side by side
  for (bool last = false; !last;) {
    last = run.over() || interrupted() != 0 || ::getppid() != caller;
    run.update();
    const std::vector<TrainingView> running = run.running();
    at_once = std::max(at_once, running.size());
    for (const RunHistory::Generation& generation : run.history().generations()) {
      if (!generation.finished || !told.insert(generation.number).second) continue;
      line.erase();
      fmt::print("{}  {}\n", generation_result(run, generation), standing(run, at_once));
      std::fflush(stdout);
    }
    if (last) return;
    if (line.due()) {
      std::string text = standing(run, at_once);
      for (const TrainingView& view : running)
        if (!view.evaluations.empty()) text += "  " + training_curve(view);
      line.draw(text);
    }
    ::poll(nullptr, 0, pause_milliseconds);  // ends early on a signal
  }
}

}  // namespace evo::cli
