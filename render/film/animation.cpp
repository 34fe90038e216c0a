#include "render/film/animation.h"

#include <algorithm>
#include <cstring>

namespace evo::render {

Area changed_area(Size size, std::span<const std::uint8_t> before,
                  std::span<const std::uint8_t> after, int bytes_per_pixel) {
  if (before.empty()) return {0, 0, size};
  const auto pixel = static_cast<std::size_t>(bytes_per_pixel);
  const std::size_t stride = static_cast<std::size_t>(size.width) * pixel;
  int top = size.height;
  int low = -1;
  std::size_t left = stride;  // bytes
  std::size_t right = 0;
  for (int y = 0; y < size.height; ++y) {
    const std::uint8_t* a = &before[static_cast<std::size_t>(y) * stride];
    const std::uint8_t* b = &after[static_cast<std::size_t>(y) * stride];
    if (std::memcmp(a, b, stride) == 0) continue;
    top = std::min(top, y);
    low = y;
    const auto first = static_cast<std::size_t>(std::mismatch(a, a + stride, b).first - a);
    left = std::min(left, first);
    std::size_t last = stride;
    while (last > right && a[last - 1] == b[last - 1]) --last;
    right = std::max(right, last);
  }
  if (low < 0) return {0, 0, {1, 1}};
  const int x0 = static_cast<int>(left / pixel);
  const int x1 = static_cast<int>((right + pixel - 1) / pixel);
  return {x0, top, {x1 - x0, low + 1 - top}};
}

}  // namespace evo::render
