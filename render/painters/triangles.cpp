#include "render/painters/triangles.h"

#include <algorithm>
#include <cmath>

namespace evo::render {
namespace {

constexpr float fringe = 0.5F;   // the smoothed border outside of a box, pixels
constexpr float endless = 1e6F;  // half length of a box without ends

Vertex plain(Point p, Color color) { return {p.x, p.y, 0, 0, 0, 0, 0, color}; }

float length_between(Point a, Point b) { return std::hypot(b.x - a.x, b.y - a.y); }

Point direction(Point from, Point to) {
  const float length = length_between(from, to);
  return length > 0 ? Point{(to.x - from.x) / length, (to.y - from.y) / length} : Point{0, 0};
}

Color thinned(Color color, float width) {
  if (width < 1) color.a = static_cast<std::uint8_t>(std::lround(color.a * width));
  return color;
}

// From a corner of a line to where the borders of both pieces, `reach` away from
// them, meet. Sharper corners than `longest` allows are cut short.
Point corner_offset(Point before, Point after, float reach) {
  constexpr float longest = 2.0F;  // of the reach
  Point middle{-(before.y + after.y), before.x + after.x};
  const float length = std::hypot(middle.x, middle.y);
  if (length < 1e-3F) return {-before.y * reach, before.x * reach};  // a hairpin
  middle = {middle.x / length, middle.y / length};
  const float cosine = middle.x * -before.y + middle.y * before.x;
  const float stretch = std::min(longest, 1.0F / std::max(cosine, 1e-3F)) * reach;
  return {middle.x * stretch, middle.y * stretch};
}

// Twice the signed area of the triangle a, b, c.
float cross(Point a, Point b, Point c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Appends shapes as triangles.
class Builder {
 public:
  explicit Builder(Triangles& out) : out_(out) {}

  void clip(const Rect& area) { clip_ = area; }

  void operator()(const Polygon& shape) {
    const Point a = shape.points[0], b = shape.points[1], c = shape.points[2];
    if (shape.points.size() == 3) return triangle(a, b, c, shape.color);
    const Point d = shape.points[3];
    // The diagonal a-c lies inside when b and d are on opposite sides of it.
    const bool split_ac = (cross(a, c, b) > 0) != (cross(a, c, d) > 0);
    if (split_ac) {
      triangle(a, b, c, shape.color);
      triangle(a, c, d, shape.color);
    } else {
      triangle(a, b, d, shape.color);
      triangle(b, c, d, shape.color);
    }
  }

  void operator()(const Gradient& shape) {
    const Rect& area = shape.area;
    const float right = area.x + area.width;
    const float low = area.y + area.height;
    const Vertex a = plain({area.x, area.y}, shape.top);
    const Vertex b = plain({right, area.y}, shape.top);
    const Vertex c = plain({right, low}, shape.bottom);
    const Vertex d = plain({area.x, low}, shape.bottom);
    auto& vertices = batch(Triangles::Kind::fill);
    vertices.insert(vertices.end(), {a, b, c, a, c, d});
  }

  void operator()(const Stroke& shape) {
    const auto& [points, closed, width, color, round] = shape;
    if (round) return rounded_line(points.front(), points.back(), width, color);
    const std::size_t n = points.size();
    const std::size_t pieces = closed ? n : n - 1;
    const float reach = std::max(width, 1.0F) / 2 + fringe;
    const auto unit = [&](std::size_t piece) {
      return direction(points[piece % n], points[(piece + 1) % n]);
    };
    for (std::size_t k = 0; k < pieces; ++k) {
      if (length_between(points[k], points[(k + 1) % n]) == 0) continue;
      const Point here = unit(k);
      const bool first = k == 0 && !closed;
      const bool last = k + 1 == pieces && !closed;
      const Point start = corner_offset(first ? here : unit((k + n - 1) % n), here, reach);
      const Point end = corner_offset(here, last ? here : unit(k + 1), reach);
      const Point p = points[k];
      const Point q = points[(k + 1) % n];
      band({p.x + start.x, p.y + start.y}, {q.x + end.x, q.y + end.y}, {q.x - end.x, q.y - end.y},
           {p.x - start.x, p.y - start.y}, width, color);
    }
  }

  void operator()(const RoundedRectangle& shape) {
    const Rect& area = shape.area;
    box({area.x + area.width / 2, area.y + area.height / 2}, {1, 0}, area.width / 2,
        area.height / 2, shape.radius, shape.color);
  }

  void operator()(const Band& shape) {
    const auto& points = shape.points;
    const std::size_t last = points.size() - 1;  // opposite the first
    for (std::size_t k = 0; 2 * (k + 1) < points.size(); ++k) {
      triangle(points[k], points[k + 1], points[last - k], shape.color);
      triangle(points[k + 1], points[last - k - 1], points[last - k], shape.color);
    }
  }

 private:
  // Where to append.
  std::vector<Vertex>& batch(Triangles::Kind kind) {
    auto& batches = out_.batches;
    if (batches.empty() || batches.back().kind != kind || batches.back().clip != clip_)
      batches.push_back({kind, clip_, out_.vertices.size()});
    return out_.vertices;
  }

  void triangle(Point a, Point b, Point c, Color color) {
    auto& vertices = batch(Triangles::Kind::fill);
    for (const Point& corner : {a, b, c}) vertices.push_back(plain(corner, color));
  }

  void rounded_line(Point from, Point to, float width, Color color) {
    const float length = length_between(from, to);
    const Point along = length > 0 ? direction(from, to) : Point{1, 0};
    const float radius = std::max(width, 1.0F) / 2;
    box({(from.x + to.x) / 2, (from.y + to.y) / 2}, along, length / 2 + radius, radius, radius,
        thinned(color, width));
  }

  // A quadrangle of a line: a and b on one side, c and d opposite to b and a.
  void band(Point a, Point b, Point c, Point d, float width, Color color) {
    const float half = std::max(width, 1.0F) / 2;
    const auto corner = [&](Point p, float side) {
      return Vertex{p.x, p.y, 0, side * (half + fringe), endless, half, 0, thinned(color, width)};
    };
    auto& vertices = batch(Triangles::Kind::box);
    const Vertex va = corner(a, 1), vb = corner(b, 1), vc = corner(c, -1), vd = corner(d, -1);
    vertices.insert(vertices.end(), {va, vb, vc, va, vc, vd});
  }

  // A box around `centre`; `along` is the unit vector of its length.
  void box(Point centre, Point along, float half_length, float half_width, float radius,
           Color color) {
    const float u = half_length + fringe;
    const float v = half_width + fringe;
    const auto corner = [&](float su, float sv) {
      return Vertex{centre.x + along.x * su - along.y * sv,
                    centre.y + along.y * su + along.x * sv,
                    su,
                    sv,
                    half_length,
                    half_width,
                    radius,
                    color};
    };
    const Vertex a = corner(-u, -v);
    const Vertex b = corner(u, -v);
    const Vertex c = corner(u, v);
    const Vertex d = corner(-u, v);
    auto& vertices = batch(Triangles::Kind::box);
    vertices.insert(vertices.end(), {a, b, c, a, c, d});
  }

  Triangles& out_;
  Rect clip_;
};

}  // namespace

Triangles triangulate(const Drawing& drawing) {
  Triangles triangles;
  Builder builder(triangles);
  for (const Drawing::Item& item : drawing.items()) {
    builder.clip(item.clip);
    std::visit(builder, item.shape);
  }
  return triangles;
}

}  // namespace evo::render
