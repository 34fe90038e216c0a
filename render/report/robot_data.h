// What report.js needs for pictures, cards and the table of a run's robots.
#pragma once

#include "render/report/run.h"

namespace evo::report {

// {"world": (replay.h), "done": "trained", "decimals": of fitness, "robots": {id: {"fitness",
//  "number": in the run, from 1, "generation", "body": "HHHHH/V.R.V", "parents": ids,
//  and what there is of "failure": why, "open": path of sides without link, "genes": [nodes,
//  links], "score": [mean, its error] from perturbed starts, "sharing": generation whose
//  controller it has, "best": [step, of steps], "tool", "charts": {name: [[step, value]..]} of
//  its training, "commands": lines, "replay": (replay.h)}}}, in the order of Run::shown.
Json robots_data(const Run& run);

}  // namespace evo::report
