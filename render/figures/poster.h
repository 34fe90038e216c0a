// A run on one page: what its best robot does, how that came about, and what it looks like.
#pragma once

#include <string>
#include <vector>

#include "formats/robot/robot.h"
#include "render/painters/text.h"
#include "render/scene/clip.h"

namespace evo::render {

struct PosterContent {
  std::string title;     // the task
  std::string sentence;  // what the run was
  struct Ancestor {
    Robot robot;
    int generation = 0;
  };
  std::vector<Ancestor> line;  // the first ancestor first, the best robot last; not empty
  std::vector<double> best;    // fitness so far, after each robot; NaN: none
};

// A4 at 96 pixels an inch: a strip (or sheet) of moments of the
// best robot's episode, its body, the best fitness against robots tried, and the bodies it goes
// back to, as many as find room, voxels framed that differ from the one before.
Drawing poster(const PosterContent& content, const Drawing& moments, const Theme& theme,
               Typesetter& typesetter);
// The width that `moments` needs to be drawn with.
int poster_width();

}  // namespace evo::render
