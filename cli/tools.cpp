#include "cli/tools.h"

#include <stdexcept>

namespace evo::cli {

const std::vector<Chapter>& chapters() {
  static const std::vector<Chapter> all{
      {"Bodies",
       {{"sample", "random valid robots (connected, with an actuator)"},
        {"mutate", "children of the robots read"},
        {"neat", "the next population of CPPN-NEAT, from the scored one read"},
        {"suggest", "Bayesian optimisation: the next bodies from all scored so far"}}},
      {"Controllers",
       {{"train", "trains a controller for each robot read"},
        {"eval", "episodes of robots with a given controller, and their returns"},
        {"env", "environments to be stepped by any program, over pipes"}}},
      {"Evolution",
       {{"run", "begins a run folder, trains its slots, says how they stand"},
        {"select", "the survivors of scored robots, best first"},
        {"archive", "the fittest robot of every kind (MAP-Elites)"}}},
      {"Results",
       {{"inspect", "what a file is and says, how a run stands, the tasks"},
        {"render", "pictures and videos of rollouts and robots, off-screen"},
        {"report", "a page about runs: results, replays, curves, family tree, settings"}}},
      {"Files and machine",
       {{"convert", "robots and worlds between formats, EvoGym's included"},
        {"data", "where tasks, profiles and pipelines are"},
        {"bench", "control steps per second, random robots and actions"}}},
  };
  return all;
}

const std::string& purpose_of(const std::string& executable) {
  for (const Chapter& chapter : chapters())
    for (const Tool& tool : chapter.tools)
      if (executable == "evo-" + tool.name) return tool.purpose;
  throw std::logic_error(executable + " is not in the table of tools");
}

}  // namespace evo::cli
