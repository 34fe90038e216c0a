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

void Drawing::band(std::vector<Point> upper, std::vector<Point> lower, Color color) {
  add(Band{std::move(upper), std::move(lower), color});
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
  struct Placed {
    decltype(point) point_of;
    decltype(rect) rect_of;
    float scale;
    Shape operator()(Polygon shape) const {
      for (Point& corner : shape.corners) corner = point_of(corner);
      return shape;
    }
    Shape operator()(Gradient shape) const {
      shape.area = rect_of(shape.area);
      return shape;
    }
    Shape operator()(Line shape) const {
      return Line{point_of(shape.from), point_of(shape.to), scale * shape.width, shape.color};
    }
    Shape operator()(Stroke shape) const {
      for (Point& p : shape.points) p = point_of(p);
      shape.width *= scale;
      return shape;
    }
    Shape operator()(RoundedRectangle shape) const {
      return RoundedRectangle{rect_of(shape.area), scale * shape.radius, shape.color};
    }
    Shape operator()(Band shape) const {
      for (auto* side : {&shape.upper, &shape.lower})
        for (Point& p : *side) p = point_of(p);
      return shape;
    }
  };
  const Placed placed{point, rect, scale};
  for (const Item& item : other.items_)
    items_.push_back({rect(item.clip), std::visit(placed, item.shape)});
  for (Text text : other.texts_) {
    text.at = point(text.at);
    text.size *= scale;
    texts_.push_back(std::move(text));
  }
}

}  // namespace evo::render
