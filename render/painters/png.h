// PNG files, also animated (APNG), through libpng.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/painters/image.h"

namespace evo::render {

// `level` of deflate: 1 quick, 9 small. The bytes of a whole file.
std::string encode_png(const PixelView& image, int level = 6);
// Throws Error(cannot_create, io).
void write_png(const std::filesystem::path& path, const PixelView& image, int level = 6);
// Throws Error(no_input, data).
Image read_png(const std::filesystem::path& path);

// An animation that browsers play: every frame after the first is the rectangle
// that changed.
class ApngEncoder {
 public:
  // Frame k is shown for delays[k] / ticks seconds.
  ApngEncoder(Size size, std::size_t frames, int ticks);
  void add(const PixelView& frame, int delay);
  // The bytes of the file, after the last frame.
  std::string finish();

 private:
  std::string bytes_;
  std::vector<std::uint8_t> previous_;
  Size size_;
  std::size_t frames_;
  int ticks_;
  std::uint32_t sequence_ = 0;
  std::size_t added_ = 0;
};

}  // namespace evo::render
