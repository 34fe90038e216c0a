#include "evolution/propose.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>
#include <utility>

#include "evolution/archive.h"
#include "evolution/breeding.h"
#include "formats/io/files.h"
#include "formats/io/values.h"
#include "formats/run/steady.h"
#include "libevo/evolve/methods.h"
#include "libevo/evolve/select.h"

namespace evo {
namespace {

namespace fs = std::filesystem;

struct Settings {
  std::string method;
  EvolutionSettings evolution;
  int window = 0;
};

Settings read_settings(const RunFolder& run, const Breeding& breeding, const DataFolders& folders) {
  const RunSettings& given = run.settings();
  if (run.layout() != Layout::steady)
    throw error(Failure::usage, "{}: a run with generations; its robots come from its pipeline",
                run.path().string());
  Settings settings;
  settings.method = given.text("method");
  settings.window = given.number("window");
  EvolutionSettings& evolution = settings.evolution;
  evolution.pop = given.number("pop");
  evolution.evals = given.number("evals");
  const auto [rows, cols] = parse_shape(given.text("shape"));
  evolution.rows = rows;
  evolution.cols = cols;
  // The seed of a pipeline's first stage, so that the first robots are the same.
  evolution.seed = static_cast<std::uint64_t>(given.number("seed")) * 1'000'000;
  check(breeding);
  evolution.breeding = breeding;
  if (settings.method == CppnNeat::name) {
    const std::string* file = given.find("neat");
    const bool has_own = file != nullptr && *file != "default";
    evolution.neat =
        neat_settings(has_own ? std::optional(*file) : std::nullopt, evolution.pop, folders);
  }
  if (settings.method == MapElites::name)
    evolution.axes = parse_archive(given.text("features"), "features").axes();
  return settings;
}

// The robots of a run in their order, read where they are filed.
class Filed {
 public:
  explicit Filed(const RunFolder& run) : run_(run) {}

  std::vector<Robot> population(int generation) const {
    const fs::path file = run_.population(generation);
    return fs::exists(file) ? evo::read_robots(file.string(), BodyCheck::any)
                            : std::vector<Robot>{};
  }
  Robot scored(int number) {
    const SlotAddress address = run_.address(number);
    if (fs::exists(run_.scores(address.generation))) {
      if (cached_ != address.generation) {
        scores_ = evo::read_robots(run_.scores(address.generation).string(), BodyCheck::any);
        cached_ = address.generation;
      }
      return scores_.at(static_cast<std::size_t>(address.slot));
    }
    const fs::path file = run_.slot(address);
    if (!fs::exists(file))
      throw error(Failure::no_input, "{}: the score of robot {} is needed first", file.string(),
                  number);
    return evo::read_robots(file.string(), BodyCheck::any).at(0);
  }

 private:
  const RunFolder& run_;
  int cached_ = -1;  // generation of scores_
  std::vector<Robot> scores_;
};

// The ids of all robots proposed, by number, a line each: RUN/robots.txt. Lines are
// only appended; those that the state does not count yet are written again.
class Ids {
 public:
  Ids(const fs::path& file, int count) : file_(file) {
    const auto size = static_cast<std::uintmax_t>(count) * line_size;
    std::string text = fs::exists(file) ? read_file(file) : "";
    if (text.size() < size)
      throw error(Failure::data, "{}: {} robots are proposed, but their ids are not here",
                  file.string(), count);
    if (text.size() > size) fs::resize_file(file, size);
    text.resize(size);
    for (std::size_t at = 0; at < size; at += line_size)
      known.insert(text.substr(at, line_size - 1));
  }
  void add(const std::string& id) {
    known.insert(id);
    fresh_ += id + "\n";
  }
  void finish() {
    std::ofstream out(file_, std::ios::app | std::ios::binary);
    out << fresh_ << std::flush;
    if (!out) throw error(Failure::io, "{}: cannot be written", file_.string());
    fresh_.clear();
  }

  std::set<std::string> known;

 private:
  static constexpr std::size_t line_size = 13;  // 12 digits of an id, end of line
  fs::path file_;
  std::string fresh_;
};

// ---- proposing ---------------------------------------------------------------------

// The population of a generation as it grows: complete lines, written whole.
class GrowingPopulation {
 public:
  GrowingPopulation(const RunFolder& run, SlotAddress next) : run_(run) { open(next); }

