#include "render/painters/drawing.h"

#include "libevo/base/error.h"

namespace evo::render {

void check_size(Size size) {
  if (size.width < 1 || size.height < 1 || size.width > largest_side || size.height > largest_side)
    throw error(Failure::usage,
                "a picture of {}x{} pixels cannot be drawn: each side must be 1 to {}", size.width,
                size.height, largest_side);
}

void Drawing::triangle(const std::array<Point, 3>& corners, Color color) {
  add(Polygon{{corners[0], corners[1], corners[2], corners[2]}, 3, color});
}

void Drawing::quad(const std::array<Point, 4>& corners, Color color) {
  add(Polygon{corners, 4, color});
}

void Drawing::gradient(const Rect& area, Color top, Color bottom) {
  add(Gradient{area, top, bottom});
}

void Drawing::line(Point from, Point to, float width, Color color) {
  add(Line{from, to, width, color});
}

void Drawing::rounded_rectangle(const Rect& area, float radius, Color color) {
  add(RoundedRectangle{area, radius, color});
}

void Drawing::add(Shape shape) { items_.push_back({clip_, std::move(shape)}); }

void Drawing::segment(Point from, Point to, float width, Color color) {
  add(Stroke{{from, to}, false, width, color});
}

void Drawing::stroke(std::span<const Point> points, bool closed, float width, Color color) {
  if (points.size() < 2) return;
  add(Stroke{{points.begin(), points.end()}, closed, width, color});
}

}  // namespace evo::render
