// evo-mutate: children of the robots read.
#include <set>
#include <utility>

#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/robots.h"
#include "formats/robot/children.h"
#include "formats/robot/writer.h"

using namespace evo;

int main(int argc, char** argv) {
  cli::Command command("evo-mutate");
  Breeding breeding;
  std::optional<int> count;
  std::vector<std::string> avoid;
  std::vector<std::string> files;
  command.arguments(files, "FILE", "robots (JSON, JSON Lines, YAML, letters) [standard input]");
  command.option("-n,--count", count, "N", "children to make [as many as robots read]").at_least(0);
  command.option("--rate", breeding.mutation.rate, "P", "chance of each voxel to be redrawn");
  command.option("--attempts", breeding.mutation.attempts, "N",
                 "tries to reach a valid body, each continuing from the one before");
  command.option("--crossover", breeding.crossover, "P",
                 "chance of a child to mix two parents before it is mutated");
  command.option("--stiffness-sigma", breeding.mutation.stiffness_sigma, "S",
                 "every voxel becomes exp(S N(0, 1)) times as stiff, within 0.1 and 10");
  command.option("--avoid", avoid, "FILE", "robots or ids that must not come again (repeatable)");
  command.seed_option();
  command.output_option("where the children go, one JSON document per line");
  command.example("evo-sample -n 10 | evo-mutate -n 50 --seed 4", "fifty children of ten robots");
  command.example("evo-mutate best.json -n 3 --avoid history.jsonl",
                  "three bodies near the best that were never tried");

  return command.run(argc, argv, [&] {
    cli::keep_inputs(command.output, files);
    check(breeding);
    const std::vector<Robot> robots = cli::read_robots(files);
    const int children = count.value_or(static_cast<int>(robots.size()));
    if (robots.empty() && children > 0)
      throw error(Failure::data, "no robots to make children of; pipe some in or name a file");
    std::set<std::string> seen = cli::read_ids(avoid);
    for (const Robot& robot : robots) seen.insert(robot.id);
    RobotWriter out(command.output);
    std::vector<Body> bodies;
    bodies.reserve(robots.size());
    for (const Robot& robot : robots) bodies.push_back(robot.body);
    for (int i = 0; i < children; ++i) {
      Child child = breed_new(bodies, breeding, command.seed, i, seen);
      Proposal proposal{std::move(child.body), "evo-mutate"};
      for (const std::size_t parent : child.parents) proposal.parents.push_back(robots[parent].id);
      out.write(robot_of(std::move(proposal), command.seed, i));
    }
    out.finish();
    return 0;
  });
}
