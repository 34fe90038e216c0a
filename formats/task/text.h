// Tasks in words, for evo-inspect.
#pragma once

#include <string>
#include <vector>

#include "libevo/body/body.h"
#include "libevo/task/spec.h"

namespace evo {

// Everything about a task, as several lines: world, observation with the
// indices that each part has for `robot`, reward and ends in formulas and words,
// notes. Throws as Arena does for a robot that does not fit the task.
std::string describe_task(const TaskSpec& task, const Body& robot);

// One line per task: name, difficulty, steps, length of the observation (in n, the
// robot's points, and for a full 5x5 body), description.
std::string task_table(const std::vector<TaskSpec>& tasks);

// A body of `rows` x `cols` horizontal actuators, for lengths and layouts.
Body full_body(int rows, int cols);

}  // namespace evo
