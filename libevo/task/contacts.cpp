#include "libevo/task/contacts.h"

#include <algorithm>
#include <array>

#include "libevo/task/bounds.h"

namespace evo {
namespace {

constexpr double reach = 0.06;  // the benchmark's contact margin is 0.05

bool near(const Bounds& bounds, Vec2 p) {
  return p.x > bounds.x0 - reach && p.x < bounds.x1 + reach && p.y > bounds.y0 - reach &&
         p.y < bounds.y1 + reach;
}

bool near(const Bounds& a, const Bounds& b) {
  return b.x1 > a.x0 - reach && b.x0 < a.x1 + reach && b.y1 > a.y0 - reach && b.y0 < a.y1 + reach;
}

// Squared, so that the result needs no function of the C library.
double squared_distance_to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double square = dot(along, along);
  const double share = square > 0 ? std::clamp(dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  const Vec2 apart = p - a - along * share;
  return dot(apart, apart);
}

bool touches(Vec2 p, const std::array<Vec2, 4>& corners) {
  bool inside = false;
  for (std::size_t k = 0, last = 3; k < 4; last = k++) {
    const Vec2 a = corners[k];
    const Vec2 b = corners[last];
    if (squared_distance_to_segment(p, a, b) <= reach * reach) return true;
    if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x)
      inside = !inside;
  }
  return inside;
}

class Touch {
 public:
  Touch(std::span<const ModelCell> cells, std::span<const Vec2> points)
      : cells_(cells), points_(points) {}

  Bounds box(const ModelObject& object) const {
    Bounds box;
    for (int k = object.first_point; k < object.first_point + object.points; ++k) box.add(at(k));
    return box;
  }

  // Points of `of` that touch a cell of `other`.
  void add(const ModelObject& of, const ModelObject& other, std::vector<Vec2>& found) const {
    const Bounds own = box(of);
    if (!near(box(other), own)) return;
    std::vector<std::array<Vec2, 4>> cells;
    std::vector<Bounds> boxes;
    for (int c = other.first_cell; c < other.first_cell + other.cells; ++c) {
      const auto [tl, tr, bl, br] = cells_[static_cast<std::size_t>(c)].points;
      const std::array<Vec2, 4> corners{at(tl), at(tr), at(br), at(bl)};
      Bounds box;
      for (const Vec2& corner : corners) box.add(corner);
      if (!near(box, own)) continue;
      cells.push_back(corners);
      boxes.push_back(box);
    }
    for (int k = of.first_point; k < of.first_point + of.points; ++k) {
      const Vec2 p = at(k);
      for (std::size_t c = 0; c < cells.size(); ++c) {
        if (!near(boxes[c], p) || !touches(p, cells[c])) continue;
        found.push_back(p);
        break;
      }
    }
  }

 private:
  Vec2 at(int k) const { return points_[static_cast<std::size_t>(k)]; }
  std::span<const ModelCell> cells_;
  std::span<const Vec2> points_;
};

}  // namespace

Contacts contacts_of(std::span<const ModelObject> objects, std::span<const ModelCell> cells,
                     std::span<const Vec2> points) {
  const Touch touch(cells, points);
  const ModelObject& robot = objects.front();
  Contacts found;
  for (std::size_t k = 1; k < objects.size(); ++k) {
    if (objects[k].is_static) continue;
    const std::size_t before = found.points.size();
    touch.add(robot, objects[k], found.points);
    touch.add(objects[k], robot, found.points);
    if (found.points.size() > before) found.held.push_back(k);
  }
  std::vector<std::size_t> standing = found.held;
  standing.push_back(0);
  for (const std::size_t k : standing) {
    const ModelObject& object = objects[k];
    for (int p = object.first_point; p < object.first_point + object.points; ++p)
      if (points[static_cast<std::size_t>(p)].y <= reach)
        found.ground.push_back(points[static_cast<std::size_t>(p)]);
    for (const ModelObject& terrain : objects) {
      if (!terrain.is_static) continue;
      touch.add(object, terrain, found.ground);
      touch.add(terrain, object, found.ground);
    }
  }
  found.points.insert(found.points.end(), found.ground.begin(), found.ground.end());
  return found;
}

}  // namespace evo
