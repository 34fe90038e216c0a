// The smallest upright rectangle around points.
#pragma once

#include <algorithm>
#include <limits>

#include "libevo/sim/model.h"

namespace evo {

// Lengths in the unit of the points; without any, x0 > x1.
struct Bounds {
  double x0 = std::numeric_limits<double>::infinity();
  double x1 = -std::numeric_limits<double>::infinity();
  double y0 = std::numeric_limits<double>::infinity();
  double y1 = -std::numeric_limits<double>::infinity();
  void add(Vec2 p) {
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
    y0 = std::min(y0, p.y);
    y1 = std::max(y1, p.y);
  }
  // Both of them.
  void cover(const Bounds& other) {
    add({other.x0, other.y0});
    add({other.x1, other.y1});
  }
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
};

}  // namespace evo
