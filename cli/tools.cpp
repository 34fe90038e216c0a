#include "cli/tools.h"

#include <stdexcept>

namespace evo::cli {

const std::vector<Chapter>& chapters() {
  static const std::vector<Chapter> all{
      {"Bodies",
       {{"sample", "makes random valid robots (connected, with an actuator)"},
        {"mutate", "makes children of robots by mutation"},
        {"neat", "makes the next population of CPPN-NEAT from the scored one"},
        {"suggest", "proposes bodies by Bayesian optimisation, from all scored so far"}}},
      {"Controllers",
       {{"train", "trains a controller for each robot, or one for all"},
        {"score", "scores robots by a program of your own"},
        {"eval", "runs episodes of robots with a controller, measures their returns"},
        {"env", "offers environments to any program, over pipes"}}},
      {"Evolution",
       {{"evolve", "plans a whole evolution as a folder with a Makefile, and runs it"},
        {"select", "selects the survivors among scored robots, best first"},
        {"archive", "keeps the fittest robot of every kind (MAP-Elites)"}}},
      {"Results",
       {{"inspect", "shows what a file holds, how far a run is, which tasks there are"},
        {"render", "draws pictures and videos of rollouts and robots, without a display"},
        {"report", "writes a page about runs: results, replays, curves, family tree"}}},
      {"Files and machine",
       {{"convert", "converts robots, worlds and policies, EvoGym's formats included"},
        {"data", "says where tasks, profiles and recipes are"},
        {"bench", "measures control steps per second, with random robots and actions"}}},
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
