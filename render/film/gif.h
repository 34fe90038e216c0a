// Animated GIF through giflib.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/film/quantise.h"

namespace evo::render {

// Most colours of the palette: one of the 256 stands for "as before".
inline constexpr std::size_t gif_colors = 255;

class GifEncoder {
 public:
  // One palette for the whole animation.
  GifEncoder(Size size, std::vector<Color> palette);
  ~GifEncoder();
  GifEncoder(const GifEncoder&) = delete;
  GifEncoder& operator=(const GifEncoder&) = delete;

  // `delay` in hundredths of a second; browsers slow down anything below 2.
  void add(const PixelView& frame, int delay);
  // The bytes of the file, after the last frame.
  std::string finish();

 private:
  struct File;
  std::unique_ptr<File> file_;
  PaletteMap map_;
  Size size_;
  std::vector<std::uint8_t> previous_;  // palette indices
};

}  // namespace evo::render
