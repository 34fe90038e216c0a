// A picture as a list of what to paint, in pixels: x to the right, y downwards,
// (0, 0) the upper left corner of the upper left pixel. Plain data; painter.h
// turns it into pixels.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/image.h"

namespace evo::render {

struct Point {
  float x = 0;
  float y = 0;
};

struct Rect {
  float x = 0;
  float y = 0;
  float width = 0;
  float height = 0;
};

// A corner of a triangle, all of whose corners describe one rounded box by its
// half extents and corner radius; (u, v) is the corner in the box's own frame,
// the centre being (0, 0). The shader cuts the triangle at the border of the box
// and smooths it over one pixel. Lines and discs are such boxes with round ends;
// fills use position and colour only.
struct Vertex {
  float x, y;
  float u, v;
  float half_length, half_width, radius;
  Color color;
};

enum class Align { left, centre, right };

// One line of text, UTF-8, on the baseline through (x, y).
struct Text {
  Point at;
  float size = 12;  // pixels per em
  std::string text;
  Color color;
  Align align = Align::left;
  bool bold = false;
};

class Drawing {
 public:
  explicit Drawing(Size size) : size_(size), clip_(whole()) {}

  // Everything drawn from here on is cut at `area`.
  void clip(const Rect& area);

  // Fills cover what is below, whatever the alpha of their colour.
  void triangle(const std::array<Point, 3>& corners, Color color);
  // Corners in order around the border; concave ones are split along the
  // diagonal inside.
  void quad(const std::array<Point, 4>& corners, Color color);
  void rectangle(const Rect& area, Color color) { gradient(area, color, color); }
  void gradient(const Rect& area, Color top, Color bottom);
  // Lines: `width` in pixels, below one they get paler instead.
  void line(Point from, Point to, float width, Color color);  // round ends
  // Ends cut off square and not smoothed, for lines that go on or meet others.
  void segment(Point from, Point to, float width, Color color);
  // Through all points, with pointed corners; no pixel is painted twice, so that
  // joints do not show.
  void stroke(std::span<const Point> points, bool closed, float width, Color color);
  void disc(Point centre, float radius, Color color) { line(centre, centre, 2 * radius, color); }
  // `radius` at most half the smaller side.
  void rounded_rectangle(const Rect& area, float radius, Color color);
  void text(Text text) { texts_.push_back(std::move(text)); }

  // Triangles painted alike, one after the other, up to the next batch.
  enum class Kind { fill, box };
  struct Batch {
    Kind kind = Kind::fill;
    Rect clip;
    std::size_t first_vertex = 0;
  };
  Size size() const { return size_; }
  Rect whole() const {
    return {0, 0, static_cast<float>(size_.width), static_cast<float>(size_.height)};
  }
  const std::vector<Vertex>& vertices() const { return vertices_; }
  const std::vector<Batch>& batches() const { return batches_; }
  const std::vector<Text>& texts() const { return texts_; }

 private:
  // A box around `centre`; `along` is the unit vector of its length.
  void box(Point centre, Point along, float half_length, float half_width, float radius,
           Color color);
  // A quadrangle of a line: a and b on one side, c and d opposite to b and a.
  void band(Point a, Point b, Point c, Point d, float width, Color color);

  std::vector<Vertex>& batch(Kind kind);  // where to append

  Size size_;
  Rect clip_;
  bool clip_changed_ = true;
  std::vector<Vertex> vertices_;  // three a triangle
  std::vector<Batch> batches_;
  std::vector<Text> texts_;  // painted last, over everything
};

}  // namespace evo::render
