#include "formats/run/run.h"

#include <unistd.h>

#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>

#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/node.h"
#include "formats/io/number.h"
#include "formats/run/settings.h"
#include "libevo/base/digest.h"

namespace evo {
namespace {

namespace fs = std::filesystem;

constexpr const char* settings_name = "run.yaml";
constexpr std::string_view generation_prefix = "gen-";
constexpr std::string_view slot_suffix = ".json";

std::optional<int> count_in(std::string_view text) {
  const auto value = number_in<int>(text);
  return value && *value >= 0 ? value : std::nullopt;
}

std::string why_failed(const Robot& robot) {
  const auto failure = robot.failure();
  return failure ? failure->why : "no fitness";
}

std::optional<std::size_t> first_fittest(const std::vector<TrainedRobot>& robots) {
  const auto best = std::ranges::max_element(robots, {}, &TrainedRobot::fitness);
  if (best == robots.end() || !best->fitness) return std::nullopt;
  return static_cast<std::size_t>(best - robots.begin());
}

}  // namespace

std::string this_machine() {
  const char* node = std::getenv("SLURMD_NODENAME");
  if (node != nullptr && *node != '\0') return node;
  std::array<char, HOST_NAME_MAX + 1> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "unknown";
  return name.data();
}

std::string marked_machine(const fs::path& mark) {
  std::ifstream file(mark);  // may be gone by now
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const Json found = Json::parse(text, nullptr, false);
  return found.is_object() && found.contains("host") && found["host"].is_string()
             ? found["host"].get<std::string>()
             : "?";
}

// ---- RunSettings --------------------------------------------------------------------

RunSettings::RunSettings(std::string method, std::vector<RunSetting> list) {
  check_run_method(method);
  for (const auto& [name, value] : list) {
    const RunSettingInfo* info = find_run_setting(name);
    if (info == nullptr) {
      std::vector<std::string> names;
      for (const RunSettingInfo& known : run_settings()) names.push_back(known.name);
      throw error(Failure::usage, "{}", unknown_name("setting of a run", name, names));
    }
    if (!info->belongs_to(method))
      throw error(Failure::usage, "{} is a setting of {}, not of {}", info->option(),
                  fmt::join(info->methods, ", "), method);
    if (const auto defect = info->defect(value))
      throw error(Failure::usage, "{} {}", info->option(), *defect);
  }
  list_.push_back({"method", std::move(method)});
  list_.insert(list_.end(), list.begin(), list.end());
}

RunSettings RunSettings::read(const fs::path& file) {
  return parse(read_file(file, largest_document), file.string());
}

RunSettings RunSettings::parse(std::string_view text, const std::string& where) {
  const Node document = Node::yaml(text, where);
  if (!document.is_mapping()) throw document.error("a run's settings are a mapping");
  check_format(document, format::run, Head::required);
  std::map<std::string, std::string> own{
      {"method", ""}, {"source", ""}, {"source_hash", ""}, {"makefile", ""}};
  std::vector<RunSetting> list;
  for (const auto& [key, value] : document.entries()) {
    const std::string name = key.string();
    if (name == "format" || name == "version") continue;
    if (const auto known = own.find(name); known != own.end())
      known->second = value.string();
    else
      list.push_back({name, value.string()});
  }
  try {
    RunSettings settings(own["method"], std::move(list));
    settings.file_ = where;
    settings.set_source(own["source"], own["source_hash"]);
    settings.set_makefile(own["makefile"]);
    return settings;
  } catch (const Error& e) {
    throw error(Failure::data, "{}: {}", where, e.what());
  }
}

const std::string* RunSettings::find(const std::string& name) const {
  for (const RunSetting& setting : list_)
    if (setting.name == name) return &setting.value;
  return nullptr;
}

std::string RunSettings::value(const std::string& name) const {
  const std::string* found = find(name);
  return found == nullptr ? "" : *found;
}

const std::string& RunSettings::text(const std::string& name) const {
  const std::string* value = find(name);
  if (value == nullptr) throw error(Failure::data, "{}: '{}' is missing", file_, name);
  return *value;
}

int RunSettings::number(const std::string& name) const {
  const auto value = count_in(text(name));
  if (!value) throw error(Failure::data, "{}: '{}' is not a number of {}", file_, text(name), name);
  return *value;
}

const std::string& RunSettings::scored_by() const {
  return text(is_evaluated() ? "evaluate" : "task");
}

std::string task_label(const std::string& task) {
  const std::size_t python = task.find(".py:");
  return python == std::string::npos ? fs::path(task).stem().string()
                                     : task.substr(task.rfind(':') + 1);
}

int RunSettings::rungs_left(int generation) const {
  if (find("rungs") == nullptr) return 0;
  const int rungs = std::max(1, number("rungs"));
  return rungs - 1 - generation % rungs;
}

bool RunSettings::shares(int generation) const {
  if (text("method") != "modular") return false;
  const int pop = number("pop");
  const int children = std::max(1, number("children"));
  const int born_later = std::max(0, number("evals") - pop);
  return generation <= (born_later + children - 1) / children;
}

int RunSettings::steps(int generation) const {
  if (text("method") == "modular" && !shares(generation)) return std::max(1, number("steps") / 2);
  constexpr int most = 30;  // halvings that leave anything
  const bool founders = generation == 0 && find("founder_steps") != nullptr;
  return std::max(
      1, number(founders ? "founder_steps" : "steps") >> std::min(rungs_left(generation), most));
}

std::string RunSettings::to_yaml() const {
  YAML::Emitter out;
  out << YAML::BeginMap;
  out << YAML::Key << "format" << YAML::Value << format::run.name;
  out << YAML::Key << "version" << YAML::Value << format::run.version;
  for (const auto& [name, value] : list_) out << YAML::Key << name << YAML::Value << value;
  if (!source_hash_.empty())
    out << YAML::Key << "source" << YAML::Value << source_ << YAML::Key << "source_hash"
        << YAML::Value << source_hash_;
  if (!makefile_.empty()) out << YAML::Key << "makefile" << YAML::Value << makefile_;
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

// ---- RunFolder ----------------------------------------------------------------------

RunFolder::RunFolder(fs::path path) : path_(std::move(path)) {
  if (!fs::exists(path_))
    throw error(Failure::no_input, "{}: there is no such run folder", path_.string());
  if (!fs::is_directory(path_))
    throw error(Failure::data, "{}: a file, not a run folder", path_.string());
  const fs::path file = path_ / settings_name;
  if (!fs::is_regular_file(file))
    throw error(Failure::data, "{}: a folder without {} is not a run", path_.string(),
                settings_name);
  settings_ = RunSettings::read(file);
}

fs::path RunFolder::generation(int number) const {
  return path_ / fmt::format("{}{:03}", generation_prefix, number);
}

bool RunFolder::is_edited() const {
  const fs::path makefile = path_ / "Makefile";
  return !settings_.makefile().empty() && fs::is_regular_file(makefile) &&
         sha256_hex(read_file(makefile)) != settings_.makefile();
}

std::vector<int> RunFolder::generations() const {
  std::vector<int> numbers;
  for (const auto& entry : fs::directory_iterator(path_)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(generation_prefix)) continue;
    if (const auto number = count_in(std::string_view(name).substr(generation_prefix.size())))
      numbers.push_back(*number);
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

std::map<std::string, std::string> RunFolder::running() const {
  std::map<std::string, std::string> found;
  if (!fs::exists(journal())) return found;
  for (const auto& entry : fs::directory_iterator(journal())) {
    if (entry.path().extension() == ".running" && entry.is_regular_file())
      found[entry.path().stem().string()] = marked_machine(entry.path());
  }
  return found;
}

std::map<int, fs::path> RunFolder::trained_slots(int generation_number) const {
  std::map<int, fs::path> found;
  for (const auto& entry : fs::directory_iterator(generation(generation_number))) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(slot_suffix) || !entry.is_regular_file()) continue;
    if (const auto first =
            count_in(std::string_view(name).substr(0, name.find_first_not_of("0123456789"))))
      found[*first] = entry.path();
  }
  return found;
}

// ---- RunHistory ----------------------------------------------------------------------

RunHistory::RunHistory(RunFolder folder) : folder_(std::move(folder)) { update(); }

void RunHistory::update() {
  for (const int number : folder_.generations()) {
    auto found = std::ranges::lower_bound(generations_, number, {}, &Generation::number);
    if (found == generations_.end() || found->number != number)
      found = generations_.insert(found, {number, false, {}, {}, {}});
    if (!found->finished) read_generation(*found);
  }
  read_timings();
}

// Asked whether it is finished before its files are listed: none is missed.
void RunHistory::read_generation(Generation& generation) {
  generation.finished = fs::is_regular_file(folder_.scores(generation.number));
  const auto is_known = [&](std::size_t slot) {
    return slot < generation.slots.size() && generation.slots[slot];
  };
  // One file instead of many, and all there is to know of the population.
  if (const fs::path scores = folder_.scores(generation.number); fs::is_regular_file(scores)) {
    std::vector<Robot> robots = read_robots(scores.string(), BodyCheck::any);
    for (std::size_t slot = 0; slot < robots.size(); ++slot)
      if (!is_known(slot)) add(generation, slot, std::move(robots[slot]));
    return;
  }
  if (const fs::path file = folder_.population(generation.number);
      generation.population.empty() && fs::is_regular_file(file)) {
    for (const Robot& robot : read_robots(file.string(), BodyCheck::any))
      generation.population.push_back(robot.id);
    generation.slots.resize(std::max(generation.slots.size(), generation.population.size()));
  }
  for (const auto& [first, file] : folder_.trained_slots(generation.number)) {
    if (is_known(static_cast<std::size_t>(first))) continue;
    auto slot = static_cast<std::size_t>(first);
    for (Robot& robot : read_robots(file.string(), BodyCheck::any))
      add(generation, slot++, std::move(robot));
  }
}

// A robot is scored once, unless its training continues in a later generation.
void RunHistory::add(Generation& generation, std::size_t slot, Robot robot) {
  if (slot >= generation.slots.size()) generation.slots.resize(slot + 1);
  generation.scores.resize(generation.slots.size());
  generation.scores[slot] = robot.fitness();
  const auto [known, is_new] = by_id_.emplace(robot.id, robots_.size());
  const std::size_t index = known->second;
  generation.slots[slot] = index;
  if (is_new)
    robots_.push_back({std::move(robot), generation.number, std::nullopt, {}});
  else if (has_gone_on(robots_[index].robot, robot))
    robots_[index].robot = std::move(robot);
  else
    return;
  TrainedRobot& trained = robots_[index];
  trained.fitness = trained.robot.fitness();
  trained.failure = trained.fitness ? "" : why_failed(trained.robot);
  // With the controller of all it may earn less than in the generation before.
  if (champion_ == index) champion_ = first_fittest(robots_);
  if (trained.fitness && (!champion_ || *trained.fitness > *robots_[*champion_].fitness))
    champion_ = index;
}

// Whole lines after what was read before; a line being written waits for its end.
void RunHistory::read_timings() {
  if (!fs::exists(folder_.journal())) return;
  for (const auto& entry : fs::directory_iterator(folder_.journal())) {
    if (entry.path().extension() != ".jsonl" || !entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    std::uintmax_t& read = timings_read_[entry.path().filename().string()];
    file.seekg(static_cast<std::streamoff>(read));
    for (std::string line; std::getline(file, line) && !file.eof();) {
      read += line.size() + 1;
      const Json timing = Json::parse(line, nullptr, false);
      const auto has_number = [&](const char* key) {
        return timing.is_object() && timing.contains(key) && timing[key].is_number();
      };
      if (!has_number("seconds")) continue;
      const double seconds = timing["seconds"].get<double>();
      const double started = has_number("started") ? timing["started"].get<double>() : 0.0;
      seconds_ += seconds;
      if (started > 0.0) worked_.emplace_back(started, started + seconds);
      machines_.insert(entry.path().stem().string());
      timed_ += timing.contains("finished") && timing["finished"] == true ? 1 : 0;
    }
  }
}

std::optional<double> RunHistory::seconds_each() const {
  return timed_ > 0 ? std::optional(seconds_ / static_cast<double>(timed_)) : std::nullopt;
}

double RunHistory::began() const { return worked_.empty() ? 0.0 : std::ranges::min(worked_).first; }

double RunHistory::ended() const {
  double last = 0.0;
  for (const auto& [begin, end] : worked_) last = std::max(last, end);
  return last;
}

Utilisation RunHistory::utilisation() const {
  std::vector<std::pair<double, int>> changes;  // time, trainings more or less
  for (const auto& [begin, end] : worked_) {
    changes.emplace_back(begin, 1);
    changes.emplace_back(end, -1);
  }
  std::sort(changes.begin(), changes.end());  // an end before a beginning at the same time
  Utilisation found;
  double span = 0.0;
  double busy = 0.0;
  int running = 0;
  for (std::size_t k = 0; k < changes.size(); ++k) {
    running += changes[k].second;
    found.cores = std::max(found.cores, static_cast<std::size_t>(running));
    if (running == 0 || k + 1 == changes.size()) continue;
    const double length = changes[k + 1].first - changes[k].first;
    span += length;
    busy += length * running;
  }
  if (span > 0.0) found.idle = 1.0 - busy / (span * static_cast<double>(found.cores));
  return found;
}

std::vector<SlotStatus> RunHistory::slots(const Generation& generation) const {
  const std::map<std::string, std::string> running = folder_.running();
  const bool all = folder_.settings().shares(generation.number) &&
                   running.contains(folder_.generation(generation.number).filename().string());
  std::vector<SlotStatus> list;
  for (std::size_t k = 0; k < generation.slots.size(); ++k) {
    SlotStatus status;
    status.generation = generation.number;
    status.slot = static_cast<int>(k);
    if (const auto& index = generation.slots[k]) {
      const TrainedRobot& trained = robots_[*index];
      status.robot = trained.robot.id;
      status.state = trained.fitness ? SlotState::done : SlotState::failed;
      status.why = trained.failure;
    } else if (k < generation.population.size()) {
      status.robot = generation.population[k];
      status.state =
          all || running.contains(status.robot) ? SlotState::training : SlotState::waiting;
    }
    list.push_back(std::move(status));
  }
  return list;
}

}  // namespace evo
