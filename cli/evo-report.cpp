// evo-report: one page about a run, or several side by side.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <optional>

#include "cli/command.h"
#include "formats/io/files.h"
#include "formats/run/run.h"
#include "render/report/page.h"
#include "render/report/run.h"

namespace {

using namespace evo;

constexpr std::size_t most_robots = 4000;   // of several runs, one by one
constexpr std::size_t fewest_robots = 100;  // of each of them
constexpr std::size_t most_replays = 1500;  // of several runs, episodes to play
constexpr std::size_t fewest_replays = 20;

// ---- a table instead of a page -----------------------------------------------------------

// Runs of one method on one task, as far as the shortest of them has come.
struct Group {
  std::string task;
  std::string method;
  std::vector<std::vector<double>> best;  // so far, robot by robot, of each run
};

std::vector<double> best_so_far(const RunHistory& history) {
  std::vector<double> curve;
  double best = -std::numeric_limits<double>::infinity();
  for (const TrainedRobot& trained : history.robots())
    curve.push_back(best = std::max(best, trained.fitness.value_or(best)));
  return curve;
}

std::vector<Group> read_groups(const std::vector<std::string>& folders) {
  std::vector<Group> groups;
  for (const std::string& folder : folders) {
    const RunHistory history{RunFolder(folder)};
    const RunSettings& settings = history.folder().settings();
    Group group{settings.is_evaluated() ? settings.scored_by() : task_label(settings.scored_by()),
                settings.text("method"),
                {}};
    const auto same = [&](const Group& other) {
      return other.task == group.task && other.method == group.method;
    };
    auto found = std::find_if(groups.begin(), groups.end(), same);
    if (found == groups.end()) found = groups.insert(groups.end(), group);
    found->best.push_back(best_so_far(history));
  }
  return groups;
}

// Task by task, the method with the highest mean first.
std::string table_of(const std::vector<std::string>& folders) {
  struct Row {
    std::string task;
    double mean = 0.0;
    std::string text;
  };
  std::vector<Row> rows;
  for (const Group& group : read_groups(folders)) {
    std::size_t robots = group.best.front().size();
    for (const auto& curve : group.best) robots = std::min(robots, curve.size());
    if (robots == 0) continue;
    std::vector<double> ends;
    for (const auto& curve : group.best) ends.push_back(curve[robots - 1]);
    std::sort(ends.begin(), ends.end());
    const auto count = static_cast<double>(ends.size());
    const double mean = std::accumulate(ends.begin(), ends.end(), 0.0) / count;
    double squares = 0.0;
    for (const double end : ends) squares += (end - mean) * (end - mean);
    const double deviation = ends.size() < 2 ? 0.0 : std::sqrt(squares / (count - 1.0));
    const double median = (ends[ends.size() / 2] + ends[(ends.size() - 1) / 2]) / 2.0;
    rows.push_back({group.task, mean,
                    fmt::format("{}\t{}\t{}\t{}\t{:.4f}\t{:.4f}\t{:.4f}\t{:.4f}\t{:.4f}",
                                group.task, group.method, ends.size(), robots, mean, deviation,
                                ends.front(), median, ends.back())});
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return a.task != b.task ? a.task < b.task : a.mean > b.mean;
  });
  std::string table = "task\tmethod\truns\trobots\tmean\tsd\tmin\tmedian\tmax";
  for (const Row& row : rows) table += "\n" + row.text;
  return table;
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-report");
  std::vector<std::string> names;
  std::optional<int> robots;
  bool table = false;
  command.arguments(names, "RUN_DIR",
                    "run folders, finished or not; several are compared on one page");
  command.flag("--table", table,
               "instead of a page, a line for each task and method: the best fitness of runs at "
               "equal numbers of robots, the best method first");
  command
      .option("--robots", robots, "N",
              "robots of a run to show one by one: all if there are no more, else the fittest, the "
              "champion's ancestors, and others evenly spread [1500; 4000 for several runs]")
      .at_least(1);
  command.output_option("where the page goes, HTML that needs no other file and no network");
  command.jobs_option();
  command.example("evo-report runs/walker -o report.html", "one run, at any time");
  command.example("evo-report runs/ga-* runs/bo-* -o methods.html",
                  "methods compared; runs that differ in the seed only are averaged");

  return command.run(argc, argv, [&] {
    if (names.empty()) throw error(Failure::usage, "name at least one run folder");
    if (table) {
      LineWriter out(command.output);
      out.line(table_of(names));
      out.finish();
      return 0;
    }
    report::Extent extent;
    if (names.size() > 1) extent.replays = std::max(fewest_replays, most_replays / names.size());
    extent.robots =
        robots ? static_cast<std::size_t>(*robots)
               : std::min(extent.robots, std::max(fewest_robots, most_robots / names.size()));
    const std::vector<std::filesystem::path> folders(names.begin(), names.end());
    std::vector<report::Run> runs;
    runs.reserve(folders.size());
    for (const auto& folder : folders)
      runs.push_back(report::read_run(folder, extent, command.jobs));
    report::tell_apart(runs, folders);
    LineWriter out(command.output);
    out.line(report::make_page(runs, cli::created_by(command.name())));
    out.finish();
    return 0;
  });
}
