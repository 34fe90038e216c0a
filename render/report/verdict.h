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
  std::string headline;
  std::vector<std::string> sentences;
  struct Command {
    std::string why;
    std::string line;
  };
  std::vector<Command> commands;  // to copy
};

// The smallest gain that is called one, in returns; of the benchmark's 32 tasks the
// hardest to earn in, Balancer-v0, ends at 0.16 in the paper's runs.
inline constexpr double least_gain = 0.1;

Verdict judge(const Run& run);

// The command line of the run with some settings changed: "make -f scripts/ga.mk ..".
std::string run_command(const Run& run, std::vector<std::pair<std::string, std::string>> changed);

}  // namespace evo::report
