#include "render/report/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "formats/robot/archive.h"
#include "libevo/base/error.h"
#include "render/report/lineage.h"
#include "render/report/repetitions.h"
#include "render/report/statistics.h"

namespace evo::report {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

// A value with its spread.
struct Point {
  double low = nothing;
  double value = nothing;
  double high = nothing;

  Point() = default;
  explicit Point(double v) : low(v), value(v), high(v) {}
  Point(double l, double v, double h) : low(l), value(v), high(h) {}

  bool operator==(const Point& other) const {
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    return same(low, other.low) && same(value, other.value) && same(high, other.high);
  }
};

Json to_json(const Point& point) {
  if (std::isnan(point.value)) return {nullptr, nullptr, nullptr};
  return {point.low, point.value, point.high};
}

struct Chart {
  Json json;

  Chart(const std::string& x, const char* y, bool whole)
      : json({{"x", x},
              {"y", y},
              {"whole", whole},
              {"labels", Json::array({x})},
              {"series", Json::array()},
              {"rows", Json::array()}}) {}

  Json& series(const std::string& label, const char* kind, const char* band = nullptr) {
    json["labels"].push_back(label);
    Json look{{"kind", kind}};
    if (band != nullptr) look["band"] = band;
    return json["series"].emplace_back(std::move(look));
  }
  void row(double x, const std::vector<Point>& points) {
    Json cells = Json::array({x});
    for (const Point& point : points) cells.push_back(to_json(point));
    json["rows"].push_back(std::move(cells));
  }
};

// ---- statistics ---------------------------------------------------------------------

Point median_and_quartiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.25), quantile(values, 0.5), quantile(values, 0.75)};
}

// Of few runs quartiles would be guesses: their range says all there is.
constexpr std::size_t few_runs = 8;
Point median_and_range(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values.front(), quantile(values, 0.5), values.back()};
}

double better(double best, double value) { return std::isnan(best) || value > best ? value : best; }

// ---- runs that are repetitions of each other ------------------------------------------

// The median of the runs' curves as far as all of them have come.
std::vector<Point> median_curve(const Repetitions& group,
                                const std::map<const Run*, std::vector<double>>& curves) {
  std::size_t length = std::numeric_limits<std::size_t>::max();
  for (const Run* run : group.runs) length = std::min(length, curves.at(run).size());
  std::vector<Point> middle;
  for (std::size_t k = 0; k < length; ++k) {
    std::vector<double> values;
    for (const Run* run : group.runs)
      if (const double value = curves.at(run)[k]; !std::isnan(value)) values.push_back(value);
    middle.push_back(values.size() < few_runs
                         ? (values.empty() ? Point() : median_and_range(values))
                         : median_and_quartiles(values));
  }
  return middle;
}

// Of the palette in charts.js: every method has its own on every page; what is not known, or
// there twice, the next that is free.
std::vector<int> colors_of(const std::vector<Repetitions>& groups) {
  constexpr std::array known{"ga", "bo", "neat", "map", "race", "modular", "random"};
  constexpr int palette = 8;
  std::set<int> taken;
  std::vector<int> colors;
  for (const Repetitions& group : groups) {
    const auto method = std::find(known.begin(), known.end(), group.method);
    auto color = static_cast<int>(method - known.begin());
    // Round from those that are no method's.
    if (taken.contains(color)) color = static_cast<int>(known.size());
    while (taken.contains(color) && std::ssize(taken) < palette) color = (color + 1) % palette;
    taken.insert(color);
    colors.push_back(color);
  }
  return colors;
}

// ---- features of bodies ------------------------------------------------------------------

double share_of(const Body& body, Voxel kind) {
  return static_cast<double>(std::count(body.cells.begin(), body.cells.end(), kind)) /
         static_cast<double>(std::max(1, count_voxels(body)));
}

struct Feature {
  const char* name;
  bool whole;
  std::function<double(const Body&)> of;
};

std::vector<Feature> features() {
  const auto share = [](Voxel kind) {
    return [kind](const Body& body) { return share_of(body, kind); };
  };
  return {{"voxels", true, [](const Body& body) { return count_voxels(body); }},
          {"actuators", true, [](const Body& body) { return count_actuators(body); }},
          {"share of rigid voxels", false, share(Voxel::rigid)},
          {"share of soft voxels", false, share(Voxel::soft)},
          {"share of horizontal actuators", false, share(Voxel::horizontal)},
          {"share of vertical actuators", false, share(Voxel::vertical)}};
}

