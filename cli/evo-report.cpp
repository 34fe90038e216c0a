// evo-report: one page about a run, or several side by side.
#include <algorithm>
#include <optional>

#include "cli/command.h"
#include "formats/io/files.h"
#include "render/report/page.h"
#include "render/report/run.h"

namespace {

using namespace evo;

constexpr std::size_t most_robots = 4000;   // of several runs, one by one
constexpr std::size_t fewest_robots = 100;  // of each of them
constexpr std::size_t most_replays = 1500;  // likewise
constexpr std::size_t fewest_replays = 20;

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-report");
  std::vector<std::string> names;
  report::PageOptions options;
  std::optional<int> robots;
  std::optional<int> replays;
  command.arguments(names, "RUN_DIR",
                    "run folders, finished or not; several are compared on one page");
  command.option("--title", options.title, "TEXT", "of the page [the task and the folder's name]");
  command
      .option("--robots", robots, "N",
              "robots of a run to show one by one: all if there are no more, else the fittest, the "
              "champion's ancestors, and others evenly spread [1500; 4000 for several runs]")
      .at_least(1);
  command
      .option("--replays", replays, "N",
              "episodes to play on the page: those of a run's N fittest robots, the champion and "
              "its ancestors [all robots shown; 1500 for several runs]")
      .at_least(0);
  command.output_option("where the page goes, HTML that needs no other file and no network");
  command.jobs_option();
  command.example("evo-report runs/walker -o report.html", "one run, at any time");
  command.example("evo-report runs/ga-* runs/bo-* -o methods.html",
                  "methods compared; runs that differ in the seed only are averaged");

  return command.run(argc, argv, [&] {
    if (names.empty()) throw error(Failure::usage, "name at least one run folder");
    report::Extent extent;
    if (replays)
      extent.replays = static_cast<std::size_t>(*replays);
    else if (names.size() > 1)
      extent.replays = std::max(fewest_replays, most_replays / names.size());
    extent.robots =
        robots ? static_cast<std::size_t>(*robots)
               : std::min(extent.robots, std::max(fewest_robots, most_robots / names.size()));
    const std::vector<std::filesystem::path> folders(names.begin(), names.end());
    std::vector<report::Run> runs;
    runs.reserve(folders.size());
    for (const auto& folder : folders)
      runs.push_back(report::read_run(folder, extent, command.jobs));
    report::tell_apart(runs, folders);
    options.generator = cli::created_by(command.name());
    LineWriter out(command.output);
    out.line(report::make_page(runs, options));
    out.finish();
    return 0;
  });
}