  void add(SlotAddress address, const Robot& robot) {
    if (address.generation != generation_) {
      write();
      open(address);
    }
    text_ += robot_to_line(robot) + "\n";
  }
  void write() const {
    if (text_.empty()) return;
    make_folders(run_.generation(generation_));
    write_file(run_.population(generation_), text_);
  }

 private:
  // Robots from `next` on are proposed anew, even if they are there.
  void open(SlotAddress next) {
    generation_ = next.generation;
    text_.clear();
    const fs::path file = run_.population(generation_);
    if (next.slot == 0) return;
    const std::string there = fs::exists(file) ? read_file(file) : "";
    std::size_t end = 0;
    for (int line = 0; line < next.slot; ++line) {
      end = there.find('\n', end) + 1;
      if (end == 0)
        throw error(Failure::data, "{}: {} robots are proposed, but only {} are here",
                    file.string(), next.slot, line);
    }
    text_ = there.substr(0, end);
  }

  const RunFolder& run_;
  int generation_ = 0;
  std::string text_;
};

ScoredRobot seen_by_methods(const Robot& robot, const Settings& settings) {
  ScoredRobot scored = scored_robot(robot);
  scored.features = features_of(robot, settings.evolution.axes);
  return scored;
}

// Founders that the pipeline has put into the first population count as proposed.
void adopt_founders(const Filed& filed, int pop, SteadyState& state, Ids& ids) {
  const std::vector<Robot> founders = filed.population(0);
  const int count = std::min(pop, static_cast<int>(founders.size()));
  for (; state.robots < count; ++state.robots)
    ids.add(founders[static_cast<std::size_t>(state.robots)].id);
}

template <EvolutionMethod Method>
void propose(const RunFolder& run, const Settings& settings, Method& method, int robots,
             SteadyState& state) {
  Filed filed(run);
  Ids ids(run.path() / "robots.txt", state.robots);
  int told = state.method.told;
  method.load(std::move(state.method));
  std::vector<Body> proposed;  // all of them, for methods that are told of pending ones
  if (Method::told_again) {
    for (int k = 0; k < told; ++k) method.tell(seen_by_methods(filed.scored(k), settings));
    for (int k = 0; k < state.robots; k += settings.evolution.pop)
      for (const Robot& robot : filed.population(run.address(k).generation))
        if (proposed.size() < static_cast<std::size_t>(state.robots))
          proposed.push_back(robot.body);
  }
  if (Method::any_founders) adopt_founders(filed, settings.evolution.pop, state, ids);
  GrowingPopulation population(run, run.address(state.robots));
  for (; state.robots < robots; ++state.robots) {
    const int number = state.robots;
    const int known = known_scores(number, settings.window, settings.evolution.pop);
    for (; told < known; ++told) method.tell(seen_by_methods(filed.scored(told), settings));
    const auto pending = std::span<const Body>(proposed).subspan(
        std::min(proposed.size(), static_cast<std::size_t>(told)));
    const Robot robot =
        robot_of(method.propose(number, pending, ids.known), settings.evolution.seed, number);
    if (Method::told_again) proposed.push_back(robot.body);
    ids.add(robot.id);
    population.add(run.address(number), robot);
  }
  population.write();
  ids.finish();
  state.method = method.save();
}

}  // namespace

void propose_robots(const RunFolder& run, const Breeding& breeding, const DataFolders& folders,
                    int robots) {
  const Settings settings = read_settings(run, breeding, folders);
  AnyEvolution method = make_evolution(settings.method, settings.evolution);
  if (robots > settings.evolution.evals)
    throw error(Failure::usage, "{}: the run has {} robots, not {}", run.path().string(),
                settings.evolution.evals, robots);
  const fs::path file = run.path() / "steady.json";
  SteadyState state;
  if (fs::exists(file)) state = parse_steady_state(read_file(file), file.string());
  if (robots <= state.robots) return;
  std::visit([&](auto& chosen) { propose(run, settings, chosen, robots, state); }, method);
  // Last: what it counts is there.
  write_file(file, steady_state_to_text(state));
}

}  // namespace evo
