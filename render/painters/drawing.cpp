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
  add(Polygon{{corners.begin(), corners.end()}, color});
}

void Drawing::quad(const std::array<Point, 4>& corners, Color color) {
  add(Polygon{{corners.begin(), corners.end()}, color});
}

void Drawing::gradient(const Rect& area, Color top, Color bottom) {
  add(Gradient{area, top, bottom});
}

void Drawing::line(Point from, Point to, float width, Color color) {
  add(Stroke{{from, to}, false, width, color, true});
}

void Drawing::rounded_rectangle(const Rect& area, float radius, Color color) {
  add(RoundedRectangle{area, radius, color});
}

void Drawing::band(std::span<const Point> upper, std::span<const Point> lower, Color color) {
  std::vector<Point> points(upper.begin(), upper.end());
  points.insert(points.end(), lower.rbegin(), lower.rend());
  add(Band{std::move(points), color});
}

void Drawing::add(Shape shape) { items_.push_back({clip_, std::move(shape)}); }

void Drawing::segment(Point from, Point to, float width, Color color) {
  add(Stroke{{from, to}, false, width, color});
}

void Drawing::stroke(std::span<const Point> points, bool closed, float width, Color color) {
  if (points.size() < 2) return;
  add(Stroke{{points.begin(), points.end()}, closed, width, color});
}

void Drawing::place(const Drawing& other, Point at, float scale) {
  const auto point = [&](Point p) { return Point{at.x + scale * p.x, at.y + scale * p.y}; };
  const auto rect = [&](const Rect& r) {
    return Rect{at.x + scale * r.x, at.y + scale * r.y, scale * r.width, scale * r.height};
  };
  const auto placed = [&](auto shape) -> Shape {
    if constexpr (requires { shape.points; })
      for (Point& p : shape.points) p = point(p);
    if constexpr (requires { shape.area; }) shape.area = rect(shape.area);
    if constexpr (requires { shape.width; }) shape.width *= scale;
    if constexpr (requires { shape.radius; }) shape.radius *= scale;
    return shape;
  };
  for (const Item& item : other.items_)
    items_.push_back({rect(item.clip), std::visit(placed, item.shape)});
  for (Text text : other.texts_) {
    text.at = point(text.at);
    text.size *= scale;
    texts_.push_back(std::move(text));
  }
}

}  // namespace evo::render
