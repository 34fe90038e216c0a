// Numbers that scales and rulers are marked with.
#pragma once

namespace evo::render {

// The least of .., 0.5, 1, 2, 5, 10, .. that is not below `value`, which is positive.
double round_number_from(double value);

}  // namespace evo::render
