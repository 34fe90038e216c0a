// An evolution as a film: the best robot of one generation after another in the
// world of their task.
#pragma once

#include <array>
#include <vector>

#include "render/painters/text.h"
#include "render/scene/clip.h"

namespace evo::render {

// The best robot of some generations in a row.
struct Champion {
  Episode episode;
  int first = 0;  // generations
  int last = 0;
  double fitness = 0;
};

// Each champion stands for a moment, the voxels in which it differs from the one
// before flashing; then its whole episode runs, quicker than the robot was, so that
// none takes longer than some seconds. Numbers stay where earlier ones came to.
class EvolutionFilm {
 public:
  // Throws Error(data) without champions.
  EvolutionFilm(const std::vector<Champion>& champions, const RenderOptions& options);

  std::size_t frames() const { return frames_; }
  Drawing frame(std::size_t k, Typesetter& typesetter) const;

 private:
  struct Part {
    Champion champion;
    Clip clip;
    std::size_t first_frame = 0;
    std::size_t standing = 0;  // frames
    std::size_t running = 0;
    std::size_t ended = 0;
    std::vector<std::array<Vec2, 4>> changed;
  };

  RenderOptions options_;
  std::vector<Part> parts_;
  std::size_t frames_ = 0;
};

}  // namespace evo::render
