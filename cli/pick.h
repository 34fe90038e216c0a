// Some of the robots that are read, by their places.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "formats/robot/robot.h"

namespace evo::cli {

inline constexpr const char* pick_help =
    "of the robots read, those at these places from 0: 7, 3-8, or 5- for all from there; there "
    "may be none [all]";

// Throws Error(usage) for what is none of these forms.
std::vector<Robot> pick(std::vector<Robot> robots, const std::optional<std::string>& places);

}  // namespace evo::cli
