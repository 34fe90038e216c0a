#include "evolution/propose.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "evolution/breeding.h"
#include "formats/io/files.h"
#include "formats/robot/genome.h"
#include "formats/run/steady.h"
#include "libevo/evolve/select.h"
#include "libevo/evolve/suggest.h"

namespace evo {
namespace {

namespace fs = std::filesystem;

constexpr double failed = std::numeric_limits<double>::quiet_NaN();

struct Settings {
  std::string method;
  int population = 0;
  int window = 0;
  int evaluations = 0;
  Shape shape;
  std::uint64_t seed = 0;
  Breeding breeding;  // ga
  NeatSettings neat;
};

Settings read_settings(const RunFolder& run, const Breeding& breeding, const DataFolders& folders) {
  const RunSettings& given = run.settings();
  if (run.layout() != Layout::steady)
    throw error(Failure::usage, "{}: a run with generations; its robots come from its pipeline",
                run.path().string());
  Settings settings;
  settings.method = given.text("method");
  settings.population = given.number("pop");
  settings.window = given.number("window");
  settings.evaluations = given.number("evals");
  settings.shape = parse_shape(given.text("shape"));
  // The seed of a pipeline's first stage, so that the first robots are the same.
  settings.seed = static_cast<std::uint64_t>(given.number("seed")) * 1'000'000;
  settings.breeding = breeding;
  breeding.check();
  if (settings.method == "neat") {
    const std::string* file = given.find("neat");
    const bool has_own = file != nullptr && *file != "default";
    settings.neat =
        neat_settings(has_own ? std::optional(*file) : std::nullopt, settings.population, folders);
  } else if (settings.method != "ga" && settings.method != "bo") {
    throw error(Failure::usage, "{}: method '{}' is none of ga, neat, bo", run.path().string(),
                settings.method);
  }
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
  void add(const std::string& id) { fresh_ += id + "\n"; }
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

// ---- the methods ------------------------------------------------------------------

// Each proposes robot `number` once it was told all scores that the robot knows.

class GeneticAlgorithm {
 public:
  explicit GeneticAlgorithm(const Settings& settings) : settings_(settings) {}

  // The best first, the earlier robot of equals; at most a population of them.
  void tell(const Robot& robot, SteadyState& state) const {
    if (!robot.fitness()) return;
    const auto after =
        std::find_if(state.members.begin(), state.members.end(),
                     [&](const Robot& m) { return *m.fitness() < *robot.fitness(); });
    state.members.insert(after, robot);
    if (state.members.size() > static_cast<std::size_t>(settings_.population))
      state.members.pop_back();
  }

  Robot propose(int number, const SteadyState& state, std::set<std::string>& seen) const {
    if (number < settings_.population || state.members.empty())
      return sample_robot(settings_.shape, default_weights, settings_.seed, number, seen);
    const auto parents = static_cast<std::size_t>(
        steady_parents(settings_.population, state.scores, settings_.evaluations));
    const std::vector<Robot> best(state.members.begin(),
                                  state.members.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                              parents, state.members.size())));
    return breed_robot(best, settings_.breeding, settings_.seed, number, seen);
  }

 private:
  const Settings& settings_;
};

// The genome keys are the robots' numbers.
class Neat {
 public:
  Neat(const Settings& settings, const SteadyState& state) : settings_(settings) {
    for (const Robot& robot : state.members) population_.push_back(scored(robot));
  }

  void tell(const Robot& robot, SteadyState& state) {
    join(settings_.neat, scored(robot), population_, state.species);
    state.members.push_back(robot);
    std::erase_if(state.members, [&](const Robot& member) {
      return std::none_of(population_.begin(), population_.end(),
                          [&](const Scored& s) { return s.genome.key == genome(member).key; });
    });
  }

  Robot propose(int number, SteadyState& state, std::set<std::string>& seen) const {
    const bool is_first = number < settings_.population;
    const CppnRobot made =
        next_robot(settings_.neat, settings_.shape.rows, settings_.shape.cols,
                   is_first ? std::span<const Scored>{} : std::span<const Scored>(population_),
                   seen, state.species, number, settings_.seed);
    std::vector<std::string> parents;
    for (const int key : made.parents)
      for (const Robot& member : state.members)
        if (genome(member).key == key) parents.push_back(member.id);
    return cppn_robot(made, parents, settings_.seed, number);
  }

