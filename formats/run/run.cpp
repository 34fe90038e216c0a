#include "formats/run/run.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>

#include "formats/io/files.h"
#include "formats/io/format.h"
#include "formats/io/yaml.h"
#include "formats/run/setting_table.h"
#include "formats/training/training_log.h"

namespace evo {
namespace {

namespace fs = std::filesystem;

constexpr const char* settings_name = "run.yaml";
constexpr std::string_view generation_prefix = "gen-";
constexpr std::string_view slot_suffix = ".json";

bool is_setting_name(const std::string& name) {
  return !name.empty() &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789") == std::string::npos;
}

bool is_line(const std::string& text) {
  return std::none_of(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\t') || c == '\x7f';
  });
}

std::optional<int> whole_number(std::string_view text) {
  int value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size() || value < 0)
    return std::nullopt;
  return value;
}

// The numbers of a folder's entries that are named prefix, number, suffix; sorted.
std::vector<int> numbered(const fs::path& folder, std::string_view prefix,
                          std::string_view suffix) {
  std::vector<int> numbers;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix) || !name.ends_with(suffix)) continue;
    const std::string_view middle =
        std::string_view(name).substr(prefix.size(), name.size() - prefix.size() - suffix.size());
    if (const auto number = whole_number(middle)) numbers.push_back(*number);
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

// ---- settings -----------------------------------------------------------------

constexpr const char* quoted_setting = "train_options";  // always in quotes

// A value that YAML gives back as it is without quotes.
bool is_plain(const std::string& value) {
  if (value.empty()) return true;
  constexpr std::string_view indicators = "?:,[]{}#&*!|>'\"%@` ";
  if (value.find('\t') != std::string::npos) return false;
  const bool is_item = value[0] == '-' && (value.size() == 1 || value[1] == ' ');
  return !is_item && indicators.find(value.front()) == std::string_view::npos &&
         value.back() != ' ' && value.back() != ':' && value.find(": ") == std::string::npos &&
         value.find(" #") == std::string::npos && value != "~" && value != "null";
}

std::string quoted(const std::string& value) {
  std::string text = "'";
  for (const char c : value) text += c == '\'' ? std::string("''") : std::string(1, c);
  return text + "'";
}

std::string shown(const RunSettings& settings, const std::string& name) {
  const std::string* value = settings.find(name);
  return value == nullptr ? "no " + name
                          : fmt::format("{}: {}", name, value->empty() ? "''" : *value);
}

// "steps: 4096 there, steps: 8192 asked for; ..."; empty if none.
std::string differences(const RunSettings& there, const RunSettings& asked) {
  std::vector<std::string> names;
  for (const auto* settings : {&there, &asked})
    for (const RunSetting& setting : settings->list())
      if (std::find(names.begin(), names.end(), setting.name) == names.end())
        names.push_back(setting.name);
  std::string text;
  for (const std::string& name : names) {
    const std::string* one = there.find(name);
    const std::string* other = asked.find(name);
    if (one != nullptr && other != nullptr && *one == *other) continue;
    text += fmt::format("{}{} there, {} asked for", text.empty() ? "" : "; ", shown(there, name),
                        shown(asked, name));
  }
  return text;
}

// ---- timings --------------------------------------------------------------------

std::ifstream open_population(const fs::path& file) {
  std::ifstream lines(file);
  if (!lines)
    throw error(Failure::no_input, "{}: this generation has no population yet", file.string());
  return lines;
}

std::string why_failed(const Robot& robot) {
  const auto failure = robot.failure();
  return failure ? failure->why : "no fitness";
}

std::optional<std::size_t> first_fittest(const std::vector<TrainedRobot>& robots) {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < robots.size(); ++k)
    if (robots[k].fitness && (!best || *robots[k].fitness > *robots[*best].fitness)) best = k;
  return best;
}

// Whether a folder holds what a training or an evaluation took time for.
bool has_results(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (const auto ending = entry.path().extension(); ending == ".h5" || ending == ".json")
      return true;
  return false;
}

}  // namespace

std::string this_machine() {
  const char* node = std::getenv("SLURMD_NODENAME");
  if (node != nullptr && *node != '\0') return node;
  std::array<char, HOST_NAME_MAX + 1> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "unknown";
  return name.data();
}

// ---- RunSettings --------------------------------------------------------------------

