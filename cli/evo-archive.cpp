// evo-archive: the fittest robot of every kind there is (MAP-Elites).
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/command.h"
#include "cli/robots.h"
#include "cli/values.h"
#include "libevo/evolve/archive.h"

namespace {

using namespace evo;

// NAME:BINS, or NAME:BINS:LOW:HIGH for numbers of the document.
FeatureAxis parse_axis(const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ':')
      words.emplace_back();
    else
      words.back() += c;
  }
  if ((words.size() != 2 && words.size() != 4) || words[0].empty())
    throw error(Failure::usage, "--features: '{}' is neither NAME:BINS nor NAME:BINS:LOW:HIGH",
                text);
  FeatureAxis axis;
  axis.name = words[0];
  axis.bins = static_cast<int>(cli::parse_whole(words[1], "--features", 1, 1'000'000));
  if (words.size() == 4) {
    axis.low = cli::parse_number(words[2], "--features");
    axis.high = cli::parse_number(words[3], "--features");
  } else if (const auto& known = body_features();
             std::find(known.begin(), known.end(), axis.name) == known.end()) {
    throw error(Failure::usage,
                "--features: '{}' is no feature of bodies{}; a number of the documents needs its "
                "range, {}:LOW:HIGH",
                axis.name, did_you_mean(axis.name, known), text);
  }
  return axis;
}

GridArchive parse_archive(const std::string& list) {
  std::vector<FeatureAxis> axes;
  for (const std::string& text : cli::split_list(list)) axes.push_back(parse_axis(text));
  return GridArchive(std::move(axes));
}

double feature(const Robot& robot, const std::string& name) {
  if (const auto value = body_feature(robot.body, name)) return *value;
  return cli::number_of(robot, name).value_or(std::numeric_limits<double>::quiet_NaN());
}

void fill(GridArchive& archive, const std::vector<Robot>& robots) {
  std::vector<bool> known(archive.axes().size(), robots.empty());
  for (std::size_t i = 0; i < robots.size(); ++i) {
    std::vector<double> features;
    for (std::size_t k = 0; k < archive.axes().size(); ++k) {
      features.push_back(feature(robots[i], archive.axes()[k].name));
      known[k] = known[k] || !std::isnan(features.back());
    }
    archive.add(i, features,
                robots[i].fitness().value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  for (std::size_t k = 0; k < known.size(); ++k)
    if (!known[k]) throw error(Failure::data, "no robot has a number '{}'", archive.axes()[k].name);
}

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
  cli::Command command("evo-archive", "the fittest robot of every kind (MAP-Elites)");
  std::vector<std::string> files;
  std::string features = "filled:5,actuated:5";
  bool table = false;
  command.arguments(files, "FILE", "scored robots [standard input]");
  command.option("--features", features, "LIST",
                 "axes of the grid: NAME:BINS for features of the body (" +
                     fmt::format("{}", fmt::join(body_features(), ", ")) +
                     "), NAME:BINS:LOW:HIGH for numbers of the documents, such as final.mean");
  command.flag("--table", table, "the map as a table, in place of the robots");
  command.output_option("where the elites go, by cells, one JSON document per line");
  command.example("evo-archive runs/walker/history.jsonl | evo-mutate -n 25 --seed 3",
                  "children of robots that are good in their own way");
  command.example("evo-archive --features feet:3,height:5 --table history.jsonl",
                  "how good robots with one, two or three feet became");

  return command.run(argc, argv, [&] {
    GridArchive archive = parse_archive(features);
    const std::vector<Robot> robots = cli::read_robots(files);
    fill(archive, robots);
    if (table) {
      print_table(archive, robots, command.output);
    } else {
      cli::RobotWriter out(command.output);
      for (const auto& [cell, elite] : archive.elites()) {
        Robot robot = robots[elite.individual];
        robot.document["cell"] = cell;
        out.write(std::move(robot));
      }
      out.finish();
    }
    command.note(
        fmt::format("{} of {} cells have an elite", archive.elites().size(), archive.cells()));
    return 0;
  });
}
