// What report.js needs for the cards of a run's robots.
#pragma once

#include "render/report/run.h"

namespace evo::report {

// {"world": (replay.h), "robots": {id: {"fitness", "facts": [[name, text]..],
//  "parents", "children": ids, "curve": [[step, evaluation, best]..],
//  "log": {name: [[step, value]..]}, "commands": lines, "replay": (replay.h)}}}
Json robots_data(const Run& run);

}  // namespace evo::report
