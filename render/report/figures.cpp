#include "render/report/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

// Of robots the page has the fitness already.
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

std::string quoted(const std::string& text) {
  std::string made = "\"";
  for (const char c : text) made += c == '"' ? "\"\"" : std::string(1, c);
  return made + "\"";
}

}  // namespace

std::string figure_pdf(const Figure& figure, render::Typesetter& typesetter) {
  constexpr double wide = 85 / 25.4 * 96;  // a column, in pixels of a drawing
  constexpr render::Size size{420, 260};
  const auto drawn = std::visit(
      [&](const auto& content) {
        return draw_chart(content, size, render::theme_by_name("paper"), typesetter);
      },
      figure.content);
  constexpr double scale = wide / size.width;
  render::Drawing page({static_cast<int>(std::lround(wide)),
                        static_cast<int>(std::lround(drawn.drawing.size().height * scale))});
  page.place(drawn.drawing, {0, 0}, static_cast<float>(scale));
  return encode_pdf(page, figure.title, typesetter);
}

std::string figure_csv(const Figure& figure, const Run* run) {
  std::string text = "series,x,value,low,high,robot\n";
  const auto id = [&](std::size_t robot) {
    return run == nullptr || robot == render::no_robot ? "" : run->robots[robot].robot.id;
  };
  if (const auto* chart = std::get_if<Chart>(&figure.content)) {
    for (const Series& series : chart->series)
      for (const auto& [x, value, low, high, robot] : series.points)
        text +=
            fmt::format("{},{},{},{},{},{}\n", quoted(series.name), x, value, low, high, id(robot));
    return text;
  }
  const auto& table = std::get<ColorTable>(figure.content);
  for (std::size_t line = 0; line < table.cells.size(); ++line)
    for (std::size_t column = 0; column < table.cells[line].size(); ++column)
      if (const ColorTable::Cell& cell = table.cells[line][column]; !std::isnan(cell.value))
        text += fmt::format("{},{},{},,,{}\n", quoted(place_in(table, line, column)), column + 1,
                            cell.value, id(cell.robot));
  return text;
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