RunSettings RunSettings::from_words(const std::vector<std::string>& words) {
  RunSettings settings;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    if (equals == std::string::npos || !is_setting_name(name) || name == "format" ||
        name == "version")
      throw error(Failure::usage, "'{}' is not a setting KEY=VALUE, such as task=Walker-v0", word);
    if (name == "layout")
      throw Error(Failure::usage,
                  "there is no setting 'layout'; a run without generations has window=N");
    if (present_name(name) != name)
      throw error(Failure::usage, "the setting '{}' is called '{}'", name, present_name(name));
    if (settings.find(name) != nullptr)
      throw error(Failure::usage, "the setting '{}' is given twice", name);
    if (!is_line(word))
      throw error(Failure::usage, "the setting '{}' has line breaks or control characters", name);
    settings.list_.push_back({name, word.substr(equals + 1)});
  }
  return settings;
}

RunSettings RunSettings::read(const fs::path& file) {
  return parse(read_file(file, largest_document), file.string());
}

RunSettings RunSettings::parse(std::string_view text, const std::string& where) {
  const YamlNode document = YamlNode::parse(text, where);
  if (!document.is_mapping()) throw document.error("a run's settings are a mapping");
  RunSettings settings;
  settings.file_ = where;
  check_format(document, format::run, Head::required);
  for (const auto& [key, value] : document.entries()) {
    const std::string name = present_name(key.string());
    if (name == "format" || name == "version") continue;
    // Earlier versions said so beside `window`.
    if (name == "layout") {
      if (value.string() != "generations" && value.string() != "steady")
        throw value.error(
            unknown_name("layout of a run", value.string(), {"generations", "steady"}));
      continue;
    }
    if (!is_setting_name(name))
      throw key.error(
          fmt::format("{} is not the name of a setting, such as task", shown(Json(name))));
    const bool has_text = value.is_scalar() && !value.is_null() && value.found() != "''";
    const std::string text = has_text ? value.string() : "";
    if (!is_line(text))
      throw value.error(fmt::format("{} has line breaks or control characters", name));
    settings.list_.push_back({name, text});
  }
  return settings;
}

void RunSettings::check() const {
  for (const auto& [name, value] : list_)
    if (const SettingEntry* entry = find_setting_entry(name))
      if (const auto defect = entry->defect(value))
        throw error(Failure::usage, "{} {}", name, *defect);
}

const std::string* RunSettings::find(const std::string& name) const {
  for (const RunSetting& setting : list_)
    if (setting.name == name) return &setting.value;
  return nullptr;
}

const std::string& RunSettings::text(const std::string& name) const {
  const std::string* value = find(name);
  if (value == nullptr) throw error(Failure::data, "{}: '{}' is missing", file_, name);
  return *value;
}

int RunSettings::number(const std::string& name) const {
  const auto value = whole_number(text(name));
  if (!value) throw error(Failure::data, "{}: '{}' is not a number of {}", file_, text(name), name);
  return *value;
}

int RunSettings::rungs_left(int generation) const {
  if (find("rungs") == nullptr) return 0;
  const int rungs = std::max(1, number("rungs"));
  return rungs - 1 - generation % rungs;
}

bool RunSettings::shares(int generation) const {
  if (find("own_steps") == nullptr) return false;
  const int pop = number("pop");
  const int children = std::max(1, number("children"));
  const int born_later = std::max(0, number("evals") - pop);
  return generation <= (born_later + children - 1) / children;
}

int RunSettings::steps(int generation) const {
  if (find("own_steps") != nullptr && !shares(generation)) return std::max(1, number("own_steps"));
  constexpr int most = 30;  // halvings that leave anything
  const bool founders = generation == 0 && find("founder_steps") != nullptr;
  return std::max(
      1, number(founders ? "founder_steps" : "steps") >> std::min(rungs_left(generation), most));
}

bool RunSettings::goes_on(int generation) const { return rungs_left(generation) > 0; }

std::string RunSettings::to_yaml() const {
  std::string text =
      fmt::format("format: {}\nversion: {}\n", format::run.name, format::run.version);
  for (const auto& [name, value] : list_)
    text += fmt::format("{}: {}\n", name,
                        is_plain(value) && name != quoted_setting ? value : quoted(value));
  return text;
}

// ---- RunFolder ----------------------------------------------------------------------

RunFolder::RunFolder(fs::path path, RunSettings settings)
    : path_(std::move(path)),
      settings_(std::move(settings)),
      layout_(settings_.find("window") == nullptr ? Layout::generations : Layout::steady) {}