Json feature_chart(const Run& run, const Feature& feature) {
  std::vector<std::pair<double, const Entry*>> points;
  for (const std::size_t robot : run.shown)
    if (const Entry& entry = run.robots[robot]; entry.fitness)
      points.emplace_back(feature.of(entry.robot.body), &entry);
  std::stable_sort(points.begin(), points.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Chart chart(feature.name, "fitness", feature.whole);
  chart.series("robots", "points");
  chart.series("champion", "best");
  Json ids = Json::array();
  for (const auto& [x, entry] : points) {
    const bool is_champion = entry == &run.robots[*run.champion];
    chart.row(x, {Point(*entry->fitness), is_champion ? Point(*entry->fitness) : Point()});
    ids.push_back(entry->robot.id);
  }
  chart.json["robots"] = std::move(ids);
  return chart.json;
}

}  // namespace

Json progress_chart(const Run& run) {
  Chart chart(fmt::format("robots {}", run.done()), "fitness", true);
  chart.series("best so far", "step");
  chart.series("each robot", "points");
  Json ids = Json::array();
  const std::vector<double> best = best_so_far(run);
  for (const std::size_t k : run.shown) {
    chart.row(static_cast<double>(k + 1),
              {Point(best[k]), Point(run.robots[k].fitness.value_or(nothing))});
    ids.push_back(run.robots[k].robot.id);
  }
  chart.json["robots"] = std::move(ids);
  return chart.json;
}

Json generation_chart(const Run& run) {
  Chart chart("generation", "fitness", true);
  chart.series("best so far", "thick");
  chart.series("best", "line");
  chart.series("median of new ones", "line", "quartiles");
  double best = nothing;
  for (const Generation& generation : run.generations) {
    if (generation.members.empty()) continue;
    std::vector<double> fresh;
    double highest = nothing;
    for (std::size_t place = 0; place < generation.members.size(); ++place) {
      const auto& score = generation.scores[place];
      if (!score) continue;
      highest = better(highest, *score);
      if (run.robots[generation.members[place]].generation == generation.number)
        fresh.push_back(*score);
    }
    if (!std::isnan(highest)) best = better(best, highest);
    chart.row(generation.number, {Point(best), Point(highest), median_and_quartiles(fresh)});
  }
  return chart.json;
}

Json comparison_chart(const std::vector<const Run*>& runs) {
  Chart chart(fmt::format("robots {}", runs[0]->done()), "best fitness so far", true);
  std::map<const Run*, std::vector<double>> curves;
  std::size_t longest = 0;
  for (const Run* run : runs) longest = std::max(longest, (curves[run] = best_so_far(*run)).size());

  std::vector<std::vector<Point>> columns;
  const std::vector<Repetitions> groups = repetitions(runs);
  const std::vector<int> colors = colors_of(groups);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Repetitions& group = groups[g];
    if (group.runs.size() > 1) {
      chart.series(fmt::format("{}, median of {}", group.label, group.runs.size()), "step",
                   group.runs.size() < few_runs ? "range" : "quartiles")["color"] = colors[g];
      columns.push_back(median_curve(group, curves));
    }
    for (const Run* run : group.runs) {
      Json& look = chart.series(run->label, "step");
      look["color"] = colors[g];
      if (group.runs.size() > 1) look["off"] = look["thin"] = true;
      columns.emplace_back();
      for (const double value : curves[run]) columns.back().emplace_back(value);
    }
  }
  const auto points_at = [&](std::size_t k) {
    std::vector<Point> points;
    points.reserve(columns.size());
    for (const auto& column : columns) points.push_back(k < column.size() ? column[k] : Point());
    return points;
  };
  // Of long runs, where a curve steps or ends: the same picture.
  constexpr std::size_t all_rows = 2000;
  std::vector<Point> before;
  for (std::size_t k = 0; k < longest; ++k) {
    std::vector<Point> points = points_at(k);
    const bool steps = longest <= all_rows || k == 0 || k + 1 == longest || points != before ||
                       points_at(k + 1) != points;
    before = points;
    if (!steps) continue;
    chart.row(static_cast<double>(k + 1), points);
  }
  return chart.json;
}

Json learning_chart(const Run& run) {
  if (std::all_of(run.robots.begin(), run.robots.end(),
                  [](const Entry& entry) { return entry.training.curve.empty(); }))
    return nullptr;
  Chart chart("training steps", "return", true);
  chart.series("robots", "edges");
  chart.series("champion", "edges");
  chart.json["champion"] = run.robots[*run.champion].robot.id;
  return chart.json;
}

