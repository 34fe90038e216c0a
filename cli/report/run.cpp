#include "cli/report/run.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "formats/files.h"
#include "formats/policy.h"
#include "formats/rollout.h"
#include "formats/run.h"

namespace evo::report {
namespace {

namespace fs = std::filesystem;

constexpr int newest_run_version = 1;

// A folder as it is called, "." too; the folders above need not be readable.
fs::path full_path(const fs::path& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

std::vector<Setting> masked(const RunSettings& settings) {
  std::vector<Setting> list;
  for (const auto& [name, value] : settings.list()) list.push_back({name, without_folders(value)});
  return list;
}

void add_history(const RunHistory& history, Run& run) {
  for (const TrainedRobot& trained : history.robots())
    run.robots.push_back(
        {trained.robot, trained.generation, trained.fitness, without_folders(trained.failure)});
  run.by_id = history.by_id();
  run.champion = history.champion_index();
  for (const RunHistory::Generation& begun : history.generations()) {
    Generation generation{begun.number, {}, begun.slots.size()};
    for (const auto& robot : begun.slots)
      if (robot) generation.members.push_back(*robot);
    run.generations.push_back(std::move(generation));
  }
}

// ---- the champion -----------------------------------------------------------------

void read_training(const RunFolder& folder, const std::string& id, Run& run) {
  for (const fs::path& file : {folder.policy(id), folder.path() / "best.policy.h5"}) {
    if (!fs::exists(file)) continue;
    PolicyFile policy = read_policy(file);
    if (policy.robot.id != id) continue;
    run.curve = std::move(policy.curve);
    run.final_score = policy.final_score;
    return;
  }
}

// The final files belong to the champion only if no better robot was found since.
bool best_is(const RunFolder& folder, const std::string& id) {
  const fs::path best = folder.best();
  if (!fs::exists(best)) return false;
  const std::vector<Robot> robots = read_robots(best.string(), BodyCheck::any);
  return robots.size() == 1 && robots.front().id == id;
}

void read_film(const fs::path& folder, const std::string& id, Run& run) {
  const fs::path file = folder / "best.rollout.h5";
  if (!fs::exists(file)) return;
  const Rollout rollout = read_rollout(file);
  if (rollout.robot && rollout.robot->id == id) run.film = draw_film(rollout);
}

void read_video(const fs::path& folder, double largest, Run& run) {
  constexpr std::array<std::pair<const char*, const char*>, 5> forms{{{"best.mp4", "video/mp4"},
                                                                      {"best.webm", "video/webm"},
                                                                      {"best.gif", "image/gif"},
                                                                      {"best.apng", "image/apng"},
                                                                      {"best.png", "image/png"}}};
  for (const auto& [name, media_type] : forms) {
    if (!fs::exists(folder / name)) continue;
    const auto bytes = static_cast<double>(fs::file_size(folder / name));
    if (bytes <= largest) {
      run.video = Video{media_type, read_file(folder / name)};
      run.video_left_out = 0.0;
      return;
    }
    run.video_left_out = bytes;
  }
}

}  // namespace

std::string Run::setting(const std::string& name) const {
  for (const Setting& setting : settings)
    if (setting.name == name) return setting.value;
  return "";
}

std::optional<std::size_t> Run::evaluations() const {
  const std::string text = setting("evaluations");
  std::size_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || result.ec != std::errc() || result.ptr != text.data() + text.size())
    return std::nullopt;
  return value;
}

std::size_t Run::failures() const {
  return static_cast<std::size_t>(std::count_if(robots.begin(), robots.end(),
                                                [](const Entry& entry) { return !entry.fitness; }));
}

Run read_run(const fs::path& folder, double largest_video) {
  const RunHistory history{RunFolder(folder)};
  Run run;
  run.label = full_path(folder).filename().string();
  run.settings = masked(history.folder().settings());
  add_history(history, run);
  if (run.champion) {
    const std::string& id = run.robots[*run.champion].robot.id;
    read_training(history.folder(), id, run);
    read_film(folder, id, run);
    if (best_is(history.folder(), id)) read_video(folder, largest_video, run);
  }
  return run;
}

void tell_apart(std::vector<Run>& runs, const std::vector<fs::path>& folders) {
  const auto count_labels = [&] {
    std::map<std::string, int> uses;
    for (const Run& run : runs) ++uses[run.label];
    return uses;
  };
  const auto by_name = count_labels();
  for (std::size_t k = 0; k < runs.size(); ++k)
    if (by_name.at(runs[k].label) > 1)
      runs[k].label = full_path(folders[k]).parent_path().filename().string() + "/" + runs[k].label;
  const auto by_both = count_labels();
  std::map<std::string, int> seen;
  for (Run& run : runs)
    if (by_both.at(run.label) > 1) run.label += fmt::format(" ({})", ++seen[run.label]);
}

std::string without_folders(const std::string& text) {
  constexpr std::string_view ends = " \t\n'\"=,:;()";
  std::string shorter;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find_first_of(ends, start), text.size());
    const std::string_view word = std::string_view(text).substr(start, end - start);
    const std::size_t slash = word.find_last_of('/');
    shorter += word.starts_with('/') || word.starts_with('~') ? word.substr(slash + 1) : word;
    if (end < text.size()) shorter += text[end];
    start = end + 1;
  }
  return shorter;
}

}  // namespace evo::report
