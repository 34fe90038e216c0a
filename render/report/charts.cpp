#include "render/report/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "formats/io/values.h"
#include "formats/robot/archive.h"
#include "libevo/base/error.h"
#include "render/report/choice.h"
#include "render/report/comparison.h"
#include "render/scene/round_numbers.h"

namespace evo::report {
namespace {

using render::Chart;
using render::ColorTable;
using render::Figure;
using render::Series;
using Look = Series::Look;
using Point = Series::Point;

constexpr std::size_t many = 400;  // robots whose lines would be a thicket

// A chart's colours, in chart_color().
constexpr std::size_t accent = 0;
constexpr std::size_t plain = 1;
constexpr std::size_t other = 2;
constexpr std::size_t grey = 7;

Point at(double x, double value, std::size_t robot = render::no_robot) {
  return {x, value, value, value, robot};
}

// What a chart shows of the robots, `all` of them or some.
std::string points_of(const Run& run, const std::string& all) {
  if (run.shown.size() == run.robots.size()) return all;
  return fmt::format("{} {} of {} robots are shown.", all,
                     grouped(static_cast<long long>(run.shown.size())),
                     grouped(static_cast<long long>(run.robots.size())));
}

FigureGroup alone(std::string id, Figure figure) { return {std::move(id), "", "", {figure}}; }

std::string robots_done(const Run& run) { return fmt::format("robots {}", run.done()); }

// ---- curves of a run ----------------------------------------------------------------------

Figure curve(const Run& run) {
  Series best{"best so far", Look::step, accent};
  Series robots{"each robot", Look::points, plain};
  const std::vector<double> so_far = best_so_far(run.robots);
  for (const std::size_t k : run.shown) {
    const auto x = static_cast<double>(k + 1);
    if (!std::isnan(so_far[k])) best.points.push_back(at(x, so_far[k]));
    if (const auto& fitness = run.robots[k].fitness) robots.points.push_back(at(x, *fitness, k));
  }
  return {"fitness-by-robots", fmt::format("Fitness by robots {}", run.done()),
          points_of(run, "The best fitness so far, and that of each robot."),
          Chart{robots_done(run), "fitness", true, {robots, best}}};
}

Point median_and_quartiles(double x, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {x, quantile(values, 0.5), quantile(values, 0.25), quantile(values, 0.75)};
}

Figure generations(const Run& run) {
  Series so_far{"best so far", Look::thick, accent};
  Series best{"best", Look::line, plain};
  Series middle{"median of new ones", Look::line, other, "quartiles"};
  std::optional<double> highest_yet;
  for (const Generation& generation : run.generations) {
    const auto highest = generation.best();
    if (!highest) continue;
    highest_yet = std::max(highest_yet, highest);
    so_far.points.push_back(at(generation.number, *highest_yet));
    best.points.push_back(at(generation.number, *highest));
    std::vector<double> fresh;
    for (std::size_t place = 0; place < generation.members.size(); ++place)
      if (const auto& score = generation.scores[place];
          score && run.robots[generation.members[place]].generation == generation.number)
        fresh.push_back(*score);
    if (!fresh.empty())
      middle.points.push_back(median_and_quartiles(generation.number, std::move(fresh)));
  }
  return {"fitness-by-generation", "Fitness by generation",
          "Best over all robots of the generation; the median over those that were new in it, with "
          "its quartiles.",
          Chart{"generation", "fitness", true, {so_far, best, middle}}};
}

Series champion_series(const Run& run, double x) {
  return {"champion", Look::champion, accent,
          "",         false,          {at(x, *run.robots[*run.champion].fitness, *run.champion)}};
}

// ---- trainings ------------------------------------------------------------------------------

std::optional<Figure> learning(const Run& run) {
  Series robots{"robots", Look::curves, grey};
  Series champion{"champion", Look::line, accent};
  std::vector<std::size_t> trained;
  for (const std::size_t k : ranked(run))
    if (!run.robots[k].training.curve.empty()) trained.push_back(k);
  if (trained.empty()) return std::nullopt;
  const std::size_t every = 1 + trained.size() / many;
  for (std::size_t place = 0; place < trained.size(); ++place) {
    const std::size_t k = trained[place];
    if (k != run.champion && place % every != 0) continue;
    for (const CurvePoint& point : run.robots[k].training.curve)
      if (std::isfinite(point.evaluation))
        (k == run.champion ? champion : robots)
            .points.push_back(at(static_cast<double>(point.step), point.evaluation, k));
  }
  const std::string about = run.shared.empty()
                                ? "Returns of every robot's evaluations during its training."
                                : "Returns of robots that had trainings of their own.";
  return Figure{
      "learning-curves", "Learning curves",
      every > 1 ? about + fmt::format(" One of {} is shown.", every) : points_of(run, about),
      Chart{"training steps", "return", true, {robots, champion}}};
}

FigureGroup controller(const Run& run) {
  FigureGroup group{
      "controller",
      "The controller of all robots",
      "The mean return over all robots of a generation while one controller learnt on "
      "them, and that of the best robot at its end. Where a generation begins the "
      "mean changes with the robots; training continues from the controller of the one "
      "before.",
      {}};
  constexpr const char* steps = "steps of all robots";
  Series mean{"mean", Look::line, plain};
  Series best{"best robot", Look::points, accent};
  std::map<std::string, Series> logged;
  double begin = 0.0;
  for (const SharedTraining& shared : run.shared) {
    for (const CurvePoint& point : shared.training.curve)
      mean.points.push_back(at(begin + static_cast<double>(point.step), point.evaluation));
    for (const LogSeries& series : shared.training.log)
      for (const auto& [step, value] : series.points)
        logged.try_emplace(series.name, Series{"", Look::line, plain})
            .first->second.points.push_back(at(begin + step, value));
    begin += static_cast<double>(shared.training.steps);
    for (const Generation& generation : run.generations)
      if (const auto highest = generation.best(); highest && generation.number == shared.generation)
        best.points.push_back(at(begin, *highest));
  }
  group.figures.push_back({"controller", "return", "", Chart{steps, "return", true, {mean, best}}});
  for (auto& [name, series] : logged)
    group.figures.push_back({"controller-" + name, name, "", Chart{steps, name, true, {series}}});
  return group;
}

// ---- bodies -----------------------------------------------------------------------------------

struct Feature {
  const char* name;
  bool whole;
  std::function<double(const Body&)> of;
};

std::vector<Feature> features() {
  const auto share = [](Voxel kind) {
    return [kind](const Body& body) {
      return static_cast<double>(std::count(body.cells.begin(), body.cells.end(), kind)) /
             static_cast<double>(std::max(1, count_voxels(body)));
    };
  };
  return {{"voxels", true, [](const Body& body) { return count_voxels(body); }},
          {"actuators", true, [](const Body& body) { return count_actuators(body); }},
          {"share of rigid voxels", false, share(Voxel::rigid)},
          {"share of soft voxels", false, share(Voxel::soft)},
          {"share of horizontal actuators", false, share(Voxel::horizontal)},
          {"share of vertical actuators", false, share(Voxel::vertical)}};
}

FigureGroup bodies(const Run& run) {
  FigureGroup group{"body",
                    "Fitness and the body",
                    points_of(run, "Every robot a point, the darker the more of them lie there."),
                    {}};
  for (const Feature& feature : features()) {
    Series robots{"robots", Look::points, plain};
    for (const std::size_t k : run.shown)
      if (const Entry& entry = run.robots[k]; entry.fitness)
        robots.points.push_back(at(feature.of(entry.robot.body), *entry.fitness, k));
    const double best = feature.of(run.robots[*run.champion].robot.body);
    group.figures.push_back(
        {fmt::format("fitness-by-{}", feature.name), feature.name, "",
         Chart{feature.name, "fitness", feature.whole, {robots, champion_series(run, best)}}});
  }
  return group;
}

Figure tree(const Run& run) {
  Series robots{"robots", Look::points, plain};
  std::map<std::size_t, Point> places;
  std::set<std::string> parents;
  for (const Entry& entry : run.robots)
    for (const std::string& id : entry.robot.parents()) parents.insert(id);
  const std::vector<std::size_t> line = lineage(run.robots, run.by_id, *run.champion);
  const bool thinned = run.shown.size() > many;
  // Within its generation, robots stand in the order they were trained.
  std::map<int, int> size;
  std::map<int, int> place;
  for (const Entry& entry : run.robots) ++size[entry.generation];
  for (std::size_t k = 0; k < run.robots.size(); ++k) {
    const Entry& entry = run.robots[k];
    constexpr double width = 0.6;  // of the distance between generations
    const double share =
        size[entry.generation] > 1
            ? static_cast<double>(place[entry.generation]++) / (size[entry.generation] - 1) - 0.5
            : 0.0;
    const bool kept = !thinned || k == run.champion || parents.contains(entry.robot.id);
    if (!entry.fitness || !run.shows(k) || !kept) continue;
    robots.points.push_back(at(entry.generation + width * share, *entry.fitness, k));
    places[k] = robots.points.back();
  }
  Chart chart{"generation", "fitness", true};
  for (const auto& [k, point] : places)
    for (const std::string& id : run.robots[k].robot.parents()) {
      const auto from = run.by_id.find(id);
      if (from == run.by_id.end() || !places.contains(from->second)) continue;
      const auto child = std::find(line.begin(), line.end(), k);
      const bool descent =
          child != line.end() && child != line.begin() && *(child - 1) == from->second;
      chart.links.push_back({places.at(from->second), point, descent});
    }
  chart.series = {robots, champion_series(run, places.at(*run.champion).x)};
  return {"family-tree", "Family tree",
          thinned
              ? "Robots that have children, with lines from their parents; the champion's line "
                "of descent is drawn thick."
              : "Every robot where it was new, with lines from its parents; the champion's line "
                "of descent is drawn thick.",
          std::move(chart)};
}

// ---- tables of colours --------------------------------------------------------------------------

ColorTable::Cell cell_of(const Run& run, std::size_t k, bool with_body) {
  const Entry& entry = run.robots[k];
  return {*entry.fitness, run.shows(k) ? k : render::no_robot,
          with_body ? &entry.robot.body : nullptr};
}

Figure looked(const Run& run) {
  std::map<std::pair<int, int>, std::size_t> best;  // robots by actuators and voxels
  int fewest = std::numeric_limits<int>::max(), most = 0, lowest = fewest, highest = 0;
  for (const std::size_t k : ranked(run)) {
    if (!run.robots[k].fitness) break;
    const int voxels = count_voxels(run.robots[k].robot.body);
    const int actuators = count_actuators(run.robots[k].robot.body);
    fewest = std::min(fewest, voxels);
    most = std::max(most, voxels);
    lowest = std::min(lowest, actuators);
    highest = std::max(highest, actuators);
    best.try_emplace({actuators, voxels}, k);
  }
  ColorTable table{"voxels", "actuators", "best fitness"};
  for (int voxels = fewest; voxels <= most; ++voxels)
    table.columns.push_back(fmt::to_string(voxels));
  for (int actuators = highest; actuators >= lowest; --actuators) {
    table.lines.push_back(fmt::to_string(actuators));
    auto& line = table.cells.emplace_back();
    for (int voxels = fewest; voxels <= most; ++voxels) {
      const auto there = best.find({actuators, voxels});
      line.push_back(there == best.end() ? ColorTable::Cell{} : cell_of(run, there->second, false));
    }
  }
  return {"coverage", "Where evolution looked",
          "The best fitness of all robots with so many voxels and actuators.", std::move(table)};
}

FigureGroup voxels(const Run& run) {
  constexpr std::size_t fewest = 3;  // robots, for a median worth showing
  FigureGroup group{"voxels",
                    "Which voxels matter",
                    "For every place of the body: the median fitness of robots with such a voxel "
                    "there, less the median of all; the number is how many robots that are; "
                    "where they are fewer than three, nothing is shown.",
                    {}};
  std::vector<const Entry*> scored;
  std::vector<double> all;
  for (const Entry& entry : run.robots)
    if (entry.fitness) {
      scored.push_back(&entry);
      all.push_back(*entry.fitness);
    }
  const double middle = median(all);
  const Body& first = scored.front()->robot.body;
  for (const Entry* entry : scored)
    if (entry->robot.body.rows != first.rows || entry->robot.body.cols != first.cols) return group;
  double widest = 0;
  for (const Voxel kind :
       {Voxel::empty, Voxel::rigid, Voxel::soft, Voxel::horizontal, Voxel::vertical}) {
    ColorTable table{"column", "row", "difference in fitness"};
    table.diverging = true;
    for (int col = 0; col < first.cols; ++col) table.columns.push_back(fmt::to_string(col + 1));
    for (int row = 0; row < first.rows; ++row) {
      table.lines.push_back(fmt::to_string(row + 1));
      auto& line = table.cells.emplace_back();
      for (int col = 0; col < first.cols; ++col) {
        std::vector<double> such;
        for (const Entry* entry : scored)
          if (entry->robot.body.at(row, col) == kind) such.push_back(*entry->fitness);
        ColorTable::Cell& cell = line.emplace_back();
        if (!such.empty()) cell.says = fmt::to_string(such.size());
        if (such.size() < fewest) continue;
        cell.value = median(such) - middle;
        widest = std::max(widest, std::abs(cell.value));
      }
    }
    group.figures.push_back(
        {fmt::format("voxels-{}", kind_name(kind)), kind_name(kind), "", std::move(table)});
  }
  // One scale for all.
  for (Figure& figure : group.figures) std::get<ColorTable>(figure.content).widest = widest;
  if (widest == 0) group.figures.clear();
  return group;
}

// ---- the archive ------------------------------------------------------------------------

// Around and between its bins.
std::vector<std::string> ends(const FeatureAxis& axis) {
  const double bin = (axis.high - axis.low) / axis.bins;
  std::vector<std::string> names;
  for (int k = 0; k <= axis.bins; ++k)
    names.push_back(render::axis_number(axis.low + bin * k, std::min(0.1, bin)));
  return names;
}

Figure elites(const Run& run, const GridArchive& grid) {
  const FeatureAxis across = grid.axes()[0];
  const bool flat = grid.axes().size() == 1;
  const FeatureAxis up = flat ? FeatureAxis{"", 1, 0.0, 1.0} : grid.axes()[1];
  ColorTable table{feature_title(across.name), flat ? "" : feature_title(up.name), "best fitness",
                   ends(across)};
  if (!flat) {
    table.lines = ends(up);
    std::reverse(table.lines.begin(), table.lines.end());
  }
  const auto count = [](int bins) { return static_cast<std::size_t>(bins); };
  table.cells.assign(count(up.bins), std::vector<ColorTable::Cell>(count(across.bins)));
  for (const auto& [place, elite] : grid.elites()) {
    ColorTable::Cell& cell = table.cells[flat ? 0 : count(up.bins - 1 - place[1])][count(place[0])];
    if (std::isnan(cell.value) || elite.fitness > cell.value)
      cell = cell_of(run, elite.individual, true);
  }
  return {"archive", "Elites",
          fmt::format("The fittest robot of every kind{}; what lies beyond an end counts to the "
                      "cell there.",
                      grid.axes().size() > 2 ? ", by the archive's first two axes" : ""),
          std::move(table)};
}

FigureGroup archive(const Run& run) {
  constexpr int finest = 60;  // bins of an axis that can be seen
  FigureGroup group{"archive", "The archive", "", {}};
  const std::string axes = run.setting("features");
  if (axes.empty()) return group;
  try {
    GridArchive grid = parse_archive(axes, "features");
    Series coverage{"", Look::step, plain};
    Series score{"", Look::step, accent};
    const auto all = static_cast<double>(grid.cells());
    double sum = 0;
    for (std::size_t k = 0; k < run.robots.size(); ++k) {
      const Entry& entry = run.robots[k];
      std::vector<double> values;
      for (const FeatureAxis& axis : grid.axes())
        values.push_back(feature_of(entry.robot, axis.name));
      const auto cell = grid.cell(values);
      if (!cell || !entry.fitness) continue;
      const auto before = grid.elites().find(*cell);
      const double gone = before == grid.elites().end() ? 0 : before->second.fitness;
      if (!grid.add(k, values, *entry.fitness)) continue;
      sum += *entry.fitness - gone;
      const auto x = static_cast<double>(k + 1);
      coverage.points.push_back(at(x, 100 * static_cast<double>(grid.elites().size()) / all));
      score.points.push_back(at(x, sum));
    }
    if (grid.elites().empty()) return group;
    const auto end = static_cast<double>(run.robots.size());
    for (Series* series : {&coverage, &score})
      series->points.push_back(at(end, series->points.back().value));
    group.about = fmt::format(
        "{} of {} cells have a robot, {:.0f} %. The QD score, the sum of their fitness, is {}.",
        grid.elites().size(), grid.cells(), coverage.points.back().value, run.text(sum));
    if (std::all_of(grid.axes().begin(), grid.axes().end(),
                    [](const FeatureAxis& axis) { return axis.bins <= finest; }))
      group.figures.push_back(elites(run, grid));
    group.figures.push_back({"archive-coverage", "Coverage", "Cells that have a robot.",
                             Chart{robots_done(run), "cells, %", true, {coverage}}});
    group.figures.push_back({"archive-score", "QD score", "The sum of the fitness of all elites.",
                             Chart{robots_done(run), "QD score", true, {score}}});
    return group;
  } catch (const Error& e) {
    throw error(Failure::data, "{}/run.yaml: {}", run.label, e.what());
  }
}

// ---- runs that are repetitions of each other ------------------------------------------

// Quartiles of few runs would be guesses: their range says all there is.
constexpr std::size_t few_runs = 8;

// The median of the runs' curves as far as all of them have come.
Series median_curve(const Repetitions& group, const std::map<const Run*, Series>& curves) {
  Series middle{fmt::format("{}, median of {}", group.label, group.runs.size()), Look::step, 0,
                group.runs.size() < few_runs ? "range" : "quartiles"};
  std::size_t length = std::numeric_limits<std::size_t>::max();
  for (const Run* run : group.runs) length = std::min(length, run->robots.size());
  for (std::size_t k = 0; k < length; ++k) {
    std::vector<double> values;
    for (const Run* run : group.runs)
      if (const double value = curves.at(run).points[k].value; !std::isnan(value))
        values.push_back(value);
    if (values.empty()) continue;
    Point point = median_and_quartiles(static_cast<double>(k + 1), values);
    if (values.size() < few_runs) {
      const auto [low, high] = std::minmax_element(values.begin(), values.end());
      point.low = *low;
      point.high = *high;
    }
    middle.points.push_back(point);
  }
  return middle;
}

// Every method has its own on every page; what is not known, or there twice, the next that is
// free.
std::vector<std::size_t> colors_of(const std::vector<Repetitions>& groups) {
  constexpr std::array known{"ga", "bo", "neat", "map", "race", "modular", "random"};
  constexpr std::size_t palette = 8;
  std::set<std::size_t> taken;
  std::vector<std::size_t> colors;
  for (const Repetitions& group : groups) {
    const auto method = std::find(known.begin(), known.end(), group.method);
    auto color = static_cast<std::size_t>(method - known.begin());
    // Round from those that are no method's.
    if (taken.contains(color)) color = known.size();
    while (taken.contains(color) && taken.size() < palette) color = (color + 1) % palette;
    taken.insert(color);
    colors.push_back(color);
  }
  return colors;
}

// Where a long curve steps or ends: the same picture.
void keep_steps(Series& series) {
  constexpr std::size_t all = 2000;
  auto& points = series.points;
  std::erase_if(points, [](const Point& point) { return std::isnan(point.value); });
  if (points.size() <= all) return;
  const auto same = [](const Point& a, const Point& b) {
    return a.value == b.value && a.low == b.low && a.high == b.high;
  };
  std::vector<Point> kept;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (k == 0 || k + 1 == points.size() || !same(points[k], points[k - 1]))
      kept.push_back(points[k]);
  points = std::move(kept);
}

}  // namespace

std::vector<FigureGroup> figures(const Run& run) {
  std::vector<FigureGroup> groups{alone("curve", curve(run)), archive(run),
                                  alone("generations", generations(run))};
  if (run.generations.size() < 2) groups.back().figures.clear();
  if (!run.shared.empty()) groups.push_back(controller(run));
  if (run.generations.size() > 1) groups.push_back(alone("tree", tree(run)));
  if (std::optional<Figure> curves = learning(run))
    groups.push_back(alone("learning", std::move(*curves)));
  groups.push_back(alone("maps", looked(run)));
  groups.push_back(bodies(run));
  groups.push_back(voxels(run));
  std::erase_if(groups, [](const FigureGroup& group) { return group.figures.empty(); });
  return groups;
}

Figure comparison_figure(const std::string& task, const std::vector<const Run*>& runs) {
  std::map<const Run*, Series> curves;
  for (const Run* run : runs) {
    Series& series = curves[run] = {run->label, Look::step};
    double x = 0;
    for (const double value : best_so_far(run->robots)) series.points.push_back(at(++x, value));
  }
  Chart chart{robots_done(*runs[0]), "best fitness so far", true};
  const std::vector<Repetitions> groups = repetitions(runs);
  const std::vector<std::size_t> colors = colors_of(groups);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const bool several = groups[g].runs.size() > 1;
    if (several) chart.series.push_back(median_curve(groups[g], curves));
    if (several) chart.series.back().color = colors[g];
    for (const Run* run : groups[g].runs) {
      chart.series.push_back(std::move(curves[run]));
      chart.series.back().color = colors[g];
      chart.series.back().pale = several;
    }
  }
  for (Series& series : chart.series) keep_steps(series);
  return {"best-so-far-" + task, "Best fitness so far on " + task,
          "By robots. Runs that differ in nothing but their seed are one curve, their median with "
          "its range (quartiles of eight runs or more), as far as all of them have come; each is a "
          "pale line.",
          std::move(chart)};
}

}  // namespace evo::report
