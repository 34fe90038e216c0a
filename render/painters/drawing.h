// A picture as a list of shapes to paint, one over the other, in pixels: x to the
// right, y downwards, (0, 0) the upper left corner of the upper left pixel. Plain
// data: painter.h turns it into pixels, vector.h into SVG and PDF.
#pragma once

#include <array>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "render/painters/image.h"

namespace evo::render {

// Largest side of a picture, pixels.
inline constexpr int largest_side = 8192;

// Throws Error(usage) unless both sides are in [1, largest_side].
void check_size(Size size);

struct Point {
  float x = 0;
  float y = 0;
  bool operator==(const Point&) const = default;
};

struct Rect {
  float x = 0;
  float y = 0;
  float width = 0;
  float height = 0;
  bool operator==(const Rect&) const = default;
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

// Fills cover what is below, whatever the alpha of their colour.
struct Polygon {  // three or four corners in order around the border
  std::vector<Point> points;
  Color color;
};
struct Gradient {  // downwards
  Rect area;
  Color top;
  Color bottom;
};
struct Stroke {  // through all points, pointed corners, square ends
  std::vector<Point> points;
  bool closed = false;
  float width = 1;  // pixels, below one it gets paler instead
  Color color;
  bool round = false;  // ends; two points, which may be one: a disc
};
struct RoundedRectangle {  // `radius` at most half the smaller side
  Rect area;
  float radius = 0;
  Color color;
};
struct Band {  // between two lines of as many points, translucent as its colour is
  // Of one line forwards, of the other backwards.
  std::vector<Point> points;
  Color color;
};
using Shape = std::variant<Polygon, Gradient, Stroke, RoundedRectangle, Band>;

class Drawing {
 public:
  explicit Drawing(Size size) : size_(size), clip_(whole()) {}

  // Everything drawn from here on is cut at `area`.
  void clip(const Rect& area) { clip_ = area; }

  void triangle(const std::array<Point, 3>& corners, Color color);
  // Concave ones are split along the diagonal inside.
  void quad(const std::array<Point, 4>& corners, Color color);
  void rectangle(const Rect& area, Color color) { gradient(area, color, color); }
  void gradient(const Rect& area, Color top, Color bottom);
  void line(Point from, Point to, float width, Color color);
  // Ends cut off square and not smoothed, for lines that continue or meet others.
  void segment(Point from, Point to, float width, Color color);
  // No pixel is painted twice, so that joints do not show.
  void stroke(std::span<const Point> points, bool closed, float width, Color color);
  void disc(Point centre, float radius, Color color) { line(centre, centre, 2 * radius, color); }
  void rounded_rectangle(const Rect& area, float radius, Color color);
  void band(std::span<const Point> upper, std::span<const Point> lower, Color color);
  void text(Point at, float size, std::string text, Color color, Align align = Align::left,
            bool bold = false) {
    texts_.push_back({at, size, std::move(text), color, align, bold});
  }
  // All of another drawing, its upper left corner at `at`, everything `scale` times as large.
  void place(const Drawing& other, Point at, float scale);

  struct Item {
    Rect clip;
    Shape shape;
  };
  Size size() const { return size_; }
  Rect whole() const {
    return {0, 0, static_cast<float>(size_.width), static_cast<float>(size_.height)};
  }
  const std::vector<Item>& items() const { return items_; }
  const std::vector<Text>& texts() const { return texts_; }  // painted last, never cut

 private:
  void add(Shape shape);

  Size size_;
  Rect clip_;
  std::vector<Item> items_;
  std::vector<Text> texts_;
};

}  // namespace evo::render
