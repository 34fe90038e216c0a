// Figures as files, and with what report.js says of them.
#pragma once

#include <string>

#include "render/report/charts.h"

namespace evo::report {

// The bytes of a file `name`, .pdf or .svg: so many pixels of 1/96 inch wide, on white (an SVG on
// black for readers who prefer dark), letters as letters. Throws Error(usage) for another ending.
std::string figure_file(const render::Figure& figure, double width, const std::string& name,
                        render::Typesetter& typesetter);

// A field of comma-separated values (RFC 4180), quoted where it has to be.
std::string csv_field(const std::string& text);

// The numbers of a figure, a line each, below titles: look (as in Series), series, x, value, low,
// high, robot.
std::string figure_csv(const render::Figure& figure, const Run* run);
// A chart from such lines; the last three columns may be absent. `band`: what low and high are;
// `log`: axes of powers, of "x" and "y". Throws Error(data) with the line, also for a value that is
// not above 0 on such an axis.
render::Chart chart_from_csv(const std::string& text, const std::string& log,
                             const std::string& band, const std::string& file);

// "Fitness and the body: voxels. Every robot a point.", without markup.
std::string caption(const FigureGroup& group, const render::Figure& figure);

// {"frame": [x, y, width, height] of the drawing, "range": [x0, x1, y0, y1] there, "x", "y":
//  titles, "series": [{"name", "x": numbers, "y": those, or that of the fitness of "robots":
//  numbers in Run::shown, "low", "high": of a band, "says": texts of cells}..]}
Json figure_data(const render::Figure& figure, const render::ChartFrame& frame, const Run* run);

}  // namespace evo::report
