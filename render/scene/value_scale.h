// Numbers as colours.
#pragma once

#include <string>

#include "render/painters/image.h"

namespace evo::render {

// From `low` over `middle`, which is pale, to `high`: blue to red, which no kind of
// colour vision confuses, and darker towards both ends.
struct ValueScale {
  std::string title;  // of its bar: "strain"
  double low = -1;
  double middle = 0;
  double high = 1;
  bool powers = false;  // of ten, and shown as what they are powers to
};

// Values beyond the ends have the colours of the ends.
Color color_of(const ValueScale& scale, double value);

// The least that reaches as far as both, which have one middle.
ValueScale widest(const ValueScale& a, const ValueScale& b);

}  // namespace evo::render
