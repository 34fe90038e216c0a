// Figures as files, and with what report.js says of them.
#pragma once

#include <string>

#include "render/report/charts.h"

namespace evo::report {

// For a column of a paper: 85 mm wide, on white, letters as letters.
std::string figure_pdf(const render::Figure& figure, render::Typesetter& typesetter);

// Its numbers, a line each: series, x, value, low, high, robot.
std::string figure_csv(const render::Figure& figure, const Run* run);

// "Fitness and the body: voxels. Every robot a point.", without markup.
std::string caption(const FigureGroup& group, const render::Figure& figure);

// {"frame": [x, y, width, height] of the drawing, "range": [x0, x1, y0, y1] there, "x", "y":
//  titles, "series": [{"name", "x": numbers, "y": those, or that of the fitness of "robots":
//  numbers in Run::shown, "low", "high": of a band, "says": texts of cells}..]}
Json figure_data(const render::Figure& figure, const render::ChartFrame& frame, const Run* run);

}  // namespace evo::report
