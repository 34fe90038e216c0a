#include "render/figures/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "render/scene/round_numbers.h"

namespace evo::render {
namespace {

using Look = Series::Look;

constexpr float letters = 12;  // pixels an em, of charts that are drawn in their own size
constexpr float line_height = 1.35F * letters;

// ---- what is in sight -----------------------------------------------------------------

bool is_single(const Series& series) {  // a robot each
  return series.look == Look::points || series.look == Look::curves;
}

// From where up most of the values are: lower than three times the middle half's width below it
// are few that would flatten the others. The best are what an evolution is for.
double most_from(std::vector<double> values) {
  constexpr std::size_t few = 8;
  constexpr double widths = 3;
  constexpr double lowest = -std::numeric_limits<double>::infinity();
  if (values.size() < few) return lowest;
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(values.size() - 1)))];
  };
  const double wide = at(0.75) - at(0.25);
  return wide > 0 ? at(0.25) - widths * wide : lowest;
}

double share_of(double value, double from, double to, bool log) {
  return log ? std::log(value / from) / std::log(to / from) : (value - from) / (to - from);
}

// Some way past an end of an axis.
double beyond(double end, double other, double share, bool log) {
  return log ? end * std::pow(end / other, share) : end + share * (end - other);
}

ChartFrame in_sight(const Chart& chart) {
  constexpr double none = std::numeric_limits<double>::infinity();
  ChartFrame frame{{}, none, -none, none, -none, chart.log_x, chart.log_y};
  std::vector<double> robots;
  std::vector<double> ends;
  for (const Series& series : chart.series)
    for (const Series::Point& point : series.points) {
      frame.x0 = std::min(frame.x0, point.x);
      frame.x1 = std::max(frame.x1, point.x);
      if (is_single(series)) robots.push_back(point.value);
      if (!series.band.empty()) ends.insert(ends.end(), {point.low, point.value, point.high});
    }
  const double least = most_from(robots.empty() ? ends : robots);
  for (const Series& series : chart.series)
    for (const Series::Point& point : series.points) {
      if (is_single(series) && point.value < least) continue;
      frame.y0 = std::min({frame.y0, point.value, point.low < least ? point.value : point.low});
      frame.y1 = std::max({frame.y1, point.value, point.high});
    }
  if (!(frame.x1 >= frame.x0)) frame = {};
  if (frame.x0 == frame.x1) frame.x0 -= 1, frame.x1 += 1;
  if (frame.y0 == frame.y1) frame.y0 -= 0.5, frame.y1 += 0.5;
  constexpr double pad = 0.05;
  const double top = beyond(frame.y1, frame.y0, pad, frame.log_y);
  frame.y0 = beyond(frame.y0, frame.y1, pad, frame.log_y);
  frame.y1 = top;
  return frame;
}

// ---- axes -------------------------------------------------------------------------------

// "0.5", "200", "10k", "5\u00b710\u207b\u2078". On an axis that begins below a thousandth, 0.01 is
// "10\u207b\u00b2" as well.
std::string log_name(double value, double first) {
  constexpr double thousands = 1e4;
  const bool plain = value >= 1 || first > 9e-4;
  if (plain && value < 1e6)
    return value >= thousands ? fmt::format("{:.0f}k", value / 1000) : fmt::format("{:g}", value);
  constexpr std::array digits{"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                              "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  const long power = std::lround(std::floor(std::log10(value) + 1e-9));
  const long digit = std::lround(value / std::pow(10.0, power));
  std::string text = digit == 1 ? "" : fmt::format("{}\u00b7", digit);
  text += power < 0 ? "10\u207b" : "10";
  for (const char figure : fmt::to_string(std::abs(power)))
    text += digits.at(static_cast<std::size_t>(figure - '0'));
  return text;
}

struct Ticks {
  std::vector<double> at;
  double step = 1;
  bool log = false;
  std::string name(double value) const {
    if (log) return log_name(value, at.front());
    constexpr double thousands = 1e4;
    const bool short_ = std::max(std::abs(at.front()), std::abs(at.back())) >= thousands;
    return short_ && value != 0 ? axis_number(value / 1000, step / 1000) + "k"
                                : axis_number(value, step);
  }
};

// Powers of ten, and their doubles and halves where there are few.
Ticks log_ticks(double low, double high, double most) {
  Ticks made{{}, 1, true};
  const int first = static_cast<int>(std::floor(std::log10(low)));
  const int last = static_cast<int>(std::ceil(std::log10(high)));
  const int every = std::max(1, static_cast<int>(std::ceil((last - first) / most)));
  const bool few = high / low < 1000;
  for (int power = first; power <= last; power += every)
    for (const double digit : {1.0, 2.0, 5.0})
      if (const double value = digit * std::pow(10.0, power);
          (digit == 1 || few) && value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9))
        made.at.push_back(value);
  return made;
}

