#include "cli/run_status.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>

#include "cli/command.h"
#include "cli/robots.h"
#include "cli/terminal.h"
#include "formats/files.h"
#include "formats/yaml.h"

namespace evo::cli {
namespace {

namespace fs = std::filesystem;

std::map<std::string, std::string> read_settings(const fs::path& folder) {
  const fs::path file = folder / "run.yaml";
  if (!fs::exists(file))
    throw error(Failure::data, "{}: a folder without run.yaml is not a run", folder.string());
  const YamlNode document = YamlNode::parse(read_file(file), file.string());
  if (!document.is_mapping()) throw document.error("a run's settings are a mapping");
  std::map<std::string, std::string> settings;
  for (const auto& [key, value] : document.entries()) {
    const bool has_text = value.is_scalar() && !value.is_null() && value.found() != "''";
    settings[key.string()] = has_text ? value.string() : "";
  }
  return settings;
}

// What stands after `name` and a blank on a line of a log.
std::optional<double> logged(const std::string& line, const std::string& name) {
  const std::size_t at = line.find(name + ' ');
  if (at == std::string::npos) return std::nullopt;
  double value = 0.0;
  const char* first = line.data() + at + name.size() + 1;
  const auto result = std::from_chars(first, line.data() + line.size(), value);
  return result.ec == std::errc() ? std::optional(value) : std::nullopt;
}

struct TrainingLog {
  TrainingView view;
  std::optional<double> seconds;  // once it has ended
};

// The last training in a log, to which every start of evo-train adds.
TrainingLog read_log(const fs::path& file, double steps) {
  TrainingLog log;
  log.view.id = file.stem().string();
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (const auto seconds = logged(line, "# trained in")) {
      log.seconds = seconds;
    } else if (line.starts_with('#')) {
      log.seconds.reset();
      if (!line.ends_with("resumed")) log.view.evaluations.clear();
    } else if (const auto value = logged(line, "eval/return")) {
      log.view.evaluations.push_back(*value);
      log.view.best = logged(line, "eval/best").value_or(*value);
      log.view.done = logged(line, "charts/global_step").value_or(0.0) / std::max(1.0, steps);
    }
  }
  return log;
}

bool is_slot(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.ends_with(".json") && name.find_first_not_of("0123456789") == name.size() - 5;
}

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace

RunStatus::RunStatus(fs::path folder)
    : folder_(std::move(folder)),
      made_(fs::file_time_type::clock::now()),
      settings_(read_settings(folder_)) {
  const auto number = [&](const std::string& name) {
    const std::string text = setting(name);
    int value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size() || value < 0)
      throw error(Failure::data, "{}: '{}' is not a number of {}", (folder_ / "run.yaml").string(),
                  text, name);
    return value;
  };
  evaluations_ = number("evaluations");
  steps_ = number("steps");
  update();
}

std::string RunStatus::setting(const std::string& name) const {
  const auto found = settings_.find(name);
  if (found == settings_.end())
    throw error(Failure::data, "{}: '{}' is missing", (folder_ / "run.yaml").string(), name);
  return found->second;
}

void RunStatus::update() {
  for (const fs::path& path : sorted_entries(folder_)) {
    const std::string name = path.filename().string();
    if (!name.starts_with("gen-")) continue;
    auto found = std::find_if(generations_.begin(), generations_.end(),
                              [&](const Generation& known) { return known.name == name; });
    if (found == generations_.end())
      found = generations_.insert(generations_.end(), {name, false, {}});
    if (!found->finished) read_generation(*found);
  }
}

// Asked whether it is finished before its files are listed: none is missed.
void RunStatus::read_generation(Generation& generation) {
  generation.finished = fs::exists(folder_ / generation.name / "ranking.tsv");
  for (const fs::path& file : sorted_entries(folder_ / generation.name)) {
    if (!is_slot(file) || !files_.insert(file.string()).second) continue;
    for (Robot& robot : read_robots({file.string()}, BodyCheck::any)) {
      if (const auto fitness = robot.fitness()) generation.scores.push_back(*fitness);
      add(std::move(robot));
    }
  }
}

void RunStatus::add(Robot robot) {
  if (!known_.insert(robot.id).second) return;
  const auto log = read_log(folder_ / "logs" / (robot.id + ".log"), steps_);
  if (log.seconds) {
    seconds_ += *log.seconds;
    ++timed_;
  }
  const auto fitness = robot.fitness();
  if (fitness && (!best_ || *fitness > *best_->fitness())) best_ = std::move(robot);
  if (best_) best_so_far_.push_back(*best_->fitness());
}

bool RunStatus::over() const { return fs::exists(folder_ / "best.json"); }

std::optional<double> RunStatus::seconds_each() const {
  return timed_ > 0 ? std::optional(seconds_ / timed_) : std::nullopt;
}

std::vector<TrainingView> RunStatus::running() const {
  std::vector<TrainingView> views;
  if (!fs::exists(folder_ / "logs")) return views;
  for (const fs::path& file : sorted_entries(folder_ / "logs")) {
    std::error_code gone;
    if (known_.count(file.stem().string()) > 0 || fs::last_write_time(file, gone) < made_) continue;
    TrainingLog log = read_log(file, steps_);
    if (!log.seconds) views.push_back(std::move(log.view));
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
  if (run.best())
    text += fmt::format("  best {:.3f} {}", *run.best()->fitness(),
                        sparkline(run.best_so_far(), curve_columns));
  if (const auto each = run.seconds_each(); each && run.left() > 0)
    text += fmt::format("  {} left", duration(*each * run.left() / static_cast<double>(at_once)));
  return text;
}

// "gen-003  5.102 (median 3.310)  "
std::string generation_result(const RunStatus::Generation& generation) {
  std::vector<double> scores = generation.scores;
  if (scores.empty()) return generation.name + "  every training failed";
  std::sort(scores.begin(), scores.end());
  return fmt::format("{}  {:.3f} (median {:.3f})", generation.name, scores.back(),
                     scores[scores.size() / 2]);
}

}  // namespace

void watch_run(const fs::path& folder, bool live) {
  constexpr int pause_milliseconds = 250;
  catch_interrupts();
  const pid_t caller = ::getppid();
  RunStatus run(folder);
  LiveLine line(live);
  std::set<std::string> told;
  for (const RunStatus::Generation& generation : run.generations())
    if (generation.finished) told.insert(generation.name);
  std::size_t at_once = 1;  // most trainings seen side by side
  for (bool last = false; !last;) {
    last = run.over() || interrupted() != 0 || ::getppid() != caller;
    run.update();
    const std::vector<TrainingView> running = run.running();
    at_once = std::max(at_once, running.size());
    for (const RunStatus::Generation& generation : run.generations()) {
      if (!generation.finished || !told.insert(generation.name).second) continue;
      line.erase();
      fmt::print("{}  {}\n", generation_result(generation), standing(run, at_once));
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
