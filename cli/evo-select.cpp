// evo-select: the survivors among scored robots, best first.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "cli/command.h"
#include "cli/robots.h"
#include "formats/io/values.h"
#include "formats/robot/writer.h"
#include "libevo/evolve/select.h"

namespace {

using namespace evo;

struct Settings {
  std::optional<int> keep;
  std::optional<std::string> schedule;
  std::optional<int> evaluated;
  std::optional<int> maximum;
  std::optional<int> population;
  std::string by = "fitness";
  bool skip_failed = false;
  bool unscored = false;
  std::optional<int> grace;
  int layers = 1;
};

// How many survive of a population of this size.
std::size_t survivors(const Settings& settings, std::size_t population) {
  if (settings.keep && settings.schedule)
    throw Error(Failure::usage, "give one of --keep and --schedule");
  if (settings.keep) {
    if (*settings.keep < 0)
      throw error(Failure::usage, "--keep must not be negative, got {}", *settings.keep);
    return static_cast<std::size_t>(*settings.keep);
  }
  if (!settings.schedule) return population;
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

// Something of the body, or a number of the document.
double value_of(const Robot& robot, const std::string& name) {
  if (name == "actuators") return count_actuators(robot.body);
  if (name == "voxels") return count_voxels(robot.body);
  return number_of(robot, name).value_or(std::numeric_limits<double>::quiet_NaN());
}

bool is_null(const Robot& robot, const std::string& name) {
  const auto found = robot.document.find(name);
  return found != robot.document.end() && found->is_null();
}

// What is maximised, of each robot.
std::vector<double> scores_of(const std::vector<Robot>& robots, std::string name) {
  const double sign = name.front() == '-' ? -1.0 : 1.0;
  if (name.front() == '-' || name.front() == '+') name.erase(0, 1);
  std::vector<double> scores;
  bool known = robots.empty();
  for (const Robot& robot : robots) {
    scores.push_back(sign * value_of(robot, name));
    // That of robots that have all failed is null, which is no misspelt name.
    known |= !std::isnan(scores.back()) || is_null(robot, name);
  }
  if (!known && name == "fitness")
    throw Error(Failure::data,
                "no robot has a fitness yet; evo-eval and evo-train give it, --by names something "
                "else to select by");
  if (!known)
    throw error(
        Failure::data,
        "no robot has a number '{}'; --by names a field of the document, actuators or voxels",
        name);
  return scores;
}

// A population that shares one controller, in which age counts: each file has the scores of a
// generation, the last one is selected from.
struct Generations {
  std::vector<Robot> last;
  std::map<std::string, int> born;  // generation of each robot, by id
};

Generations read_generations(const std::vector<std::string>& files) {
  Generations generations;
  int number = 0;
  for (const std::string& file : files) {
    generations.last = cli::read_robots({file});
    for (const Robot& robot : generations.last) generations.born.emplace(robot.id, number);
    ++number;
  }
  return generations;
}

// A robot younger than `grace` generations is safe: the controller does not know it yet.
// Founders are all equally new, so none of them is. The other places are shared out among
// layers by age, of 1, 2, 4, .. generations and the last without end (Hornby 2006, where the
// age is that of a line of descent); in each the best stay. Places that a layer leaves free go
// to the best of all others.
Indices staying(const Generations& generations, const Settings& settings, std::size_t places,
                int last) {
  const std::vector<Robot>& robots = generations.last;
  const auto layers = static_cast<std::size_t>(settings.layers);
  std::vector<bool> stays(robots.size(), false);
  std::vector<Indices> by_layer(layers);
  Indices others;
  std::size_t safe = 0;
  const Indices ranked = rank(scores_of(robots, settings.by));
  for (const std::size_t i : ranked) {
    if (!robots[i].fitness()) continue;
    const int born = generations.born.at(robots[i].id);
    const int age = last - born;
    if (born > 0 && age < *settings.grace) {
      stays[i] = true;
      ++safe;
      continue;
    }
    std::size_t layer = 0;
    for (int end = age - (born > 0 ? *settings.grace : 0) + 1; end > 1 && layer + 1 < layers;
         end /= 2)
      ++layer;
    by_layer[layer].push_back(i);
    others.push_back(i);
  }
  std::size_t left = places > safe ? places - safe : 0;
  const std::size_t free = left;
  for (std::size_t k = 0; k < layers; ++k) {
    const std::size_t share = free / layers + (k < free % layers ? 1 : 0);
    for (std::size_t n = 0; n < std::min(share, by_layer[k].size()); ++n, --left)
      stays[by_layer[k][n]] = true;
  }
  for (const std::size_t i : others)
    if (left > 0 && !stays[i]) {
      stays[i] = true;
      --left;
    }
  Indices chosen;
  for (const std::size_t i : ranked)
    if (stays[i]) chosen.push_back(i);
  return chosen;
}

// Without what its training gave but the steps that it took, to be trained again.
Robot without_score(Robot robot) {
  for (const char* field : {"fitness", "failure", "policy", "task", "behaviour", "final"})
    robot.document.erase(field);
  return robot;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-select");
  Settings settings;
  std::vector<std::string> files;
  command.arguments(files, "FILE", "scored robots [standard input]");
  command.section("How many");
  command.option("--keep", settings.keep, "N", "this many [all, sorted]");
  command.option("--schedule", settings.schedule, "NAME",
                 "paper: the shrinking share of the benchmark's genetic algorithm");
  command.option("--evaluated", settings.evaluated, "N", "robots created so far in the run");
  command.option("--evals", settings.maximum, "N", "robots the whole run may create");
  command.option("--pop", settings.population, "N",
                 "full population size of the schedule [robots read]");
  command.section("Which");
  command.option("--by", settings.by, "NUMBER",
                 "what is maximised: a number of the document, such as final.mean, actuators, or "
                 "voxels; '-' before it minimises it");
  command.flag("--skip-failed", settings.skip_failed, "none without a fitness");
  command.option("--grace", settings.grace, "N",
                 "the files are generations that shared one controller, the last to select from: a "
                 "robot survives this many selections at least");
  command.option("--layers", settings.layers, "N",
                 "with --grace: layers by age, 1, 2, 4, .. generations, that share the places");
  command.flag("--unscored", settings.unscored,
               "without fitness, policy and what else a training gave, to be trained again");
  command.output_option("where the survivors go, one JSON document per line");
  command.example("evo-select --keep 5 scores.jsonl", "the five best");
  command.example("evo-select --schedule paper --evaluated 36 --evals 250 scores.jsonl",
                  "what the benchmark's genetic algorithm keeps");
  command.example("evo-select --by=-actuators scores.jsonl", "robots with few actuators first");

  return command.run(argc, argv, [&] {
    command.only(settings.schedule.has_value(), {"--evaluated", "--evals", "--pop"},
                 "--schedule paper");
    command.only(settings.grace.has_value(), {"--layers"}, "--grace");
    if (settings.layers < 1)
      throw error(Failure::usage, "--layers must be at least 1, got {}", settings.layers);
    std::vector<Robot> robots;
    Indices chosen;
    if (settings.grace) {
      Generations generations = read_generations(files);
      const std::size_t places = survivors(settings, generations.last.size());
      chosen = staying(generations, settings, places, static_cast<int>(files.size()) - 1);
      robots = std::move(generations.last);
    } else {
      robots = cli::read_robots(files);
      if (settings.skip_failed)
        std::erase_if(robots, [](const Robot& robot) { return !robot.fitness(); });
      chosen =
          select_truncation(scores_of(robots, settings.by), survivors(settings, robots.size()));
    }
    RobotWriter out(command.output);
    for (const std::size_t i : chosen)
      out.write(settings.unscored ? without_score(robots[i]) : robots[i]);
    out.finish();
    return 0;
  });
}
