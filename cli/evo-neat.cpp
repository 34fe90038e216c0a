// evo-neat: the next population of CPPN genomes.
#include <limits>
#include <map>
#include <utility>

#include "cli/command.h"
#include "cli/data.h"
#include "cli/outputs.h"
#include "cli/robots.h"
#include "formats/io/values.h"
#include "formats/robot/children.h"
#include "formats/robot/genome.h"
#include "formats/robot/writer.h"
#include "formats/run/neat.h"
#include "libevo/evolve/cppn_neat.h"

namespace {

using namespace evo;

struct Parents {
  std::vector<Scored> scored;
  std::map<int, std::string> ids;  // of robots, by genome key
};

Parents read_parents(const std::vector<Robot>& robots) {
  Parents parents;
  for (const Robot& robot : robots) {
    const auto genome = genome_of(robot, "robot " + robot.id);
    if (!genome)
      throw error(Failure::data,
                  "robot {} has no genome; only robots of evo-neat can continue in it", robot.id);
    parents.ids[genome->key] = robot.id;
    parents.scored.push_back(
        {*genome, robot.fitness().value_or(std::numeric_limits<double>::quiet_NaN())});
  }
  return parents;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-neat");
  std::optional<int> count;
  std::string shape_text = "5x5";
  std::optional<std::string> state_in;
  std::string state_out;
  std::optional<std::string> settings_file;
  std::vector<std::string> avoid;
  std::vector<std::string> files;
  command.arguments(files, "FILE",
                    "the scored population [standard input]; not read without "
                    "--state-in");
  command
      .option("-n,--count", count, "N",
              fmt::format("population size [pop_size of --neat, else {}]", default_population))
      .at_least(2);
  const cli::Option first_shape = command.option("--shape", shape_text, "ROWSxCOLS",
                                                 "of the first population's bodies, in voxels");
  command
      .option("--state-in", state_in, "FILE",
              "species of the population read; without it, a first population is made")
      .excludes({first_shape});
  command.option("--state-out", state_out, "FILE", "where the species of the new one go; required")
      .required();
  command.option("--neat", settings_file, "FILE",
                 "settings of NEAT, or FILE.cfg in neat-python's own form [tasks/neat.yaml]");
  command.option("--avoid", avoid, "FILE", "robots or ids that must not come again (repeatable)");
  command.seed_option();
  command.output_option("where the new population goes");
  command.example("evo-neat -n 25 --seed 1 --state-out old.json -o population.jsonl",
                  "a first population and its species");
  command.example("evo-neat -n 25 --seed 2 --state-in old.json --state-out new.json scores.jsonl",
                  "the population after the scored one");

  return command.run(argc, argv, [&] {
    cli::check_outputs({{"--output", command.output}, {"--state-out", state_out}});
    const NeatSettings settings = neat_settings(settings_file, count, cli::data_folders());
    std::set<std::string> seen = cli::read_ids(avoid);
    NeatState state;
    Parents parents;
    std::vector<CppnRobot> made;
    if (!state_in && !files.empty())
      throw error(Failure::usage, "{}: a scored population goes with --state-in", files.front());
    if (state_in) {
      const std::vector<Robot> robots = cli::read_robots(files);
      if (robots.empty()) throw error(Failure::data, "no scored robots were read");
      for (const Robot& robot : robots) seen.insert(robot.id);
      parents = read_parents(robots);
      state = load_neat_state(*state_in);
      const Body& body = robots.front().body;
      made = next_robots(settings, body.rows, body.cols, parents.scored, seen, state, command.seed);
    } else {
      const Shape shape = parse_shape(shape_text);
      made = first_robots(settings, shape.rows, shape.cols, seen, state, command.seed);
    }
    // The state first: where the population is, its species are, too.
    write_file(state_out, neat_state_to_text(state));
    RobotWriter out(command.output);
    int index = 0;
    for (const CppnRobot& robot : made) {
      std::vector<std::string> ids;
      for (const int key : robot.parents) ids.push_back(parents.ids.at(key));
      out.write(
          robot_of({robot.body, "evo-neat", std::move(ids), robot.genome}, command.seed, index++));
    }
    out.finish();
    return 0;
  });
}
