// What animated formats share: the part of a frame that changed.
#pragma once

#include "render/painters/image.h"

namespace evo::render {

struct Area {
  int x = 0;
  int y = 0;
  Size size;
};

// The smallest rectangle outside of which both frames are equal; one pixel when
// they are equal everywhere. `before` may be empty: everything changed.
Area changed_area(Size size, std::span<const std::uint8_t> before,
                  std::span<const std::uint8_t> after, int bytes_per_pixel);

}  // namespace evo::render
