// evo-score: the fitness of robots, from a program of one's own.
#include <algorithm>
#include <array>

#include "cli/command.h"
#include "cli/journal.h"
#include "cli/process.h"
#include "cli/robots.h"
#include "formats/robot/writer.h"

namespace {

using namespace evo;

struct Options {
  std::string program;
  std::optional<std::string> pick;
  std::optional<std::string> journal;
  int tries = 3;
  bool give_up = false;
};

// ---- what it says -----------------------------------------------------------------------

// The robot as the program gives it back, which is the same one with a fitness, or with why
// it has none.
Robot scored(const std::string& program, const Robot& robot, const std::string& text) {
  const std::string where = fmt::format("'{}', of robot {}", program, robot.id);
  std::vector<Robot> robots;
  try {
    robots = parse_robots(text, where);
  } catch (const Error& e) {
    throw error(Failure::data, "{}: it is to write the robot with its fitness", e.what());
  }
  if (robots.size() != 1)
    throw error(Failure::data, "{}: it is to write one robot with its fitness, not {}", where,
                robots.size());
  Robot& answer = robots.front();
  if (answer.id != robot.id)
    throw error(Failure::data, "{}: it gave another one, {}", where, answer.id);
  if (!answer.document.contains("fitness"))
    throw error(Failure::data, "{}: the robot it gave has no fitness", where);
  if (!answer.fitness() && !answer.failure()) return answer.failed({"its program gave no fitness"});
  return answer;
}

// Statuses by which a program says that something is wrong for any robot (docs/tools.md).
bool is_refusal(int status) {
  constexpr std::array refusals{2, 65, 66, 69, 73, 126, 127};
  return std::find(refusals.begin(), refusals.end(), status) != refusals.end();
}

// Nothing: interrupted.
std::optional<Robot> score(const Options& options, const Robot& robot) {
  int status = 0;
  for (int attempt = 0; attempt < options.tries; ++attempt) {
    const cli::Ended answer = cli::run_program({"bash", "-euo", "pipefail", "-c", options.program},
                                               robot_to_line(robot) + "\n");
    if (cli::interrupted() != 0) return std::nullopt;
    if (answer.status == 0) return scored(options.program, robot, answer.output);
    status = answer.status;
    if (is_refusal(status))
      throw error(Failure::data, "'{}' ended with status {} for robot {}", options.program, status,
                  robot.id);
  }
  return robot.failed(
      {fmt::format("its program ended with status {}, {} times", status, options.tries)});
}

int score_all(const cli::Command& command, const Options& options,
              const std::vector<Robot>& robots) {
  cli::catch_interrupts();
  const cli::Journal journal(options.journal);
  RobotWriter out(command.output);
  for (const Robot& robot : robots) {
    // A survivor has its fitness already, or is known to have none.
    if (robot.fitness() || robot.failure()) {
      out.write(robot);
      continue;
    }
    journal.take(robot.id);
    if (const auto machine = options.give_up ? journal.killed_on(robot.id) : std::nullopt) {
      journal.ended(robot.id);
      out.write(robot.failed({fmt::format("its program was killed on {}", *machine)}));
      continue;
    }
    journal.begun(robot.id);
    const double began = cli::seconds_since_1970();
    std::optional<Robot> result;
    try {
      result = score(options, robot);
    } catch (...) {
      journal.ended(robot.id);
      throw;
    }
    journal.add(robot.id, {began, cli::seconds_since_1970() - began, 0, result.has_value()});
    journal.ended(robot.id);
    if (!result) return 128 + cli::interrupted();
    out.write(*result);
  }
  out.finish();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-score");
  Options options;
  std::vector<std::string> files;
  command.arguments(files, "FILE", "robots [standard input]");
  command
      .option("--by", options.program, "PROGRAM",
              "a command line of bash; it reads a robot, one line of JSON, and writes it with "
              "its `fitness` (a number, or null: it has failed)")
      .required();
  command
      .option("--tries", options.tries, "N",
              "how often it may end with an error before the robot counts as failed")
      .at_least(1);
  command.option("--pick", options.pick, "K", cli::pick_help);
  command.option("--journal", options.journal, "DIR",
                 "keep there which robots are being scored on which machine, and what each took");
  command.flag("--give-up", options.give_up,
               "a robot whose program was killed, as its journal says, counts as failed");
  command.output_option("where the robots go; those that have a fitness go as they are");
  command.example("evo-sample -n 8 | evo-score --by 'jq -c \".fitness = (.body | length)\"'",
                  "robots by the number of their rows");
  command.example("evo-score --by 'python3 my-fitness.py' --pick 3 population.jsonl -o 03.json",
                  "the fourth robot of a population, by a program in Python");

  return command.run(argc, argv, [&] {
    command.only(options.journal.has_value(), {"--give-up"}, "--journal");
    return score_all(command, options, cli::pick(cli::read_robots(files), options.pick));
  });
}
