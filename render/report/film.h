// The way of a robot in one picture: what a replay shows, for paper, and where there
// is no JavaScript.
#pragma once

#include <string>

#include "formats/rollout/rollout.h"

namespace evo::report {

// SVG documents.
struct Film {
  std::string light;
  std::string dark;
};

// The rollout's first episode. Throws Error(data) where it cannot be drawn.
Film draw_film(const Rollout& rollout);

}  // namespace evo::report
