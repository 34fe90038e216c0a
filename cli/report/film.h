// Moments of an episode side by side: what a video shows, for paper, and for a
// page without one.
#pragma once

#include <string>

#include "formats/rollout.h"

namespace evo::report {

// PNG files.
struct Film {
  std::string light;
  std::string dark;
};

// Of the rollout's first episode. Throws Error(data) for one that cannot be drawn.
Film draw_film(const Rollout& rollout);

}  // namespace evo::report
