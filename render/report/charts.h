// The figures of a page as data for charts.js. A chart is a JSON object
//   {"x","y": axis titles, "labels": [x, series..], "rows": [[x, [low,mid,high]..]..],
//    "series": [{"kind": "line"|"thick"|"step"|"points"|"best", "band": its name, "off": hidden at
//    first, "thin", "color": of the palette in charts.js}..], "whole": x has no fractions,
//    "robots": [id of each row], "edges": [[row, row, the champion's?]..] lines between rows}
// where a missing value is [null,null,null], or a table of colours
//   {"kind": "heat", "x", "y": titles, "columns", "lines": their names, from the top, or
//    "ends": [numbers between and around the columns, the same of the lines, or none],
//    "cells": [[value or null]..], "robots": [[id or null]..], "value": what it is,
//    "diverging": about zero, "widest": the value at either end of its colours, where several
//    have one scale, "counts": [[robots in each cell]..]}
#pragma once

#include <string>
#include <vector>

#include "formats/io/json.h"
#include "render/report/run.h"

namespace evo::report {

// Best so far, and every robot, against the number of robots trained.
Json progress_chart(const Run& run);

// Best so far and best of every generation's scored robots; median with quartiles of those
// that were new in it: survivors, which are the better half, thin out as a run goes on, and
// would make medians jump.
Json generation_chart(const Run& run);

// Best so far of several runs on one task. Runs that differ in nothing but their
// seed give one curve, their median with its range (quartiles of many), and each its own.
Json comparison_chart(const std::vector<const Run*>& runs);

// All robots' evaluations during their trainings; rows, robots and edges are left to
// report.js, which has the curves with the robots. Null without any.
Json learning_chart(const Run& run);

struct FeatureChart {
  std::string name;
  Json chart;
};
// Of the controller that all robots of a generation have, against the steps of all: the mean
// return over them, and what its training logged. None for other runs.
std::vector<FeatureChart> shared_charts(const Run& run);

// Every scored robot by generation and fitness, with lines from its parents.
Json tree_chart(const Run& run);

// The best fitness of all robots with so many voxels and so many actuators.
Json coverage_chart(const Run& run);

// The archive of a run that keeps one: the best fitness in every cell of its first two
// axes, over all bins of others. Null for other runs, and for grids too fine to be seen.
// Throws Error(data) for axes that are none.
Json archive_chart(const Run& run);

// Fitness against one number of the body: voxels, actuators, share of a kind.
std::vector<FeatureChart> feature_charts(const Run& run);

// For every place of the body, by kind of voxel: the median fitness of the robots that
// have it there less that of all, in colours of one scale. None for runs whose bodies differ in
// size.
std::vector<FeatureChart> position_charts(const Run& run);

}  // namespace evo::report