Ticks ticks(double low, double high, double most, bool whole) {
  Ticks made;
  made.step = round_number_from((high - low) / std::max(1.0, most));
  if (whole) made.step = std::max(1.0, made.step);
  for (double k = std::ceil(low / made.step - 1e-9); k * made.step <= high + 1e-9 * made.step; ++k)
    made.at.push_back(k * made.step);
  if (made.at.empty()) made.at.push_back(low);
  return made;
}

// Names of lines at their ends, as near as they can be without touching.
struct Name {
  float y = 0;
  std::string text;
  Color color;
};

void draw_names(std::vector<Name> names, float x, const Rect& inside, const Theme& theme,
                Drawing& drawing) {
  std::stable_sort(names.begin(), names.end(),
                   [](const Name& a, const Name& b) { return a.y < b.y; });
  const float lowest = inside.y + inside.height;
  for (std::size_t k = 0; k < names.size(); ++k)
    names[k].y = std::max(names[k].y, k > 0 ? names[k - 1].y + line_height : inside.y);
  for (std::size_t k = names.size(); k-- > 0;)
    names[k].y = std::min(names[k].y, k + 1 < names.size() ? names[k + 1].y - line_height : lowest);
  for (const Name& name : names) {
    drawing.disc({x, name.y}, 3, name.color);
    drawing.text({x + 7, name.y + 0.36F * letters}, letters, name.text, theme.text);
  }
}

void draw_axes(const Chart& chart, const ChartFrame& frame, const Ticks& up, const Theme& theme,
               Drawing& drawing) {
  const Rect& inside = frame.inside;
  const float low = inside.y + inside.height;
  for (const double value : up.at) {
    const float y = frame.y(value);
    drawing.segment({inside.x, y}, {inside.x + inside.width, y}, 1, theme.grid_major);
    drawing.text({inside.x - 6, y + 0.36F * letters}, letters, up.name(value), theme.text_muted,
                 Align::right);
  }
  constexpr double apart = 62;  // pixels
  const Ticks across = chart.log_x ? log_ticks(frame.x0, frame.x1, inside.width / apart)
                                   : ticks(frame.x0, frame.x1, inside.width / apart, chart.whole);
  for (const double value : across.at) {
    const float x = frame.x(value);
    drawing.segment({x, low}, {x, low + 4}, 1, theme.text_muted);
    drawing.text({x, low + 4 + letters}, letters, across.name(value), theme.text_muted,
                 Align::centre);
  }
  drawing.segment({inside.x, low}, {inside.x + inside.width, low}, 1, theme.text_muted);
  drawing.text({inside.x + inside.width / 2, low + 4 + 2.3F * letters}, letters, chart.x,
               theme.text_muted, Align::centre);
  drawing.text({4, 1.1F * letters}, letters, chart.y, theme.text_muted);
}

// ---- marks --------------------------------------------------------------------------------

// The more points lie on each other, the darker.
void draw_points(const Series& series, const ChartFrame& frame, Drawing& drawing) {
  constexpr float radius = 3;
  constexpr std::size_t sparse = 150;
  struct Heap {
    Point at;
    int robots = 0;
  };
  std::map<std::pair<int, int>, Heap> heaps;
  for (const Series::Point& point : series.points) {
    const Point at{frame.x(point.x), frame.y(point.value)};
    Heap& heap = heaps[{static_cast<int>(at.x / 1.5F), static_cast<int>(at.y / 1.5F)}];
    if (heap.robots++ == 0) heap.at = at;
  }
  const bool many = series.points.size() > sparse;
  const std::array alphas{many ? 0.35 : 0.7, many ? 0.55 : 0.85, many ? 0.8 : 1.0, 1.0};
  for (std::size_t level = 0; level < alphas.size(); ++level)
    for (const auto& [place, heap] : heaps) {
      const std::size_t own = heap.robots == 1 ? 0 : heap.robots < 4 ? 1 : heap.robots < 9 ? 2 : 3;
      if (own == level)
        drawing.disc(heap.at, radius, with_alpha(chart_color(series.color), alphas[level]));
    }
  // Those that are too low for the chart.
  const float low = frame.inside.y + frame.inside.height;
  for (const Series::Point& point : series.points)
    if (point.value < frame.y0) {
      const float x = frame.x(point.x);
      drawing.triangle({Point{x - 4, low - 6}, {x + 4, low - 6}, {x, low}},
                       chart_color(series.color));
    }
}