std::vector<FeatureChart> shared_charts(const Run& run) {
  std::vector<FeatureChart> charts;
  if (run.shared.empty()) return charts;
  constexpr const char* steps = "environment steps of all robots";
  Chart returns(steps, "return", true);
  returns.series("mean over all robots", "line");
  returns.series("best robot", "points");
  std::map<std::string, Chart> logged;
  double begin = 0.0;
  for (const SharedTraining& shared : run.shared) {
    for (const CurvePoint& point : shared.training.curve)
      returns.row(begin + static_cast<double>(point.step), {Point(point.evaluation), Point()});
    for (const LogSeries& series : shared.training.log) {
      Chart& chart =
          logged.try_emplace(series.name, steps, series.name.c_str(), true).first->second;
      if (chart.json["series"].empty()) chart.series(series.name, "line");
      for (const auto& [step, value] : series.points) chart.row(begin + step, {Point(value)});
    }
    begin += static_cast<double>(shared.training.steps);
    for (const Generation& generation : run.generations) {
      if (generation.number != shared.generation) continue;
      double best = nothing;
      for (const auto& score : generation.scores)
        if (score) best = better(best, *score);
      returns.row(begin, {Point(), Point(best)});
    }
  }
  charts.push_back({"return", std::move(returns.json)});
  for (auto& [name, chart] : logged) charts.push_back({name, std::move(chart.json)});
  return charts;
}

std::vector<FeatureChart> feature_charts(const Run& run) {
  std::vector<FeatureChart> charts;
  if (!run.champion) return charts;
  for (const Feature& feature : features())
    charts.push_back({feature.name, feature_chart(run, feature)});
  return charts;
}

Json tree_chart(const Run& run) {
  Chart chart("generation", "fitness", true);
  chart.series("robots", "points");
  chart.series("champion", "best");
  Json ids = Json::array();
  std::map<std::size_t, std::size_t> row_of;
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
    if (!entry.fitness || !run.shows(k)) continue;
    row_of[k] = ids.size();
    const bool is_champion = k == run.champion;
    chart.row(entry.generation + width * share,
              {Point(*entry.fitness), is_champion ? Point(*entry.fitness) : Point()});
    ids.push_back(entry.robot.id);
  }
  const std::vector<std::size_t> line = lineage(run, *run.champion);
  Json edges = Json::array();
  for (const auto& [k, row] : row_of)
    for (const std::string& id : run.robots[k].robot.parents()) {
      const auto from = run.by_id.find(id);
      if (from == run.by_id.end() || !row_of.contains(from->second)) continue;
      const auto child = std::find(line.begin(), line.end(), k);
      const bool descent =
          child != line.end() && child != line.begin() && *(child - 1) == from->second;
      edges.push_back({row_of[from->second], row, descent});
    }
  chart.json["robots"] = std::move(ids);
  chart.json["edges"] = std::move(edges);
  return chart.json;
}

Json coverage_chart(const Run& run) {
  std::map<std::pair<int, int>, std::size_t> best;  // robots by voxels and actuators
  int fewest = std::numeric_limits<int>::max(), most = 0, lowest = fewest, highest = 0;
  for (std::size_t k = 0; k < run.robots.size(); ++k) {
    const Entry& entry = run.robots[k];
    if (!entry.fitness) continue;
    const int voxels = count_voxels(entry.robot.body);
    const int actuators = count_actuators(entry.robot.body);
    fewest = std::min(fewest, voxels);
    most = std::max(most, voxels);
    lowest = std::min(lowest, actuators);
    highest = std::max(highest, actuators);
    const auto there = best.try_emplace({voxels, actuators}, k).first;
    if (*entry.fitness > *run.robots[there->second].fitness) there->second = k;
  }
  Json chart{{"kind", "heat"},          {"x", "voxels"},          {"y", "actuators"},
             {"value", "best fitness"}, {"diverging", false},     {"columns", Json::array()},
             {"lines", Json::array()},  {"cells", Json::array()}, {"robots", Json::array()}};
  for (int voxels = fewest; voxels <= most; ++voxels)
    chart["columns"].push_back(fmt::to_string(voxels));
  for (int actuators = highest; actuators >= lowest; --actuators) {
    chart["lines"].push_back(fmt::to_string(actuators));
    Json cells = Json::array();
    Json robots = Json::array();
    for (int voxels = fewest; voxels <= most; ++voxels) {
      const auto there = best.find({voxels, actuators});
      const Entry* entry = there == best.end() ? nullptr : &run.robots[there->second];
      cells.push_back(entry == nullptr ? Json() : Json(*entry->fitness));
      robots.push_back(entry == nullptr || !run.shows(there->second) ? Json()
                                                                     : Json(entry->robot.id));
    }
    chart["cells"].push_back(std::move(cells));
    chart["robots"].push_back(std::move(robots));
  }
  return chart;
}

namespace {

GridArchive archive_of(const Run& run, const std::string& features) {
  try {
    return parse_archive(features, "features");
  } catch (const Error& e) {
    throw error(Failure::data, "{}/run.yaml: {}", run.label, e.what());
  }
}

// Around and between its bins.
std::vector<double> ends(const FeatureAxis& axis) {
  std::vector<double> values;
  for (int k = 0; k <= axis.bins; ++k)
    values.push_back(axis.low + (axis.high - axis.low) * k / axis.bins);
  return values;
}

}  // namespace

