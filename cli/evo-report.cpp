// evo-report: one page about a run, or several side by side.
#include <algorithm>
#include <filesystem>
#include <optional>

#include "cli/command.h"
#include "cli/terminal.h"
#include "formats/io/files.h"
#include "render/report/comparison.h"
#include "render/report/figures.h"
#include "render/report/page.h"
#include "render/report/run.h"
#include "render/scene/options.h"

namespace {

using namespace evo;

constexpr std::size_t most_robots = 4000;   // of several runs, one by one
constexpr std::size_t fewest_robots = 100;  // of each of them
constexpr std::size_t most_replays = 1500;  // of several runs, episodes to play
constexpr std::size_t fewest_replays = 20;

report::TableFormat table_format(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  if (ending == ".csv") return report::TableFormat::csv;
  if (ending == ".tex") return report::TableFormat::latex;
  if (file == standard_stream && cli::output_columns()) return report::TableFormat::text;
  if (ending == ".tsv" || file == standard_stream) return report::TableFormat::tsv;
  throw error(Failure::usage, "--table {}: expected a name that ends with .tsv, .csv or .tex, or -",
              file);
}

// Every figure of the runs as PDF, its numbers as CSV, and what to write below them.
void write_figures(const std::filesystem::path& folder, const std::vector<report::Run>& runs,
                   double width) {
  std::filesystem::create_directories(folder);
  render::Typesetter typesetter;
  std::string captions;
  const auto write = [&](const std::string& prefix, const report::FigureGroup& group,
                         const render::Figure& figure, const report::Run* run) {
    std::string name = prefix + figure.name;
    std::ranges::replace_if(
        name, [](char c) { return c == ' ' || c == '/'; }, '-');
    write_file(folder / (name + ".pdf"), report::figure_file(figure, width, "x.pdf", typesetter));
    write_file(folder / (name + ".csv"), report::figure_csv(figure, run));
    captions += fmt::format("{}.pdf\n{}\n\n", name, report::caption(group, figure));
  };
  if (runs.size() > 1)
    for (const auto& [task, group] : report::by_task(runs))
      write("", {}, report::comparison_figure(task, group), nullptr);
  for (const report::Run& run : runs) {
    if (!run.champion) continue;
    for (const report::FigureGroup& group : report::figures(run))
      for (const render::Figure& figure : group.figures)
        write(runs.size() > 1 ? run.label + "-" : "", group, figure, &run);
  }
  write_file(folder / "captions.txt", captions);
}

void write_chart(const std::string& file, const std::string& log, const std::string& band,
                 double width, const std::string& output) {
  render::Chart chart = report::chart_from_csv(read_file(file), log, band, file);
  render::Typesetter typesetter;
  const std::string title = fmt::format("{} against {}", chart.y, chart.x);
  write_file(output,
             report::figure_file({"", title, "", std::move(chart)}, width, output, typesetter));
}

}  // namespace

int main(int argc, char** argv) {
  cli::Command command("evo-report");
  std::vector<std::string> names;
  std::optional<int> robots;
  std::optional<std::string> table;
  std::optional<std::string> figures;
  std::optional<std::string> chart;
  std::string width = "85mm";
  std::string log;
  std::string band = "range";
  command.arguments(names, "RUN_DIR",
                    "run folders, finished or not; several are compared on one page");
  command.option(
      "--table", table, "FILE",
      "instead of a page what it says of tasks and methods, as .tsv (also by -, but on a "
      "terminal to be read), .csv or .tex: median best fitness, its interval, tests, the best "
      "method first");
  command.option("--figures", figures, "DIR",
                 "instead of a page its charts, each as .pdf and .csv, with captions.txt");
  command.option("--chart", chart, "FILE",
                 "instead of runs such a .csv: the chart of its lines, as .svg or .pdf");
  command.option("--width", width, "LENGTH", "of charts in files: 85mm, 17cm, 3.4in or 240pt");
  command.choice("--log", log, "AXES", {{"x", "x"}, {"y", "y"}, {"xy", "xy"}, {"none", ""}},
                 "of --chart, in powers of ten");
  command.option("--band", band, "NAME", "of --chart, what low and high are");
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

  command.example("evo-report runs/walker --figures figures", "its charts for a paper");

  return command.run(argc, argv, [&] {
    command.only(chart.has_value(), {"--log", "--band"}, "--chart");
    command.only(chart || figures, {"--width"}, "--chart and --figures");
    const double pixels = render::pixels_of(width);
    if (chart) {
      write_chart(*chart, log, band, pixels, command.output);
      return 0;
    }
    if (names.empty()) throw error(Failure::usage, "name at least one run folder");
    const std::vector<std::filesystem::path> folders(names.begin(), names.end());
    std::vector<report::Run> runs;
    runs.reserve(folders.size());
    const auto read = [&](const report::Extent& extent) {
      for (const auto& folder : folders)
        runs.push_back(report::read_run(folder, extent, command.jobs));
      report::tell_apart(runs, folders);
    };
    if (table) {
      const report::TableFormat format = table_format(*table);
      read({.robots = 0, .replays = 0});
      write_output(*table, report::comparison_table(runs, format) + "\n");
      return 0;
    }
    report::Extent extent;
    if (names.size() > 1) extent.replays = std::max(fewest_replays, most_replays / names.size());
    extent.robots =
        robots ? static_cast<std::size_t>(*robots)
               : std::min(extent.robots, std::max(fewest_robots, most_robots / names.size()));
    if (figures) extent.replays = 0;
    read(extent);
    if (figures) {
      write_figures(*figures, runs, pixels);
      return 0;
    }
    write_output(command.output, report::make_page(runs, cli::created_by(command.name())) + "\n");
    return 0;
  });
}
