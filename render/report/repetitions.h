// Runs that are repetitions of each other: they differ in nothing but their seed.
#pragma once

#include <string>
#include <vector>

#include "render/report/run.h"

namespace evo::report {

struct Repetitions {
  std::string label;  // the method, and settings that tell it from others of that method
  std::string method;
  std::vector<const Run*> runs;
};
std::vector<Repetitions> repetitions(const std::vector<const Run*>& runs);

}  // namespace evo::report