Json archive_chart(const Run& run) {
  constexpr int finest = 60;  // bins of an axis
  const std::string features = run.setting("features");
  if (features.empty()) return nullptr;
  const GridArchive grid = archive_of(run, features);
  const FeatureAxis across = grid.axes()[0];
  const FeatureAxis up = grid.axes().size() > 1 ? grid.axes()[1] : FeatureAxis{"", 1, 0.0, 1.0};
  if (std::max(across.bins, up.bins) > finest) return nullptr;
  GridArchive shown(grid.axes().size() > 1 ? std::vector{across, up} : std::vector{across});
  for (std::size_t k = 0; k < run.robots.size(); ++k) {
    const Entry& entry = run.robots[k];
    std::vector<double> values;
    for (const FeatureAxis& axis : shown.axes())
      values.push_back(feature_of(entry.robot, axis.name));
    shown.add(k, values, entry.fitness.value_or(nothing));
  }
  Json chart{{"kind", "heat"},
             {"x", feature_title(across.name)},
             {"y", up.name.empty() ? "" : feature_title(up.name)},
             {"value", "best fitness"},
             {"diverging", false},
             {"ends", {ends(across), Json::array()}},
             {"cells", Json::array()},
             {"robots", Json::array()}};
  if (!up.name.empty()) {
    std::vector<double> from_the_top = ends(up);
    std::reverse(from_the_top.begin(), from_the_top.end());
    chart["ends"][1] = from_the_top;
  }
  for (int line = up.bins - 1; line >= 0; --line) {
    Json cells = Json::array();
    Json robots = Json::array();
    for (int column = 0; column < across.bins; ++column) {
      GridArchive::Cell cell{column};
      if (!up.name.empty()) cell.push_back(line);
      const auto there = shown.elites().find(cell);
      const bool taken = there != shown.elites().end();
      cells.push_back(taken ? Json(there->second.fitness) : Json());
      robots.push_back(taken && run.shows(there->second.individual)
                           ? Json(run.robots[there->second.individual].robot.id)
                           : Json());
    }
    chart["cells"].push_back(std::move(cells));
    chart["robots"].push_back(std::move(robots));
  }
  return chart;
}

std::vector<FeatureChart> position_charts(const Run& run) {
  constexpr std::size_t fewest = 3;  // robots, for a median worth showing
  std::vector<FeatureChart> charts;
  std::vector<const Entry*> scored;
  std::vector<double> all;
  for (const Entry& entry : run.robots)
    if (entry.fitness) {
      scored.push_back(&entry);
      all.push_back(*entry.fitness);
    }
  if (scored.empty()) return charts;
  const double middle = median(all);
  double widest = 0;
  const Body& first = scored.front()->robot.body;
  for (const Entry* entry : scored)
    if (entry->robot.body.rows != first.rows || entry->robot.body.cols != first.cols) return charts;
  for (const auto& [kind, name] : {std::pair{Voxel::empty, "empty"},
                                   {Voxel::rigid, "rigid"},
                                   {Voxel::soft, "soft"},
                                   {Voxel::horizontal, "horizontal"},
                                   {Voxel::vertical, "vertical"}}) {
    Json chart{{"kind", "heat"},
               {"x", "column"},
               {"y", "row"},
               {"value", "difference in fitness"},
               {"diverging", true},
               {"columns", Json::array()},
               {"lines", Json::array()},
               {"cells", Json::array()},
               {"counts", Json::array()}};
    for (int col = 0; col < first.cols; ++col) chart["columns"].push_back(fmt::to_string(col + 1));
    for (int row = 0; row < first.rows; ++row) {
      chart["lines"].push_back(fmt::to_string(row + 1));
      Json cells = Json::array();
      Json counts = Json::array();
      for (int col = 0; col < first.cols; ++col) {
        std::vector<double> such;
        for (const Entry* entry : scored)
          if (entry->robot.body.at(row, col) == kind) such.push_back(*entry->fitness);
        const std::size_t count = such.size();
        cells.push_back(count < fewest ? Json() : Json(median(such) - middle));
        if (count >= fewest) widest = std::max(widest, std::abs(median(such) - middle));
        counts.push_back(count);
      }
      chart["cells"].push_back(std::move(cells));
      chart["counts"].push_back(std::move(counts));
    }
    charts.push_back({name, std::move(chart)});
  }
  for (FeatureChart& each : charts) each.chart["widest"] = widest;
  return charts;
}

}  // namespace evo::report
