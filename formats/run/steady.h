// The state of an evolution without generations, RUN/steady.json: what the next
// robot is proposed from, so that proposing does not read the whole run again. It
// is written whole after the robots it counts, and can be deleted at any time: the
// same robots are then proposed anew from the first one.
//
//   {"format": "evo/steady", "version": 1, "robots": 120, "scores": 94,
//    "parameters": {"fitted": 75, "variance": .., "length_scale": .., "noise": ..},
//    "species": {..},          a NeatState (formats/run/neat.h)
//    "members": [{..}, ..]}    robots with id, body, fitness and genome
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/robot/robot.h"
#include "libevo/evolve/gp.h"
#include "libevo/evolve/neat.h"

namespace evo {

struct SteadyState {
  int robots = 0;  // proposed
  int scores = 0;  // of robots 0 .. scores-1: all that `members` and `species` know
  // ga: the best scored, best first; neat: the population, oldest first.
  std::vector<Robot> members;
  NeatState species;                       // neat
  std::optional<GpParameters> parameters;  // bo: fitted to the first `fitted` scores
  int fitted = 0;
};

std::string steady_state_to_text(const SteadyState& state);

// Throws Error(data) with `where` and the JSON path.
SteadyState parse_steady_state(std::string_view text, const std::string& where);

}  // namespace evo