void draw_curves(const Series& series, const ChartFrame& frame, Drawing& drawing) {
  std::vector<Point> line;
  const auto finish = [&] {
    drawing.stroke(line, false, 1, with_alpha(chart_color(series.color), 0.5));
    line.clear();
  };
  for (std::size_t k = 0; k < series.points.size(); ++k) {
    const Series::Point& point = series.points[k];
    if (k > 0 && series.points[k - 1].robot != point.robot) finish();
    line.push_back({frame.x(point.x), frame.y(point.value)});
  }
  finish();
}

// Through all points; of steps with corners.
std::vector<Point> line_through(const Series& series, const ChartFrame& frame,
                                double Series::Point::*which) {
  std::vector<Point> line;
  for (const Series::Point& point : series.points) {
    const Point at{frame.x(point.x), frame.y(point.*which)};
    if (series.look == Look::step && !line.empty() && line.back().y != at.y)
      line.push_back({at.x, line.back().y});
    else if (series.look == Look::step && line.size() > 1 && line[line.size() - 2].y == at.y)
      line.pop_back();  // of a level, its ends
    line.push_back(at);
  }
  return line;
}

void draw_band(const Series& series, const ChartFrame& frame, Drawing& drawing) {
  std::vector<Point> upper;
  std::vector<Point> lower;
  for (const Series::Point& point : series.points) {
    const float x = frame.x(point.x);
    if (series.look == Look::step && !upper.empty()) {
      upper.push_back({x, upper.back().y});
      lower.push_back({x, lower.back().y});
    }
    upper.push_back({x, frame.y(point.high)});
    lower.push_back({x, frame.y(point.low)});
  }
  drawing.band(upper, lower, with_alpha(chart_color(series.color), 0.18));
}

void draw_line(const Series& series, const ChartFrame& frame, Drawing& drawing) {
  constexpr std::size_t few = 60;  // points that are still told apart
  const Color color = chart_color(series.color);
  const float width = series.look == Look::thick ? 3.5F : series.pale ? 1.0F : 2.0F;
  drawing.stroke(line_through(series, frame, &Series::Point::value), false, width,
                 series.pale ? with_alpha(color, 0.45) : color);
  if (series.points.size() > 1 && (series.look != Look::line || series.points.size() > few)) return;
  for (const Series::Point& point : series.points)
    drawing.disc({frame.x(point.x), frame.y(point.value)}, 2.4F, color);
}

void draw_champion(const Series& series, const ChartFrame& frame, const Theme& theme,
                   Drawing& drawing) {
  for (const Series::Point& point : series.points) {
    const Point at{frame.x(point.x), frame.y(point.value)};
    drawing.disc(at, 6.5F, theme.card);
    drawing.disc(at, 5, chart_color(series.color));
    const bool left = at.x > frame.inside.x + frame.inside.width / 2;
    drawing.text({at.x + (left ? -10 : 10), at.y + 0.36F * letters}, letters, series.name,
                 theme.text, left ? Align::right : Align::left);
  }
}

bool has_name(const Series& series) {
  return !is_single(series) && series.look != Look::champion && !series.pale &&
         !series.name.empty() && !series.points.empty();
}

// ---- colours of tables ----------------------------------------------------------------------

using Ramp = std::array<Color, 5>;
constexpr Ramp about_zero{{{33, 102, 172, 255},
                           {146, 197, 222, 255},
                           {240, 240, 238, 255},
                           {244, 165, 100, 255},
                           {178, 64, 15, 255}}};
constexpr Ramp upwards{{{68, 30, 110, 255},
                        {59, 82, 139, 255},
                        {33, 145, 140, 255},
                        {94, 201, 98, 255},
                        {253, 231, 37, 255}}};

Color color_on(const Ramp& ramp, double share) {
  const double at = std::clamp(share, 0.0, 0.9999) * static_cast<double>(ramp.size() - 1);
  const auto k = static_cast<std::size_t>(at);
  return mix(ramp[k], ramp[k + 1], at - static_cast<double>(k));
}

// Flat, in runs of one kind: as small as a letter.
void draw_small_body(const Body& body, const Rect& area, const Theme& theme, Drawing& drawing) {
  const float side = std::min(area.width / static_cast<float>(body.cols),
                              area.height / static_cast<float>(body.rows));
  const float left = area.x + (area.width - side * static_cast<float>(body.cols)) / 2;
  const float top = area.y + (area.height - side * static_cast<float>(body.rows)) / 2;
  for (const Voxel kind : {Voxel::rigid, Voxel::soft, Voxel::horizontal, Voxel::vertical})
    for (int line = 0; line < body.rows; ++line)
      for (int col = 0, end = 0; col < body.cols; col = std::max(end, col + 1)) {
        for (end = col; end < body.cols && body.at(line, end) == kind;) ++end;
        if (end > col)
          drawing.rectangle(
              {left + side * static_cast<float>(col), top + side * static_cast<float>(line),
               side * static_cast<float>(end - col), side},
              color_of(theme, kind));
      }
}

