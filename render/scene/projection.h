// From voxels to the pixels of a panel.
#pragma once

#include <algorithm>

#include "libevo/sim/model.h"
#include "render/painters/drawing.h"
#include "render/scene/options.h"

namespace evo::render {

// Every edge of a cell is covered by a line at least this wide, pixels: fills
// have jagged edges, lines smooth ones.
inline constexpr double least_line = 1.25;

struct Projection {
  Rect panel;
  double left, top;  // voxels at the panel's upper left corner
  double scale;      // pixels a voxel

  Projection(const ViewRect& view, const Rect& area)
      : panel(area),
        left(view.centre_x - view.width / 2),
        top(view.centre_y + view.height / 2),
        scale(static_cast<double>(area.width) / view.width) {}

  Point operator()(Vec2 p) const {
    return {panel.x + static_cast<float>((p.x - left) * scale),
            panel.y + static_cast<float>((top - p.y) * scale)};
  }
  float pixels(double voxels, double least) const {
    return static_cast<float>(std::max(voxels * scale, least));
  }
  double right() const { return left + panel.width / scale; }
  double low() const { return top - panel.height / scale; }
};

}  // namespace evo::render