RunFolder::RunFolder(fs::path path) : path_(std::move(path)) {
  if (!fs::exists(path_))
    throw error(Failure::no_input, "{}: there is no such run folder", path_.string());
  if (!fs::is_directory(path_))
    throw error(Failure::data, "{}: a file, not a run folder", path_.string());
  const fs::path file = path_ / settings_name;
  if (!fs::exists(file))
    throw error(Failure::data, "{}: a folder without {} is not a run", path_.string(),
                settings_name);
  settings_ = RunSettings::read(file);
  if (settings_.find("window") != nullptr) layout_ = Layout::steady;
}

RunFolder RunFolder::create(const fs::path& path, const RunSettings& settings) {
  RunFolder run(path, settings);
  for (const fs::path& folder : {run.policies(), run.logs(), run.timings()}) make_folders(folder);
  const fs::path file = path / settings_name;
  if (!fs::exists(file)) {
    write_file(file, settings.to_yaml());
    return run;
  }
  const std::string difference = differences(RunSettings::read(file), settings);
  if (!difference.empty())
    throw error(
        Failure::cannot_create,
        "{} belongs to a run with other settings ({}); choose another folder or the same "
        "settings{}",
        path.string(), difference,
        has_results(path) ? "" : "; nothing has been trained in it yet: removing it loses nothing");
  return run;
}

fs::path RunFolder::generation(int number) const {
  return path_ / fmt::format("{}{:03}", generation_prefix, number);
}

fs::path RunFolder::slot(SlotAddress address) const {
  return generation(address.generation) / fmt::format("{:02}{}", address.slot, slot_suffix);
}

SlotAddress RunFolder::address(int number) const {
  const int population = std::max(1, settings_.number("pop"));
  return {number / population, number % population};
}

std::vector<int> RunFolder::generations() const { return numbered(path_, generation_prefix, ""); }

std::vector<Launch> RunFolder::launches(int generation_number) const {
  std::vector<Launch> launches;
  for (const auto& entry : fs::directory_iterator(generation(generation_number))) {
    if (entry.path().extension() != ".running") continue;
    std::ifstream file(entry.path());  // may be gone by now
    const std::string text(std::istreambuf_iterator<char>(file), {});
    const Json mark = Json::parse(text, nullptr, false);
    if (mark.is_object())
      launches.push_back({entry.path().stem().string(), mark.value("host", "")});
  }
  std::sort(launches.begin(), launches.end(),
            [](const Launch& a, const Launch& b) { return a.slots < b.slots; });
  return launches;
}

std::vector<int> RunFolder::trained_slots(int generation_number) const {
  return numbered(generation(generation_number), "", slot_suffix);
}

Robot RunFolder::robot(SlotAddress address) const {
  const fs::path file = population(address.generation);
  std::ifstream lines = open_population(file);
  std::string line;
  for (int k = 0; std::getline(lines, line); ++k)
    if (k == address.slot)
      return parse_robots(line, fmt::format("{}: slot {}", file.string(), k)).at(0);
  throw error(Failure::usage, "{}: there is no slot {}; generation {} has {}", file.string(),
              address.slot, address.generation, population_size(address.generation));
}

int RunFolder::population_size(int generation_number) const {
  std::ifstream lines = open_population(population(generation_number));
  return static_cast<int>(std::count(std::istreambuf_iterator<char>(lines), {}, '\n'));
}

// One write() to a file opened for appending stays in one piece between the
// processes of a machine, on network file systems, too.
void RunFolder::add_timing(const Timing& timing) const {
  make_folders(timings());
  const fs::path file = timings() / (this_machine() + ".jsonl");
  const Json line = {{"robot", timing.robot},      {"generation", timing.slot.generation},
                     {"slot", timing.slot.slot},   {"started", timing.started},
                     {"seconds", timing.seconds},  {"steps", timing.steps},
                     {"finished", timing.finished}};
  const std::string text = line.dump() + "\n";
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor < 0)
    throw error(Failure::cannot_create, "{}: cannot be created: {}", file.string(),
                std::generic_category().message(errno));
  const ssize_t written = ::write(descriptor, text.data(), text.size());
  const int code = errno;
  ::close(descriptor);
  if (written != static_cast<ssize_t>(text.size()))
    throw error(Failure::io, "{}: cannot be written: {}", file.string(),
                std::generic_category().message(code));
}

// ---- RunHistory ----------------------------------------------------------------------

RunHistory::RunHistory(RunFolder folder) : folder_(std::move(folder)) { update(); }

