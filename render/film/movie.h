// Moving pictures: frames that are drawn each on its own, by several processes, and
// the forms of files they end in.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "render/painters/drawing.h"
#include "render/painters/text.h"

namespace evo::render {

// Hears how many frames are finished, of how many.
using Progress = std::function<void(std::size_t frames, std::size_t of)>;

struct Movie {
  Size size;
  double fps = 50;
  int workers = 1;  // processes
  std::size_t frames = 0;
  std::function<Drawing(std::size_t frame, Typesetter& typesetter)> draw;
  Progress progress;  // may be empty
};

// Whether the name stands for a picture per frame. Throws Error(usage) for a name that
// says no form.
bool is_sequence(const std::string& output);
// Throws the same, and Error(usage) for odd sizes of videos.
void check_movie(Size size, const std::string& output);

// What check_movie() has passed. The form follows from `output`: .mp4, .webm or .gif, a name
// with %05d or the like (a PNG per frame, counted from 0; folders are made). Returns the number
// of frames.
std::size_t write_movie(const Movie& movie, const std::string& output);

}  // namespace evo::render
