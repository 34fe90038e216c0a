// Numbers that scales and rulers are marked with.
#pragma once

#include <string>

namespace evo::render {

// The least of .., 0.5, 1, 2, 5, 10, .. that is not below `value`, which is positive.
double round_number_from(double value);

// A number as an axis whose marks are `tick` apart shows it, with as many digits as they need.
std::string axis_number(double value, double tick);

}  // namespace evo::render
