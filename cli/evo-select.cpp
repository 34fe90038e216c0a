// evo-select: the survivors among scored robots, best first.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/robots.h"
#include "formats/robot/writer.h"
#include "libevo/evolve/select.h"

namespace {

using namespace evo;

struct Settings {
  std::optional<int> keep;
  std::string by = "fitness";
  bool unscored = false;
  std::optional<int> grace;
};

// Something of the body, or a number of the document.
double value_of(const Robot& robot, const std::string& name) {
  if (name == "actuators") return count_actuators(robot.body);
  if (name == "voxels") return count_voxels(robot.body);
  return number_of(robot, name).value_or(std::numeric_limits<double>::quiet_NaN());
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
    known |= !std::isnan(scores.back()) || robot.document.value(name, Json(0)).is_null();
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
// Founders are all equally new, so none of them is. The best of the others take the other
// places.
Indices staying(const Generations& generations, const Settings& settings, std::size_t places,
                int last) {
  const std::vector<Robot>& robots = generations.last;
  std::vector<bool> stays(robots.size(), false);
  Indices others;
  std::size_t safe = 0;
  const Indices ranked = rank(scores_of(robots, settings.by));
  for (const std::size_t i : ranked) {
    if (!robots[i].fitness()) continue;
    const int born = generations.born.at(robots[i].id);
    stays[i] = born > 0 && last - born < *settings.grace;
    if (stays[i])
      ++safe;
    else
      others.push_back(i);
  }
  const std::size_t left = places > safe ? places - safe : 0;
  for (std::size_t k = 0; k < std::min(left, others.size()); ++k) stays[others[k]] = true;
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
  command.option("--keep", settings.keep, "N", "this many [all, sorted]").at_least(0);
  command.option("--by", settings.by, "NUMBER",
                 "what is maximised: a number of the document, such as final.mean, actuators, or "
                 "voxels; '-' before it minimises it");
  command.option("--grace", settings.grace, "N",
                 "the files are generations that shared one controller, the last to select from: a "
                 "robot survives this many selections at least");
  command.flag("--unscored", settings.unscored,
               "to be trained again: without fitness, policy and what else a training gave; those "
               "that have failed are left out");
  command.output_option("where the survivors go, one JSON document per line");
  command.example("evo-select --keep 5 scores.jsonl", "the five best");
  command.example("evo-select --by=-actuators scores.jsonl", "robots with few actuators first");

  return command.run(argc, argv, [&] {
    cli::keep_inputs(command.output, files);
    std::vector<Robot> robots;
    Indices chosen;
    const auto places = [&] {
      return settings.keep ? static_cast<std::size_t>(*settings.keep) : robots.size();
    };
    if (settings.grace) {
      Generations generations = read_generations(files);
      robots = generations.last;
      chosen = staying(generations, settings, places(), static_cast<int>(files.size()) - 1);
    } else {
      robots = cli::read_robots(files);
      if (settings.unscored)
        std::erase_if(robots, [](const Robot& robot) { return !robot.fitness(); });
      chosen = select_truncation(scores_of(robots, settings.by), places());
    }
    RobotWriter out(command.output);
    for (const std::size_t i : chosen)
      out.write(settings.unscored ? without_score(robots[i]) : robots[i]);
    out.finish();
    return 0;
  });
}