struct Scale {
  double low = 0;
  double high = 1;
  bool beyond = false;  // some are lower
  Ramp ramp = upwards;
  Color color(double value) const { return color_on(ramp, (value - low) / (high - low)); }
};

Scale scale_of(const ColorTable& table) {
  std::vector<double> values;
  for (const auto& line : table.cells)
    for (const auto& cell : line)
      if (!std::isnan(cell.value)) values.push_back(cell.value);
  Scale scale;
  if (table.diverging) {
    scale.ramp = about_zero;
    scale.high = table.widest > 0 ? table.widest : 1;
    scale.low = -scale.high;
  } else if (!values.empty()) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double least = most_from(values);
    scale = {std::max(*low, least), *high, *low < least};
  }
  if (scale.low == scale.high) scale.low -= 0.5, scale.high += 0.5;
  return scale;
}

}  // namespace

float ChartFrame::x(double value) const {
  return inside.x + inside.width * static_cast<float>(share_of(value, x0, x1, log_x));
}
float ChartFrame::y(double value) const {
  const double share = std::clamp(share_of(value, y0, y1, log_y), 0.0, 1.0);
  return inside.y + inside.height * static_cast<float>(1 - share);
}

DrawnChart draw_chart(const Chart& chart, Size size, const Theme& theme, Typesetter& typesetter) {
  const auto width = static_cast<float>(size.width);
  ChartFrame frame = in_sight(chart);
  float names = 0;
  const float longest = 0.36F * width;
  std::vector<std::string> labels;
  for (const Series& series : chart.series) {
    labels.push_back(typesetter.shortened(
        series.name + (series.band.empty() ? "" : fmt::format(" ({})", series.band)), letters,
        false, longest));
    if (has_name(series)) names = std::max(names, typesetter.width(labels.back(), letters) + 22);
  }
  const float top = 1.9F * letters;
  const float below = 4 + 2.7F * letters;
  const float height = static_cast<float>(size.height) - top - below;
  constexpr double apart = 36;  // pixels
  const Ticks up = chart.log_y ? log_ticks(frame.y0, frame.y1, height / apart)
                               : ticks(frame.y0, frame.y1, height / apart, false);
  float left = 0;
  for (const double value : up.at) left = std::max(left, typesetter.width(up.name(value), letters));
  left += 10;
  // Half of the last number of the other axis.
  frame.inside = {left, top, width - left - std::max(names, 1.5F * letters), height};
  const double pad = names > 0 ? 0.0 : 0.03;
  const double right = beyond(frame.x1, frame.x0, pad, frame.log_x);
  frame.x0 = beyond(frame.x0, frame.x1, pad, frame.log_x);
  frame.x1 = right;

  Drawing drawing(size);
  draw_axes(chart, frame, up, theme, drawing);
  for (const Series& series : chart.series)
    if (!series.band.empty() && series.points.size() > 1) draw_band(series, frame, drawing);
  for (const bool strong : {false, true})
    for (const Chart::Link& link : chart.links)
      if (link.strong == strong)
        drawing.segment({frame.x(link.from.x), frame.y(link.from.value)},
                        {frame.x(link.to.x), frame.y(link.to.value)}, strong ? 2.5F : 1.0F,
                        strong ? chart_color(0) : with_alpha(chart_color(7), 0.35));
  std::vector<Name> ends;
  for (std::size_t k = 0; k < chart.series.size(); ++k) {
    const Series& series = chart.series[k];
    if (series.look == Look::points)
      draw_points(series, frame, drawing);
    else if (series.look == Look::curves)
      draw_curves(series, frame, drawing);
    else if (series.look == Look::champion)
      draw_champion(series, frame, theme, drawing);
    else
      draw_line(series, frame, drawing);
    if (has_name(series))
      ends.push_back({frame.y(series.points.back().value), labels[k], chart_color(series.color)});
  }
  draw_names(std::move(ends), frame.inside.x + frame.inside.width + 9, frame.inside, theme,
             drawing);
  return {std::move(drawing), frame};
}

