// A finished picture in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace evo::render {

// In pixels.
struct Size {
  int width = 0;
  int height = 0;
  bool operator==(const Size&) const = default;
};

// Red, green, blue, alpha; alpha is 255 in every finished picture.
struct Color {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  std::uint8_t a = 255;
  bool operator==(const Color&) const = default;
};

struct Image {
  Size size;
  std::vector<std::uint8_t> rgba;  // 4 bytes per pixel, rows from the top, no padding

  Image() = default;
  explicit Image(Size s)
      : size(s), rgba(static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height) * 4) {}
};

// Pixels of somebody else, an Image or a buffer, to paint.
struct PixelTarget {
  Size size;
  std::span<std::uint8_t> rgba;
};
inline PixelTarget target(Image& image) { return {image.size, image.rgba}; }

}  // namespace evo::render
