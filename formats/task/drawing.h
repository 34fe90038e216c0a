// A task's world in letters.
#pragma once

#include <string>

#include "libevo/body/body.h"
#include "libevo/task/spec.h"

namespace evo {

// The world as an episode begins, offsets that are drawn left out: '#' terrain, 'o' other
// objects, '@' the robot, '.' nothing. A letter is a cell; worlds wider than `columns`
// letters have a letter for every 2x2 cells, or more, what stands first in this list
// hiding the rest: robot, object, terrain. Taller ones than `rows` lines are cut at
// the top, but not the robot, and say so. The first line explains the letters. Every line ends with
// a line break.
std::string draw_task(const TaskSpec& task, const Body& robot, int columns, int rows);

}  // namespace evo