DrawnChart draw_chart(const ColorTable& table, Size size, const Theme& theme,
                      Typesetter& typesetter) {
  const std::size_t lines = table.cells.size();
  const std::size_t columns = table.cells.front().size();
  const Scale scale = scale_of(table);
  const bool own_scale = table.widest == 0;
  float left = 0;
  for (const std::string& name : table.lines)
    left = std::max(left, typesetter.width(name, letters) + 8);
  const float right = own_scale ? 4.6F * letters : 4;
  const float top = (table.y.empty() ? 0.5F : 1.9F) * letters;
  const bool bodies = std::ranges::any_of(table.cells, [](const auto& line) {
    return std::ranges::any_of(line, [](const auto& cell) { return cell.body != nullptr; });
  });
  const float width = std::min(
      44.0F, (static_cast<float>(size.width) - left - right) / static_cast<float>(columns));
  const float room = static_cast<float>(size.height) - top - 4 - 2.7F * letters;
  const float height =
      bodies ? width : std::min({width, 30.0F, std::max(11.0F, room / static_cast<float>(lines))});
  ChartFrame frame{
      {left, top, width * static_cast<float>(columns), height * static_cast<float>(lines)},
      0,
      static_cast<double>(columns),
      0,
      static_cast<double>(lines)};
  const float low = top + frame.inside.height;
  Drawing drawing({size.width, static_cast<int>(std::ceil(low + 4 + 2.7F * letters))});
  for (std::size_t line = 0; line < lines; ++line)
    for (std::size_t column = 0; column < columns; ++column) {
      const ColorTable::Cell& cell = table.cells[line][column];
      const Rect box{left + width * static_cast<float>(column),
                     top + height * static_cast<float>(line), width - 1, height - 1};
      const Color color = scale.color(cell.value);
      if (std::isnan(cell.value))
        drawing.rounded_rectangle(box, 1, with_alpha(theme.text_muted, 0.1));
      else
        drawing.rectangle(box, color);
      if (cell.body != nullptr) {  // framed by the colour
        const float frame = std::max(1.5F, 0.08F * box.width);
        const auto within = [](const Rect& area, float by) -> Rect {
          return {area.x + by, area.y + by, area.width - 2 * by, area.height - 2 * by};
        };
        drawing.rectangle(within(box, frame), theme.card);
        draw_small_body(*cell.body, within(box, 1.6F * frame), theme, drawing);
      }
      const float small = 0.85F * letters;
      if (typesetter.width(cell.says, small) < box.width)
        drawing.text({box.x + box.width / 2, box.y + box.height / 2 + 0.36F * small}, small,
                     cell.says, std::isnan(cell.value) ? theme.text_muted : ink_on(color),
                     Align::centre);
    }
  const auto names = [&](const std::vector<std::string>& list, std::size_t cells, float side,
                         float apart, auto&& draw) {
    const float middle = list.size() == cells ? 0.5F : 0.0F;
    const auto every = static_cast<std::size_t>(std::max(1.0F, std::ceil(apart / side)));
    for (std::size_t k = 0; k < list.size(); k += every)
      draw(list[k], side * (static_cast<float>(k) + middle));
  };
  float widest = 0;
  for (const std::string& name : table.columns)
    widest = std::max(widest, typesetter.width(name, letters));
  names(table.columns, columns, width, widest + 6, [&](const std::string& name, float at) {
    drawing.text({left + at, low + 4 + letters}, letters, name, theme.text_muted, Align::centre);
  });
  names(table.lines, lines, height, letters, [&](const std::string& name, float at) {
    drawing.text({left - 6, top + at + 0.36F * letters}, letters, name, theme.text_muted,
                 Align::right);
  });
  drawing.text({left, low + 4 + 2.3F * letters}, letters, table.x, theme.text_muted);
  drawing.text({4, 1.1F * letters}, letters, table.y, theme.text_muted);
  if (!own_scale) return {std::move(drawing), frame};
  constexpr int shades = 24;
  const float x = left + frame.inside.width + 8;
  const float tall = frame.inside.height / shades;
  for (int k = 0; k < shades; ++k)
    drawing.rectangle({x, low - tall * static_cast<float>(k + 1), 9, tall + 0.5F},
                      color_on(scale.ramp, (k + 0.5) / shades));
  const double digits = round_number_from(std::max(1e-9, (scale.high - scale.low) / 100));
  drawing.text({x + 13, top + 0.8F * letters}, letters, axis_number(scale.high, digits),
               theme.text_muted);
  drawing.text({x + 13, low}, letters,
               (scale.beyond ? "\u2264 " : "") + axis_number(scale.low, digits), theme.text_muted);
  return {std::move(drawing), frame};
}

}  // namespace evo::render
