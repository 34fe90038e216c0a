// Text, drawn by FreeType in DejaVu Sans. The font travels inside the program,
// so that a picture has the same letters on every machine.
#pragma once

#include <memory>
#include <string_view>

#include "render/painters/drawing.h"

namespace evo::render {

class Typesetter {
 public:
  Typesetter();
  ~Typesetter();
  Typesetter(const Typesetter&) = delete;
  Typesetter& operator=(const Typesetter&) = delete;

  // Advance width of a line in pixels; `size` in pixels per em.
  float width(std::string_view utf8, float size, bool bold = false);
  // `utf8` cut to at most `most` pixels, an ellipsis marking the cut.
  std::string shortened(std::string_view utf8, float size, bool bold, float most);
  void draw(const Text& text, PixelTarget target);

 private:
  struct Faces;
  std::unique_ptr<Faces> faces_;
};

// Height of capital letters and digits over the baseline, share of the size.
inline constexpr float cap_height = 0.729F;

}  // namespace evo::render
