// What a run says, in a few sentences, and what to do next.
#pragma once

#include <string>
#include <vector>

#include "render/report/run.h"

namespace evo::report {

struct Verdict {
  enum class Level {
    good,   // evolution or training found something
    doubt,  // it did, but something is wrong with it or it is not over
    bad,    // nothing was learnt
  };
  Level level = Level::good;
  std::string result;  // "3.42 on Walker-v0, from 2.07, still rising"
  std::string headline;
  std::vector<std::string> sentences;
  struct Command {
    std::string why;
    std::string line;
  };
  std::vector<Command> commands;  // to copy
};

// As many robots are trained as were asked for.
bool is_over(const Run& run);

Verdict judge(const Run& run);

// "9.99 ± 0.22", as every fitness of the run.
std::string with_error(const Run& run, double value, double error);

}  // namespace evo::report
