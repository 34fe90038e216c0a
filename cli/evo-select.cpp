// evo-select: the survivors among scored robots, best first.
#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/command.h"
#include "cli/robots.h"
#include "formats/io/values.h"
#include "formats/robot/writer.h"
#include "libevo/evolve/select.h"

namespace {

using namespace evo;

enum class Method { truncation, tournament, pareto };

struct Settings {
  std::optional<int> keep;
  std::optional<double> fraction;
  std::optional<std::string> schedule;
  std::optional<int> evaluated;
  std::optional<int> maximum;
  Method method = Method::truncation;
  std::string objectives = "fitness";
  int tournament_size = 3;
  bool plan = false;
  std::optional<int> population;
};

// The generations of a run under the paper's schedule, known before it starts:
// what was created up to each, how many of it survive, how many children follow.
void print_plan(const Settings& settings) {
  if (settings.schedule != "paper" || !settings.population || !settings.maximum)
    throw error(Failure::usage, "--plan needs --schedule paper, --pop and --evals");
  const int population = *settings.population;
  const int maximum = *settings.maximum;
  if (population > maximum)
    throw error(Failure::usage, "--pop {} is larger than --evals {}", population, maximum);
  std::string plan = "generation\trobots\tcreated\tsurvivors\tchildren\n";
  int created = population;
  for (int generation = 0, robots = population;; ++generation) {
    const bool last = created == maximum;
    const int kept = last ? 0 : paper_survivors(population, created, maximum);
    const int children = std::min(population - kept, maximum - created);
    plan +=
        fmt::format("{}\t{}\t{}\t{}\t{}\n", generation, robots, created, kept, last ? 0 : children);
    if (last) break;
    if (children <= 0)
      throw error(Failure::usage,
                  "--pop {} leaves no room for children beside {} survivors; at least 3 is "
                  "needed",
                  population, kept);
    created += children;
    robots = kept + children;
  }
  fmt::print("{}", plan);
}

// How many survive of a population of this size.
std::size_t survivors(const Settings& settings, std::size_t population) {
  const int given = static_cast<int>(settings.keep.has_value()) +
                    static_cast<int>(settings.fraction.has_value()) +
                    static_cast<int>(settings.schedule.has_value());
  if (given > 1) throw error(Failure::usage, "give one of --keep, --fraction and --schedule");
  if (settings.keep) {
    if (*settings.keep < 0)
      throw error(Failure::usage, "--keep must not be negative, got {}", *settings.keep);
    return static_cast<std::size_t>(*settings.keep);
  }
  if (settings.fraction) {
    if (!(*settings.fraction >= 0.0 && *settings.fraction <= 1.0))
      throw error(Failure::usage, "--fraction must be between 0 and 1, got {}", *settings.fraction);
    return static_cast<std::size_t>(
        std::ceil(*settings.fraction * static_cast<double>(population)));
  }
  if (settings.schedule) {
    if (*settings.schedule != "paper")
      throw error(Failure::usage, "--schedule: unknown schedule '{}'; there is: paper",
                  *settings.schedule);
    if (!settings.evaluated || !settings.maximum)
      throw error(
          Failure::usage,
          "--schedule paper needs --evaluated (robots so far) and --evals (of the whole run)");
    if (population == 0) return 0;
    return static_cast<std::size_t>(
        paper_survivors(settings.population.value_or(static_cast<int>(population)),
                        *settings.evaluated, *settings.maximum));
  }
  return population;
}

// The value of one objective: something of the body, or a number of the document.
double objective(const Robot& robot, const std::string& name) {
  if (name == "actuators") return count_actuators(robot.body);
  if (name == "voxels") return count_voxels(robot.body);
  return number_of(robot, name).value_or(std::numeric_limits<double>::quiet_NaN());
}

bool is_null(const Robot& robot, const std::string& name) {
  const auto found = robot.document.find(name);
  return found != robot.document.end() && found->is_null();
}

Objectives read_objectives(const std::vector<Robot>& robots, const std::string& list) {
  Objectives objectives;
  std::vector<std::string> names = split_list(list);
  if (names.empty()) throw error(Failure::usage, "--objectives is empty");
  for (std::string& name : names) {
    const bool minimise = name.front() == '-';
    objectives.signs.push_back(minimise ? -1.0 : 1.0);
    if (minimise || name.front() == '+') name.erase(0, 1);
  }
  for (const Robot& robot : robots) {
    std::vector<double> row;
    row.reserve(names.size());
    for (const std::string& name : names) row.push_back(objective(robot, name));
    objectives.rows.push_back(std::move(row));
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    bool known = robots.empty();
    for (const auto& row : objectives.rows) known |= !std::isnan(row[k]);
    // That of robots that have all failed is null, which is no misspelt name.
    for (const Robot& robot : robots) known |= is_null(robot, names[k]);
    if (!known && names[k] == "fitness")
      throw Error(Failure::data,
                  "no robot has a fitness yet; evo-eval and evo-train give it, --objectives names "
                  "something else to select by");
    if (!known)
      throw error(Failure::data,
                  "no robot has a number '{}'; objectives are fields of the document, "
                  "actuators or voxels",
                  names[k]);
  }
  return objectives;
}

Indices choose(const Settings& settings, const std::vector<Robot>& robots, std::uint64_t seed) {
  const std::size_t keep = survivors(settings, robots.size());
  const Objectives objectives = read_objectives(robots, settings.objectives);
  if (settings.method == Method::pareto) return select_pareto(objectives, keep);
  if (objectives.signs.size() != 1)
    throw Error(Failure::usage, "several --objectives need --method pareto");
  std::vector<double> scores;
  for (const auto& row : objectives.rows) scores.push_back(objectives.signs[0] * row[0]);
  if (settings.method == Method::truncation) return select_truncation(scores, keep);
  Stream stream(seed, "select");
  return select_tournament(scores, keep, settings.tournament_size, stream);
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-select");
  Settings settings;
  std::vector<std::string> files;
  command.arguments(files, "FILE", "scored robots [standard input]");
  command.section("How many");
  command.option("--keep", settings.keep, "N", "this many [all, sorted]");
  command.option("--fraction", settings.fraction, "X", "this share, rounded up");
  command.option("--schedule", settings.schedule, "NAME",
                 "paper: the shrinking share of the benchmark's genetic algorithm");
  command.option("--evaluated", settings.evaluated, "N", "robots created so far in the run");
  command.option("--evals", settings.maximum, "N", "robots the whole run may create");
  command.option("--pop", settings.population, "N",
                 "full population size of the schedule [robots read]");
  command.flag("--plan", settings.plan,
               "print the whole schedule as a table instead of reading robots");
  command.section("Which");
  command.choice("--method", settings.method, "NAME",
                 {{"truncation", Method::truncation},
                  {"tournament", Method::tournament},
                  {"pareto", Method::pareto}},
                 "truncation, tournament or pareto");
  command.option(
      "--objectives", settings.objectives, "LIST",
      "what is maximised: numbers of the document, such as final.mean, actuators, voxels; "
      "'-' before a name minimises it");
  command.option("--tournament-size", settings.tournament_size, "N", "entrants of a tournament");
  command.seed_option();
  command.output_option("where the survivors go, one JSON document per line");
  command.example("evo-select --keep 5 scores.jsonl", "the five best");
  command.example("evo-select --schedule paper --evaluated 36 --evals 250 scores.jsonl",
                  "what the benchmark's genetic algorithm keeps");
  command.example("evo-select --method pareto --objectives=fitness,-actuators scores.jsonl",
                  "good robots with few actuators first");

  return command.run(argc, argv, [&] {
    command.only(settings.schedule.has_value(), {"--evaluated", "--evals", "--pop"},
                 "--schedule paper");
    command.only(settings.method == Method::tournament, {"--tournament-size"},
                 "--method tournament");
    if (settings.plan) {
      if (!files.empty())
        throw error(Failure::usage, "--plan reads no robots; leave '{}' out", files.front());
      print_plan(settings);
      return 0;
    }
    const std::vector<Robot> robots = cli::read_robots(files);
    RobotWriter out(command.output);
    for (const std::size_t i : choose(settings, robots, command.seed)) out.write(robots[i]);
    out.finish();
    return 0;
  });
}
