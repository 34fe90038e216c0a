// Robots as the tools read them: from files named on the command line, or standard input.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "formats/robot/robot.h"

namespace evo::cli {

// Every robot of the named files in order; standard input when none is named. A
// policy or rollout file stands for the robot it holds. `policy` paths inside a
// document are relative to its file and come back relative to the current
// folder.
std::vector<Robot> read_robots(const std::vector<std::string>& files,
                               BodyCheck check = BodyCheck::robot);
// The same of one file whose bytes were read.
std::vector<Robot> robots_in(std::string_view bytes, const std::string& file,
                             BodyCheck check = BodyCheck::robot);

inline constexpr const char* pick_help =
    "of the robots read, those at these places from 0: 7, 3-8, or 5- for all from there; there "
    "may be none [all]";
// Those at the places that --pick names. Throws Error(usage) for what is none of these forms.
std::vector<Robot> pick(std::vector<Robot> robots, const std::optional<std::string>& places);

// Ids in the files, of robots or listed (--avoid).
std::set<std::string> read_ids(const std::vector<std::string>& files);

}  // namespace evo::cli
