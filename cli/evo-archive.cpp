// evo-archive: the fittest robot of every kind there is (MAP-Elites).
#include <fmt/ranges.h>

#include "cli/command.h"
#include "cli/outputs.h"
#include "cli/robots.h"
#include "formats/robot/archive.h"
#include "formats/robot/writer.h"

namespace {

using namespace evo;

// A row per cell that is taken: the lower ends of its bins, fitness, robot.
void print_table(const GridArchive& archive, const std::vector<Robot>& robots,
                 const std::string& output) {
  LineWriter out(output);
  std::string line;
  for (const FeatureAxis& axis : archive.axes()) line += axis.name + "\t";
  out.line(line + "fitness\trobot");
  for (const auto& [cell, elite] : archive.elites()) {
    line.clear();
    for (std::size_t k = 0; k < cell.size(); ++k) {
      const FeatureAxis& axis = archive.axes()[k];
      line += fmt::format("{}\t", axis.low + (axis.high - axis.low) * cell[k] / axis.bins);
    }
    out.line(line + fmt::format("{}\t{}", elite.fitness, robots[elite.individual].id));
  }
  out.finish();
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-archive");
  std::vector<std::string> files;
  std::string features = "filled:5,actuated:5";
  bool table = false;
  command.arguments(files, "FILE", "scored robots [standard input]");
  command.option(
      "--features", features, "LIST",
      "axes of the grid: NAME:BINS for features of the body (" +
          fmt::format("{}", fmt::join(body_features(), ", ")) +
          "), NAME:BINS:LOW:HIGH for how it behaved (behaviour.distance, behaviour.rise, "
          "behaviour.aloft, behaviour.width) and for numbers of the "
          "documents, such as final.mean");
  command.flag("--table", table, "the map as a table, in place of the robots");
  command.output_option("where the elites go, by cells, one JSON document per line");
  command.example("evo-archive runs/walker/history.jsonl | evo-mutate -n 25 --seed 3",
                  "children of robots that are good in their own way");
  command.example("evo-archive --features feet:3,height:5 --table history.jsonl",
                  "how good robots with one, two or three feet became");
  command.example("evo-archive --features feet:3,behaviour.distance:8:0:40 history.jsonl",
                  "the same by how far they came");

  return command.run(argc, argv, [&] {
    cli::keep_inputs(command.output, files);
    GridArchive archive = parse_archive(features, "--features");
    const std::vector<Robot> robots = cli::read_robots(files);
    fill(archive, robots);
    if (table) {
      print_table(archive, robots, command.output);
    } else {
      RobotWriter out(command.output);
      for (const auto& [cell, elite] : archive.elites()) {
        Robot robot = robots[elite.individual];
        robot.document["cell"] = cell;
        out.write(std::move(robot));
      }
      out.finish();
    }
    cli::log::info(
        fmt::format("{} of {} cells have an elite", archive.elites().size(), archive.cells()));
    return 0;
  });
}
