#include "render/report/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "formats/io/number.h"
#include "libevo/base/error.h"
#include "render/painters/vector.h"

namespace evo::report {
namespace {

using render::Chart;
using render::ColorTable;
using render::Figure;
using render::Series;

Json rounded(double value) { return Json::parse(fmt::format("{:.5g}", value)); }

std::size_t place_of(const Run& run, std::size_t robot) {
  return static_cast<std::size_t>(std::lower_bound(run.shown.begin(), run.shown.end(), robot) -
                                  run.shown.begin());
}

bool is_of_robots(const Series& series) {
  return std::ranges::all_of(
      series.points, [](const Series::Point& point) { return point.robot != render::no_robot; });
}

// The page has the fitness of robots already.
bool is_fitness(const Series& series, const Run& run) {
  return std::ranges::all_of(series.points, [&](const Series::Point& point) {
    return run.robots[point.robot].fitness == point.value;
  });
}

Json series_data(const Series& series, const Run* run) {
  Json data{{"name", series.name}, {"x", Json::array()}};
  const bool robots = run != nullptr && is_of_robots(series);
  const bool values = !robots || !is_fitness(series, *run);
  for (const Series::Point& point : series.points) {
    data["x"].push_back(rounded(point.x));
    if (values) data["y"].push_back(rounded(point.value));
    if (robots) data["robots"].push_back(place_of(*run, point.robot));
    if (series.band.empty()) continue;
    data["low"].push_back(rounded(point.low));
    data["high"].push_back(rounded(point.high));
  }
  return data;
}

// "voxels 12, actuators 5", or between which ends.
std::string place_in(const ColorTable& table, std::size_t line, std::size_t column) {
  const auto name = [](const std::vector<std::string>& names, std::size_t cells, std::size_t k,
                       bool up) {
    if (names.size() == cells) return names[k];
    return up ? names[k + 1] + " to " + names[k] : names[k] + " to " + names[k + 1];
  };
  std::string text = table.x + " " + name(table.columns, table.cells.front().size(), column, false);
  if (!table.lines.empty())
    text += ", " + table.y + " " + name(table.lines, table.cells.size(), line, true);
  return text;
}

Json table_data(const ColorTable& table, const Run* run) {
  Json data{{"name", table.value}, {"x", Json::array()}, {"y", Json::array()}};
  const int decimals = run == nullptr ? 2 : run->decimals();
  for (std::size_t line = 0; line < table.cells.size(); ++line)
    for (std::size_t column = 0; column < table.cells[line].size(); ++column) {
      const ColorTable::Cell& cell = table.cells[line][column];
      if (std::isnan(cell.value)) continue;
      data["x"].push_back(static_cast<double>(column) + 0.5);
      data["y"].push_back(static_cast<double>(table.cells.size() - line) - 0.5);
      const std::string sign = table.diverging && cell.value > 0 ? "+" : "";
      data["says"].push_back(fmt::format(
          "{}: {}{}{}", place_in(table, line, column), sign, number(cell.value, decimals),
          cell.says.empty() ? "" : fmt::format(" ({} robots)", cell.says)));
      data["robots"].push_back(run == nullptr || cell.robot == render::no_robot
                                   ? Json()
                                   : Json(place_of(*run, cell.robot)));
    }
  return data;
}

constexpr std::array looks{"line",   "thick",  "step",
                           "curves", "points", "champion"};  // Series::Look

// What turns for readers who prefer dark: roles, not the colours of series.
std::string dark_rules() {
  const render::Theme& light = render::theme_by_name("paper");
  const render::Theme& dark = render::theme_by_name("dark");
  std::string rules = "<style>@media (prefers-color-scheme: dark) {";
  for (const auto role : {&render::Theme::paper, &render::Theme::text, &render::Theme::text_muted,
                          &render::Theme::grid_major})
    rules += fmt::format(" [fill=\"{0}\"] {{ fill: {1} }} [stroke=\"{0}\"] {{ stroke: {1} }}",
                         render::hex(light.*role), render::hex(dark.*role));
  return rules + " }</style>\n";
}

// The fields of a line of comma-separated values.
std::vector<std::string> csv_fields(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (quoted && c == '"' && line.substr(k + 1).starts_with('"'))
      fields.back() += line[++k];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

}  // namespace

std::string figure_file(const Figure& figure, double width, const std::string& name,
                        render::Typesetter& typesetter) {
  constexpr double least = 420;  // that a chart is drawn with, and made smaller
  constexpr double tall = 0.62;
  const double drawn_width = std::max(least, width);
  const render::Size size{static_cast<int>(std::lround(drawn_width)),
                          static_cast<int>(std::lround(tall * std::min(drawn_width, 600.0)))};
  const render::Theme& theme = render::theme_by_name("paper");
  const auto drawn =
      std::visit([&](const auto& content) { return draw_chart(content, size, theme, typesetter); },
                 figure.content);
  const double scale = width / size.width;
  render::Drawing page({static_cast<int>(std::lround(width)),
                        static_cast<int>(std::lround(drawn.drawing.size().height * scale))});
  page.rectangle(page.whole(), theme.paper);
  page.place(drawn.drawing, {0, 0}, static_cast<float>(scale));
  if (name.ends_with(".pdf")) return encode_pdf(page, figure.title, typesetter);
  if (!name.ends_with(".svg"))
    throw error(Failure::usage, "{}: a chart ends in .svg or .pdf", name);
  std::string svg = encode_svg(page, figure.title, typesetter);
  return svg.insert(svg.find("<defs>"), dark_rules());
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string figure_csv(const Figure& figure, const Run* run) {
  const auto id = [&](std::size_t robot) {
    return run == nullptr || robot == render::no_robot ? "" : run->robots[robot].robot.id;
  };
  if (const auto* chart = std::get_if<Chart>(&figure.content)) {
    std::string text =
        fmt::format("look,series,{},{},low,high,robot\n", csv_field(chart->x), csv_field(chart->y));
    for (const Series& series : chart->series)
      for (const auto& [x, value, low, high, robot] : series.points)
        text +=
            fmt::format("{},{},{},{},{},{},{}\n", looks.at(static_cast<std::size_t>(series.look)),
                        csv_field(series.name), x, value, low, high, id(robot));
    return text;
  }
  const auto& table = std::get<ColorTable>(figure.content);
  std::string text = fmt::format("where,{},robot\n", csv_field(table.value));
  for (std::size_t line = 0; line < table.cells.size(); ++line)
    for (std::size_t column = 0; column < table.cells[line].size(); ++column)
      if (const ColorTable::Cell& cell = table.cells[line][column]; !std::isnan(cell.value))
        text += fmt::format("{},{},{}\n", csv_field(place_in(table, line, column)), cell.value,
                            id(cell.robot));
  return text;
}

Chart chart_from_csv(const std::string& text, const std::string& log, const std::string& band,
                     const std::string& file) {
  constexpr std::size_t least = 4;  // fields
  Chart chart;
  chart.log_x = log.find('x') != std::string::npos;
  chart.log_y = log.find('y') != std::string::npos;
  int number = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> fields = csv_fields(line);
    const auto check = [&](bool good, const char* what) {
      if (!good) throw error(Failure::data, "{}:{}: {}", file, number, what);
    };
    ++number;
    check(fields.size() >= least, "expected look, series, x and value");
    if (number == 1) {
      chart.x = fields[2];
      chart.y = fields[3];
      continue;
    }
    const auto look = std::ranges::find(looks, fields[0]);
    check(look != looks.end(), "expected line, thick, step, curves, points or champion");
    if (chart.series.empty() || chart.series.back().name != fields[1])
      chart.series.push_back(
          {fields[1], static_cast<Series::Look>(look - looks.begin()), chart.series.size()});
    const auto x = number_in<double>(fields[2]);
    const auto value = number_in<double>(fields[3]);
    check(x && value && std::isfinite(*x) && !std::isinf(*value),  // a value may be missing
          "expected numbers for x and value");
    Series::Point point{*x, *value, *value, *value};
    if (fields.size() > least + 1) {
      point.low = number_in<double>(fields[4]).value_or(*value);
      point.high = number_in<double>(fields[5]).value_or(*value);
      if (point.low < point.high) chart.series.back().band = band;
    }
    check((!chart.log_x || point.x > 0) && (!chart.log_y || std::min(point.low, point.value) > 0),
          "an axis of powers needs values above 0");
    chart.series.back().points.push_back(point);
  }
  if (chart.series.empty()) throw error(Failure::data, "{}: no values", file);
  return chart;
}

std::string caption(const FigureGroup& group, const Figure& figure) {
  std::string text = group.title;
  if (!figure.title.empty()) text += (text.empty() ? "" : ": ") + figure.title;
  for (const std::string& about : {group.about, figure.about})
    if (!about.empty()) text += (text.ends_with('.') ? " " : ". ") + about;
  return text;
}

Json figure_data(const Figure& figure, const render::ChartFrame& frame, const Run* run) {
  const render::Rect& inside = frame.inside;
  Json data{
      {"frame",
       {rounded(static_cast<double>(inside.x)), rounded(static_cast<double>(inside.y)),
        rounded(static_cast<double>(inside.width)), rounded(static_cast<double>(inside.height))}},
      {"range", {rounded(frame.x0), rounded(frame.x1), rounded(frame.y0), rounded(frame.y1)}}};
  std::visit([&](const auto& content) { data["x"] = content.x, data["y"] = content.y; },
             figure.content);
  data["series"] = Json::array();
  if (const auto* table = std::get_if<ColorTable>(&figure.content)) {
    data["series"].push_back(table_data(*table, run));
    return data;
  }
  for (const Series& series : std::get<Chart>(figure.content).series)
    if (series.look != Series::Look::champion) data["series"].push_back(series_data(series, run));
  return data;
}

}  // namespace evo::report