 private:
  static Genome genome(const Robot& robot) {
    auto found = genome_of(robot, "robot " + robot.id);
    if (!found) throw error(Failure::data, "robot {} has no genome", robot.id);
    return *std::move(found);
  }
  static Scored scored(const Robot& robot) {
    return {genome(robot), robot.fitness().value_or(failed)};
  }

  const Settings& settings_;
  std::vector<Scored> population_;
};

class BayesianOptimisation {
 public:
  // Nothing of what was told is kept in the state but the parameters.
  BayesianOptimisation(const Settings& settings, const RunFolder& run, Filed& filed,
                       const SteadyState& state)
      : settings_(settings) {
    for (int k = 0; k < state.robots; k += settings.population)
      for (const Robot& robot : filed.population(run.address(k).generation))
        if (designs_.size() < static_cast<std::size_t>(state.robots))
          designs_.push_back(robot.body.cells);
    for (int k = 0; k < state.scores; ++k) observe(filed.scored(k));
  }

  void tell(const Robot& robot, SteadyState& /*state*/) { observe(robot); }

  Robot propose(int number, SteadyState& state, std::set<std::string>& seen) {
    const bool is_first = number < settings_.population;
    const std::span<const Observation> known =
        is_first ? std::span<const Observation>{} : std::span<const Observation>(observations_);
    const std::span<const Design> pending = std::span<const Design>(designs_).subspan(known.size());
    SuggestSettings suggesting;
    suggesting.parameters = parameters(known, state);
    const SuggestedBatch batch = suggest(settings_.shape.rows, settings_.shape.cols, known, pending,
                                         1, suggesting, settings_.seed);
    Robot robot = make_child(batch.designs.front().body, {}, "evo-suggest", settings_.seed,
                             static_cast<std::uint64_t>(number));
    designs_.push_back(robot.body.cells);
    seen.insert(robot.id);
    return robot;
  }

 private:
  void observe(const Robot& robot) {
    observations_.push_back({robot.body.cells, robot.fitness().value_or(failed)});
  }

  // Fitted to as many scores as fill whole populations; before that, and while none
  // of them has succeeded, to what is there.
  std::optional<GpParameters> parameters(std::span<const Observation> known,
                                         SteadyState& state) const {
    const int fitted = static_cast<int>(known.size()) / settings_.population * settings_.population;
    const auto fitting = known.first(static_cast<std::size_t>(fitted));
    const bool has_success = std::any_of(fitting.begin(), fitting.end(), [](const Observation& o) {
      return std::isfinite(o.fitness);
    });
    if (!has_success) return std::nullopt;
    if (!state.parameters || state.fitted != fitted) {
      state.parameters = fit_parameters(fitting, {}, settings_.seed);
      state.fitted = fitted;
    }
    return state.parameters;
  }

  const Settings& settings_;
  std::vector<Design> designs_;            // of all robots proposed
  std::vector<Observation> observations_;  // of those scored
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

template <typename Method>
void propose(const RunFolder& run, const Settings& settings, Method&& method, Filed& filed,
             int robots, SteadyState& state) {
  Ids ids(run.path() / "robots.txt", state.robots);
  GrowingPopulation population(run, run.address(state.robots));
  for (; state.robots < robots; ++state.robots) {
    const int number = state.robots;
    const int known = known_scores(number, settings.window, settings.population);
    for (; state.scores < known; ++state.scores) method.tell(filed.scored(state.scores), state);
    const Robot robot = method.propose(number, state, ids.known);
    ids.add(robot.id);
    population.add(run.address(number), robot);
  }
  population.write();
  ids.finish();
}

}  // namespace

void propose_robots(const RunFolder& run, const Breeding& breeding, const DataFolders& folders,
                    int robots) {
  const Settings settings = read_settings(run, breeding, folders);
  if (robots > settings.evaluations)
    throw error(Failure::usage, "{}: the run has {} robots, not {}", run.path().string(),
                settings.evaluations, robots);
  const fs::path file = run.path() / "steady.json";
  SteadyState state;
  if (fs::exists(file)) state = parse_steady_state(read_file(file), file.string());
  if (robots <= state.robots) return;
  Filed filed(run);
  if (settings.method == "ga") {
    propose(run, settings, GeneticAlgorithm(settings), filed, robots, state);
  } else if (settings.method == "neat") {
    propose(run, settings, Neat(settings, state), filed, robots, state);
  } else {
    propose(run, settings, BayesianOptimisation(settings, run, filed, state), filed, robots, state);
  }
  // Last: what it counts is there.
  write_file(file, steady_state_to_text(state));
}

}  // namespace evo
