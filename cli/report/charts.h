// The figures of a page as data: what dygraphs draws, and what report.js needs to
// label it. A chart is a JSON object
//   {"x","y": axis titles, "labels": [x, series..], "rows": [[x, [low,mid,high]..]..],
//    "series": [{"kind": "line"|"thick"|"step"|"points"|"best", "band": its name, "off": hidden at
//    first}..], "whole": x has no fractions, "robots": [id of each row]}
// where a missing value is [null,null,null].
#pragma once

#include <string>
#include <vector>

#include "cli/report/run.h"
#include "formats/json.h"

namespace evo::report {

// Best so far, and every robot, against the number of robots trained.
Json progress_chart(const Run& run);

// Best so far, best, median with quartiles, mean with standard deviation of every
// generation's scored robots.
Json generation_chart(const Run& run);

// Best so far of several runs on one task. Runs that differ in nothing but their
// seed give one curve, their mean with its standard deviation, and each its own.
Json comparison_chart(const std::vector<const Run*>& runs);

// The champion's evaluations during its training. Null without any.
Json learning_chart(const Run& run);

// Fitness against one number of the body: voxels, actuators, share of a kind.
struct FeatureChart {
  std::string name;
  Json chart;
};
std::vector<FeatureChart> feature_charts(const Run& run);

}  // namespace evo::report
