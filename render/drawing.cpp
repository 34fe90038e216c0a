#include "render/drawing.h"

#include <algorithm>
#include <cmath>

namespace evo::render {
namespace {

constexpr float fringe = 0.5F;   // the smoothed border outside of a box, pixels
constexpr float endless = 1e6F;  // half length of a box without ends

Vertex plain(Point p, Color color) { return {p.x, p.y, 0, 0, 0, 0, 0, color}; }

float distance(Point a, Point b) { return std::hypot(b.x - a.x, b.y - a.y); }

Point direction(Point from, Point to) {
  const float length = distance(from, to);
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

}  // namespace

void Drawing::clip(const Rect& area) {
  clip_ = area;
  clip_changed_ = true;
}

std::vector<Vertex>& Drawing::batch(Kind kind) {
  if (clip_changed_ || batches_.back().kind != kind)
    batches_.push_back({kind, clip_, vertices_.size()});
  clip_changed_ = false;
  return vertices_;
}

void Drawing::triangle(const std::array<Point, 3>& corners, Color color) {
  auto& vertices = batch(Kind::fill);
  for (const Point& corner : corners) vertices.push_back(plain(corner, color));
}

void Drawing::quad(const std::array<Point, 4>& corners, Color color) {
  const auto& [a, b, c, d] = corners;
  // The diagonal a-c lies inside when b and d are on opposite sides of it.
  const bool split_ac = (cross(a, c, b) > 0) != (cross(a, c, d) > 0);
  if (split_ac) {
    triangle({a, b, c}, color);
    triangle({a, c, d}, color);
  } else {
    triangle({a, b, d}, color);
    triangle({b, c, d}, color);
  }
}

void Drawing::gradient(const Rect& area, Color top, Color bottom) {
  const float right = area.x + area.width;
  const float low = area.y + area.height;
  const Vertex a = plain({area.x, area.y}, top);
  const Vertex b = plain({right, area.y}, top);
  const Vertex c = plain({right, low}, bottom);
  const Vertex d = plain({area.x, low}, bottom);
  auto& vertices = batch(Kind::fill);
  vertices.insert(vertices.end(), {a, b, c, a, c, d});
}

void Drawing::line(Point from, Point to, float width, Color color) {
  const float length = distance(from, to);
  const Point along = length > 0 ? direction(from, to) : Point{1, 0};
  const float radius = std::max(width, 1.0F) / 2;
  box({(from.x + to.x) / 2, (from.y + to.y) / 2}, along, length / 2 + radius, radius, radius,
      thinned(color, width));
}

void Drawing::segment(Point from, Point to, float width, Color color) {
  const std::array<Point, 2> ends{from, to};
  stroke(ends, false, width, color);
}

void Drawing::stroke(std::span<const Point> points, bool closed, float width, Color color) {
  const std::size_t n = points.size();
  const std::size_t pieces = closed ? n : n - 1;
  if (n < 2) return;
  const float reach = std::max(width, 1.0F) / 2 + fringe;
  const auto unit = [&](std::size_t piece) {
    return direction(points[piece % n], points[(piece + 1) % n]);
  };
  for (std::size_t k = 0; k < pieces; ++k) {
    if (distance(points[k], points[(k + 1) % n]) == 0) continue;
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

void Drawing::band(Point a, Point b, Point c, Point d, float width, Color color) {
  const float half = std::max(width, 1.0F) / 2;
  const auto corner = [&](Point p, float side) {
    return Vertex{p.x, p.y, 0, side * (half + fringe), endless, half, 0, thinned(color, width)};
  };
  auto& vertices = batch(Kind::box);
  const Vertex va = corner(a, 1), vb = corner(b, 1), vc = corner(c, -1), vd = corner(d, -1);
  vertices.insert(vertices.end(), {va, vb, vc, va, vc, vd});
}

void Drawing::rounded_rectangle(const Rect& area, float radius, Color color) {
  box({area.x + area.width / 2, area.y + area.height / 2}, {1, 0}, area.width / 2, area.height / 2,
      radius, color);
}

void Drawing::box(Point centre, Point along, float half_length, float half_width, float radius,
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
  auto& vertices = batch(Kind::box);
  vertices.insert(vertices.end(), {a, b, c, a, c, d});
}

}  // namespace evo::render
