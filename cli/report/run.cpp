#include "cli/report/run.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "formats/files.h"
#include "formats/policy.h"
#include "formats/rollout.h"
#include "formats/yaml.h"

namespace evo::report {
namespace {

namespace fs = std::filesystem;

constexpr int newest_run_version = 1;

// A folder as it is called, "." too; the folders above need not be readable.
fs::path full_path(const fs::path& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

std::optional<std::size_t> whole_number(std::string_view text) {
  std::size_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || result.ec != std::errc() || result.ptr != text.data() + text.size())
    return std::nullopt;
  return value;
}

// ---- settings -------------------------------------------------------------------

void check_run_format(const YamlNode& key, const YamlNode& value) {
  if (key.string() == "format" && value.string() != "evo/run")
    throw value.error(fmt::format("{} is not the format of a run, evo/run", value.found()));
  if (key.string() == "version" && value.integer(1) > newest_run_version)
    throw value.error(fmt::format("version {} of evo/run is newer than this program's {}",
                                  value.integer(), newest_run_version));
}

std::vector<Setting> read_settings(const fs::path& file) {
  const YamlNode document = YamlNode::parse(read_file(file), file.string());
  if (!document.is_mapping()) throw document.error("a run's settings are a mapping");
  std::vector<Setting> settings;
  bool has_format = false;
  for (const auto& [key, value] : document.entries()) {
    const std::string name = key.string();
    has_format |= name == "format";
    check_run_format(key, value);
    if (name == "format" || name == "version") continue;
    const bool has_text = value.is_scalar() && value.found() != "''";
    settings.push_back({name, has_text ? without_folders(value.string()) : ""});
  }
  if (!has_format) throw document.error("no 'format: evo/run'; this is not a run's settings");
  return settings;
}

// ---- robots -----------------------------------------------------------------------

std::string why_failed(const Robot& robot) {
  const auto failure = robot.document.find("failure");
  if (failure == robot.document.end() || !failure->is_object()) return "no fitness";
  const auto why = failure->find("why");
  return why != failure->end() && why->is_string() ? without_folders(why->get<std::string>())
                                                   : "failed";
}

// gen-007 is 7; nothing for any other name.
std::optional<int> generation_number(const std::string& name) {
  constexpr std::string_view prefix = "gen-";
  if (!name.starts_with(prefix)) return std::nullopt;
  const auto number = whole_number(std::string_view(name).substr(prefix.size()));
  return number ? std::optional<int>(static_cast<int>(*number)) : std::nullopt;
}

// The generation's scores, or, while it is under way, its slots that are done.
std::vector<fs::path> score_files(const fs::path& generation) {
  if (const fs::path scores = generation / "scores.jsonl"; fs::exists(scores)) return {scores};
  std::vector<std::pair<std::size_t, fs::path>> slots;
  for (const auto& entry : fs::directory_iterator(generation))
    if (entry.path().extension() == ".json")
      if (const auto slot = whole_number(entry.path().stem().string()))
        slots.emplace_back(*slot, entry.path());
  std::sort(slots.begin(), slots.end());
  std::vector<fs::path> files;
  files.reserve(slots.size());
  for (auto& [slot, file] : slots) files.push_back(std::move(file));
  return files;
}

std::size_t population_size(const fs::path& generation, std::size_t trained) {
  const fs::path population = generation / "population.jsonl";
  if (!fs::exists(population)) return trained;
  return std::max(trained, read_robots(population.string(), BodyCheck::any).size());
}

void read_generation(const fs::path& folder, int number, Run& run) {
  Generation generation{number, {}, 0};
  for (const fs::path& file : score_files(folder)) {
    for (Robot& robot : read_robots(file.string(), BodyCheck::any)) {
      const auto [known, is_new] = run.by_id.emplace(robot.id, run.robots.size());
      generation.members.push_back(known->second);
      if (!is_new) continue;
      Entry entry{std::move(robot), number, std::nullopt, {}};
      entry.fitness = entry.robot.fitness();
      if (!entry.fitness) entry.failure = why_failed(entry.robot);
      run.robots.push_back(std::move(entry));
    }
  }
  generation.planned = population_size(folder, generation.members.size());
  run.generations.push_back(std::move(generation));
}

void read_generations(const fs::path& folder, Run& run) {
  std::vector<std::pair<int, fs::path>> generations;
  for (const auto& entry : fs::directory_iterator(folder))
    if (const auto number = generation_number(entry.path().filename().string());
        number && entry.is_directory())
      generations.emplace_back(*number, entry.path());
  std::sort(generations.begin(), generations.end());
  for (const auto& [number, path] : generations) read_generation(path, number, run);
}

std::optional<std::size_t> fittest(const std::vector<Entry>& robots) {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < robots.size(); ++k)
    if (robots[k].fitness && (!best || *robots[k].fitness > *robots[*best].fitness)) best = k;
  return best;
}

// ---- the champion -----------------------------------------------------------------

void read_training(const fs::path& folder, const std::string& id, Run& run) {
  for (const fs::path& file :
       {folder / "policies" / (id + ".policy.h5"), folder / "best.policy.h5"}) {
    if (!fs::exists(file)) continue;
    PolicyFile policy = read_policy(file);
    if (policy.robot.id != id) continue;
    run.curve = std::move(policy.curve);
    run.final_score = policy.final_score;
    return;
  }
}

// The final files belong to the champion only if no better robot was found since.
bool best_is(const fs::path& folder, const std::string& id) {
  const fs::path best = folder / "best.json";
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

std::optional<std::size_t> Run::evaluations() const { return whole_number(setting("evaluations")); }

std::size_t Run::failures() const {
  return static_cast<std::size_t>(std::count_if(robots.begin(), robots.end(),
                                                [](const Entry& entry) { return !entry.fitness; }));
}

Run read_run(const fs::path& folder, double largest_video) {
  if (!fs::exists(folder))
    throw error(Failure::no_input, "{}: there is no such run folder", folder.string());
  if (!fs::is_directory(folder))
    throw error(Failure::data, "{}: a file, not a run folder", folder.string());
  if (!fs::exists(folder / "run.yaml"))
    throw error(Failure::data, "{}: a folder without run.yaml is not a run", folder.string());
  Run run;
  run.label = full_path(folder).filename().string();
  run.settings = read_settings(folder / "run.yaml");
  read_generations(folder, run);
  run.champion = fittest(run.robots);
  if (run.champion) {
    const std::string& id = run.robots[*run.champion].robot.id;
    read_training(folder, id, run);
    read_film(folder, id, run);
    if (best_is(folder, id)) read_video(folder, largest_video, run);
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
