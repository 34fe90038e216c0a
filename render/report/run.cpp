#include "render/report/run.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <string_view>

#include "formats/io/files.h"
#include "formats/io/number.h"
#include "formats/rollout/ending.h"
#include "formats/rollout/episodes.h"
#include "formats/rollout/rollout.h"
#include "formats/run/run_policy.h"
#include "formats/training/training_log.h"
#include "libevo/base/parallel.h"
#include "render/render.h"
#include "render/report/choice.h"
#include "render/report/replay.h"
#include "render/scene/round_numbers.h"

namespace evo::report {
namespace {

namespace fs = std::filesystem;

// A folder as it is called, "." too; the folders above need not be readable.
fs::path full_path(const fs::path& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

std::string folder_in_commands(const fs::path& folder) {
  const fs::path given = folder.lexically_normal();
  const bool here = given.is_relative() && *given.begin() != ".." && *given.begin() != ".";
  if (!here) return full_path(folder).filename().string();
  return (given.has_filename() ? given : given.parent_path()).string();
}

std::string purpose_of(const PolicyFile& policy) {
  if (policy.task_yaml.empty()) return "";  // of a task in Python
  const auto text = Node::yaml(policy.task_yaml, "task of a policy").find("description");
  return text && text->is_scalar() ? text->text() : "";
}

// "train=profiles/fast.yaml" as "train=fast.yaml".
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

std::vector<RunSetting> masked(const RunFolder& folder) {
  std::vector<RunSetting> list;
  for (const auto& [name, value] : folder.settings().list())
    list.push_back({name, without_folders(value)});
  if (folder.settings().is_evaluated() && !folder.settings().source_hash().empty())
    list.push_back(
        {"program", fmt::format("{}, SHA-256 {}", without_folders(folder.settings().source()),
                                folder.settings().source_hash().substr(0, 12))});
  if (folder.is_edited()) list.push_back({"Makefile", "edited by hand"});
  return list;
}

void add_history(const RunHistory& history, Run& run) {
  for (const TrainedRobot& trained : history.robots())
    run.robots.push_back(
        {trained.robot, trained.generation, trained.fitness, without_folders(trained.failure), {}});
  run.by_id = history.by_id();
  run.champion = history.champion_index();
  for (const RunHistory::Generation& begun : history.generations()) {
    Generation generation{begun.number, {}, {}, begun.slots.size()};
    for (std::size_t slot = 0; slot < begun.slots.size(); ++slot) {
      if (!begun.slots[slot]) continue;
      generation.members.push_back(*begun.slots[slot]);
      generation.scores.push_back(begun.scores[slot]);
    }
    run.generations.push_back(std::move(generation));
  }
}

// ---- trainings and episodes --------------------------------------------------------

constexpr std::size_t most_points = 60;  // of a curve: what can be told apart in a small chart

Training training_of(const PolicyFile& policy) {
  Training training;
  training.curve = spread(policy.curve, most_points);
  training.final_score = policy.final_score;
  training.best_step = policy.best_step;
  training.steps = policy.steps;
  training.created_by = policy.created_by;
  return training;
}

// Adds entropy, KL and explained variance from a log of evo-train. A log that is not there adds
// nothing.
void add_log(const std::filesystem::path& file, Training& training) {
  if (!std::filesystem::is_regular_file(file)) return;
  const std::map<std::string, std::string> wanted{
      {"losses/entropy", "entropy"},
      {"losses/approx_kl", "KL divergence"},
      {"losses/explained_variance", "explained variance"}};
  std::map<std::string, std::vector<std::pair<double, double>>> series;
  std::istringstream lines(read_file(file));
  for (std::string line; std::getline(lines, line);)
    if (const auto step = logged(line, "charts/global_step"))
      for (const auto& [key, name] : wanted)
        if (const auto value = logged(line, key)) series[name].emplace_back(*step, *value);
  for (const auto& [key, name] : wanted)
    if (!series[name].empty()) training.log.push_back({name, spread(series[name], most_points)});
}

void read_shared(const RunFolder& folder, Run& run) {
  for (const int generation : folder.generations()) {
    const fs::path file = folder.shared_policy(generation);
    if (!folder.settings().shares(generation) || !fs::is_regular_file(file)) continue;
    Training training = training_of(read_policy(file));
    add_log(folder.log(generation, ""), training);
    run.shared.push_back({generation, std::move(training)});
  }
}

// Each on its own, whatever the number of threads.
void read_trainings(const RunFolder& folder, std::size_t replays, int threads, Run& run) {
  constexpr std::size_t smooth = 20;  // beside the champion and its ancestors
  const std::set<std::size_t> moving = looked_at_first(run, replays);
  const std::set<std::size_t> first = looked_at_first(run, std::min(smooth, replays));
  std::vector<Json> episodes(run.shown.size());
  std::vector<Json> worlds(run.shown.size());
  std::vector<std::string> purposes(run.shown.size());
  ThreadPool pool(threads);
  pool.run(run.shown.size(), [&](std::size_t k, int /*worker*/) {
    Entry& entry = run.robots[run.shown[k]];
    const std::optional<RunPolicy> stored = policy_of(folder, entry.robot);
    if (!stored) return;
    const PolicyFile& policy = stored->policy;
    entry.policy = stored->file.lexically_relative(folder.path()).string();
    entry.sharing = stored->sharing;
    purposes[k] = purpose_of(policy);
    if (entry.sharing) {
      entry.training.created_by = policy.created_by;
    } else {
      entry.training = training_of(policy);
      add_log(folder.log(entry.robot.id), entry.training);
    }
    if (!moving.contains(run.shown[k])) return;
    if (policy.task_yaml.empty() && !fs::exists(recorded_beside(stored->file))) return;
    const Rollout rollout = play(policy, stored->file, "evo-report");
    episodes[k] = replay_of(rollout, first.contains(run.shown[k]) ? fine_stride : coarse_stride);
    worlds[k] = world_of(rollout);
  });
  for (std::size_t k = 0; k < run.shown.size(); ++k) {
    if (!episodes[k].is_null()) run.replays.emplace(run.shown[k], std::move(episodes[k]));
    if (run.purpose.empty()) run.purpose = purposes[k];
    if (run.world.is_null() && !worlds[k].is_null()) run.world = std::move(worlds[k]);
  }
}

std::string draw_film(const Rollout& rollout, const char* theme) {
  constexpr int moments = 6;
  render::RenderOptions options;
  options.size = {1140, 560};  // pixels, as wide as the page
  options.theme = theme;
  return render::encode_picture(render::draw_moments({&rollout, 0, ""}, {moments}, options),
                                rollout.task, "film.svg");
}

// The champion's recorded episode: its way as a picture, and its replay where its
// policy is gone.
void read_recording(const fs::path& folder, const std::string& id, Run& run) {
  const fs::path file = folder / "best.rollout.h5";
  if (!fs::is_regular_file(file)) return;
  const Rollout rollout = read_rollout(file);
  if (!rollout.robot || rollout.robot->id != id) return;
  run.film = Film{draw_film(rollout, "light"), draw_film(rollout, "dark")};
  if (run.replays.contains(*run.champion)) return;
  run.replays.emplace(*run.champion, replay_of(rollout));
  run.world = world_of(rollout);
}

}  // namespace

std::optional<double> Generation::best() const {
  return scores.empty() ? std::nullopt : std::ranges::max(scores);
}

std::string Run::setting(const std::string& name) const {
  for (const RunSetting& setting : settings)
    if (setting.name == name) return setting.value;
  return "";
}

std::string Run::method() const {
  const std::string name = setting("name");
  return name.empty() ? setting("method") : name;
}

std::string Run::subject() const {
  return is_evaluated() ? "own fitness: " + setting("evaluate") : setting("task");
}

std::optional<std::size_t> Run::evaluations() const {
  return number_in<std::size_t>(setting("evals"));
}

std::size_t Run::failures() const {
  return static_cast<std::size_t>(std::count_if(robots.begin(), robots.end(),
                                                [](const Entry& entry) { return !entry.fitness; }));
}

bool Run::shows(std::size_t robot) const {
  return std::binary_search(shown.begin(), shown.end(), robot);
}

int Run::decimals() const { return champion ? decimals_of(*robots[*champion].fitness) : 2; }

std::string Run::text(const std::optional<double>& fitness) const {
  return fitness ? number(*fitness, decimals()) : "failed";
}

int decimals_of(double largest) {
  constexpr int most = 6;
  const double size = std::abs(largest);
  if (!(size > 0)) return 2;
  const int digits = static_cast<int>(std::floor(std::log10(size)));
  return std::clamp((digits > 0 ? 3 : 2) - digits, 0, most);
}

std::string number(double value, int decimals) {
  return render::axis_number(value, std::pow(10, -decimals));
}

Run read_run(const fs::path& folder, const Extent& extent, int threads) {
  const RunHistory history{RunFolder(folder)};
  Run run;
  run.label = full_path(folder).filename().string();
  run.folder = folder_in_commands(folder);
  run.settings = masked(history.folder());
  add_history(history, run);
  if (extent.robots == 0) return run;
  run.seconds = history.seconds();
  run.began = std::llround(history.began());
  run.ended = std::llround(history.ended());
  run.machines = {history.machines().begin(), history.machines().end()};
  run.shown = shown_one_by_one(run, extent.robots);
  read_trainings(history.folder(), extent.replays, threads, run);
  read_shared(history.folder(), run);
  if (run.champion) read_recording(folder, run.robots[*run.champion].robot.id, run);
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

}  // namespace evo::report