void RunHistory::update() {
  for (const int number : folder_.generations()) {
    auto found =
        std::lower_bound(generations_.begin(), generations_.end(), number,
                         [](const Generation& known, int wanted) { return known.number < wanted; });
    if (found == generations_.end() || found->number != number)
      found = generations_.insert(found, {number, false, {}, {}, {}});
    if (!found->finished) read_generation(*found);
  }
  read_timings();
}

// Asked whether it is finished before its files are listed: none is missed.
void RunHistory::read_generation(Generation& generation) {
  generation.finished = fs::exists(folder_.ranking(generation.number));
  const auto is_known = [&](std::size_t slot) {
    return slot < generation.slots.size() && generation.slots[slot];
  };
  // One file instead of many, and all there is to know of the population.
  if (const fs::path scores = folder_.scores(generation.number); fs::exists(scores)) {
    std::vector<Robot> robots = read_robots(scores.string(), BodyCheck::any);
    for (std::size_t slot = 0; slot < robots.size(); ++slot)
      if (!is_known(slot)) add(generation, slot, std::move(robots[slot]));
    return;
  }
  const bool grows = folder_.layout() == Layout::steady;
  if (const fs::path file = folder_.population(generation.number);
      (grows || generation.population.empty()) && fs::exists(file)) {
    generation.population.clear();
    for (const Robot& robot : read_robots(file.string(), BodyCheck::any))
      generation.population.push_back(robot.id);
    generation.slots.resize(std::max(generation.slots.size(), generation.population.size()));
  }
  for (const int slot : folder_.trained_slots(generation.number)) {
    if (is_known(static_cast<std::size_t>(slot))) continue;
    const fs::path file = folder_.slot({generation.number, slot});
    std::vector<Robot> robots = read_robots(file.string(), BodyCheck::any);
    if (robots.size() != 1)
      throw error(Failure::data, "{}: one robot is expected, {} are there", file.string(),
                  robots.size());
    add(generation, static_cast<std::size_t>(slot), std::move(robots.front()));
  }
}

// A robot is scored once, unless its training goes on in a later generation.
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
  if (!fs::exists(folder_.timings())) return;
  for (const auto& entry : fs::directory_iterator(folder_.timings())) {
    std::ifstream file(entry.path(), std::ios::binary);
    std::uintmax_t& read = timings_read_[entry.path().filename().string()];
    file.seekg(static_cast<std::streamoff>(read));
    for (std::string line; std::getline(file, line) && !file.eof();) {
      read += line.size() + 1;
      const Json timing = Json::parse(line, nullptr, false);
      if (!timing.is_object() || !timing.contains("seconds")) continue;
      const double seconds = timing.value("seconds", 0.0);
      const double started = timing.value("started", 0.0);
      seconds_ += seconds;
      if (started > 0.0) worked_.emplace_back(started, started + seconds);
      machines_.insert(entry.path().stem().string());
      timed_ += timing.value("finished", false) ? 1 : 0;
    }
  }
}

std::optional<double> RunHistory::seconds_each() const {
  return timed_ > 0 ? std::optional(seconds_ / static_cast<double>(timed_)) : std::nullopt;
}

double RunHistory::began() const {
  double first = worked_.empty() ? 0.0 : worked_.front().first;
  for (const auto& [begin, end] : worked_) first = std::min(first, begin);
  return first;
}

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
  const bool has_own_log = folder_.settings().find("own_steps") != nullptr;  // not of before
  std::vector<SlotStatus> list;
  for (std::size_t k = 0; k < generation.slots.size(); ++k) {
    SlotStatus status;
    status.address = {generation.number, static_cast<int>(k)};
    if (const auto& index = generation.slots[k]) {
      const TrainedRobot& trained = robots_[*index];
      status.robot = trained.robot.id;
      status.state = trained.fitness ? SlotState::done : SlotState::failed;
      status.why = trained.failure;
    } else if (k < generation.population.size()) {
      status.robot = generation.population[k];
      // A survivor has a log of its first generation, and waits to be copied, or to go on.
      const auto known = by_id_.find(status.robot);
      const fs::path log = folder_.log(generation.number, status.robot);
      const bool begun =
          fs::exists(log) &&
          (known == by_id_.end() || has_own_log ||
           read_training_log(log).step >
               static_cast<double>(robots_[known->second].robot.steps().value_or(0)));
      status.state = begun ? SlotState::training : SlotState::waiting;
    }
    list.push_back(std::move(status));
  }
  return list;
}

}  // namespace evo
