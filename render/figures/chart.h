// Charts in one style: for the page of evo-report, for papers, for posters.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "libevo/body/body.h"
#include "render/painters/text.h"
#include "render/scene/theme.h"

namespace evo::render {

// What a chart's marks are of, if they are of one robot each.
inline constexpr std::size_t no_robot = std::numeric_limits<std::size_t>::max();

struct Series {
  enum class Look {
    line,
    thick,
    step,      // a value holds until the next
    curves,    // a thin line for each robot, through its points
    points,    // one each; of many that lie on each other, the darker the more
    champion,  // one large point, named
  };
  struct Point {
    double x = 0;
    double value = 0;
    double low = value;  // its spread, drawn as a band where the series has a name for that
    double high = value;
    std::size_t robot = no_robot;
  };
  std::string name;  // stands at the end of lines
  Look look = Look::line;
  std::size_t color = 0;           // chart_color()
  std::string band = {};           // "quartiles"; empty: none
  bool pale = false;               // one run of several, beside what stands for all; not named
  std::vector<Point> points = {};  // of lines from the left
};

struct Chart {
  std::string x;  // titles, with what they are measured in
  std::string y;
  bool whole = false;  // x has no fractions
  std::vector<Series> series = {};
  struct Link {  // between points that belong to each other
    Series::Point from;
    Series::Point to;
    bool strong = false;
  };
  std::vector<Link> links = {};
  bool log_x = false;
  bool log_y = false;
};

// A table of colours.
struct ColorTable {
  struct Cell {
    double value = std::numeric_limits<double>::quiet_NaN();  // not a number: nothing there
    std::size_t robot = no_robot;
    const Body* body = nullptr;  // drawn in the cell
    std::string says = {};       // in the place of the value, in a few characters
  };
  std::string x;
  std::string y;
  std::string value;                      // what it is
  std::vector<std::string> columns = {};  // names, in the middle of cells; one more: at the borders
  std::vector<std::string> lines = {};    // the same, from the top
  std::vector<std::vector<Cell>> cells = {};  // by line, as many in each
  bool diverging = false;                     // about zero
  double widest = 0;  // the value at either end of the colours, where tables share a scale
};

// With what a caption says.
struct Figure {
  std::string name;  // "fitness-by-generation", of files
  std::string title;
  std::string about;
  std::variant<Chart, ColorTable> content;
};

// Where values are on a drawing: `x0` to `x1` from left to right of `inside`, `y0` to `y1`
// upwards.
struct ChartFrame {
  Rect inside;
  double x0 = 0;
  double x1 = 1;
  double y0 = 0;
  double y1 = 1;
  bool log_x = false;
  bool log_y = false;
  float x(double value) const;
  float y(double value) const;  // no lower than the bottom
};

struct DrawnChart {
  Drawing drawing;
  ChartFrame frame;
};
// A chart fills the size; a table has its width, and the height it needs. A few robots that are
// far below the others, which would flatten them, are marked at the bottom; nothing is cut above.
DrawnChart draw_chart(const Chart& chart, Size size, const Theme& theme, Typesetter& typesetter);
DrawnChart draw_chart(const ColorTable& table, Size size, const Theme& theme,
                      Typesetter& typesetter);

}  // namespace evo::render
