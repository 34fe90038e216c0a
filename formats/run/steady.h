// The state of an evolution without generations, RUN/steady.json: what the next
// robot is proposed from, so that proposing does not read the whole run again. It
// is written whole after the robots it counts, and can be deleted at any time: the
// same robots are then proposed anew from the first one.
//
//   {"format": "evo/steady", "version": 1, "robots": 120, "scores": 94,
//    "parameters": {"fitted": 75, "variance": .., "length_scale": .., "noise": ..},
//    "species": {..},          a NeatState (formats/run/neat.h)
//    "members": [{..}, ..]}    robots with id, body, fitness, genome and features
#pragma once

#include <string>
#include <string_view>

#include "formats/robot/robot.h"
#include "libevo/evolve/method.h"

namespace evo {

struct SteadyState {
  int robots = 0;      // proposed
  MethodState method;  // `scores` are those it was told, of robots 0 .. scores-1
};

std::string steady_state_to_text(const SteadyState& state);

// Throws Error(data) with `where` and the JSON path.
SteadyState parse_steady_state(std::string_view text, const std::string& where);

// A robot as methods of evolution see it. Throws Error(data) for a damaged genome.
ScoredRobot scored_robot(const Robot& robot);

}  // namespace evo
