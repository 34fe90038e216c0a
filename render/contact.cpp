#include "render/contact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/bounds.h"

namespace evo::render {
namespace {

constexpr double reach = 0.06;  // the benchmark's contact margin is 0.05

bool near(const Bounds& bounds, Vec2 p) {
  return p.x > bounds.x0 - reach && p.x < bounds.x1 + reach && p.y > bounds.y0 - reach &&
         p.y < bounds.y1 + reach;
}

bool near(const Bounds& a, const Bounds& b) {
  return b.x1 > a.x0 - reach && b.x0 < a.x1 + reach && b.y1 > a.y0 - reach && b.y0 < a.y1 + reach;
}

double distance_to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 along{b.x - a.x, b.y - a.y};
  const double length = along.x * along.x + along.y * along.y;
  const double share =
      length > 0 ? std::clamp(((p.x - a.x) * along.x + (p.y - a.y) * along.y) / length, 0.0, 1.0)
                 : 0.0;
  return std::hypot(p.x - a.x - share * along.x, p.y - a.y - share * along.y);
}

bool touches(Vec2 p, const std::array<Vec2, 4>& corners) {
  bool inside = false;
  for (std::size_t k = 0, last = 3; k < 4; last = k++) {
    const Vec2 a = corners[k];
    const Vec2 b = corners[last];
    if (distance_to_segment(p, a, b) <= reach) return true;
    if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x)
      inside = !inside;
  }
  return inside;
}

class World {
 public:
  World(const Mesh& mesh, std::span<const Vec2> points) : mesh_(mesh), points_(points) {}

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
      const auto [tl, tr, bl, br] = mesh_.cells[static_cast<std::size_t>(c)].points;
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
  const Mesh& mesh_;
  std::span<const Vec2> points_;
};

}  // namespace

Contacts contacts_of(const Mesh& mesh, std::span<const Vec2> points) {
  const World world(mesh, points);
  const ModelObject& robot = mesh.objects.front();
  Contacts found;
  for (std::size_t k = 1; k < mesh.objects.size(); ++k) {
    if (mesh.objects[k].is_static) continue;
    const std::size_t before = found.points.size();
    world.add(robot, mesh.objects[k], found.points);
    world.add(mesh.objects[k], robot, found.points);
    if (found.points.size() > before) found.held.push_back(k);
  }
  std::vector<std::size_t> standing = found.held;
  standing.push_back(0);
  for (const std::size_t k : standing) {
    const ModelObject& object = mesh.objects[k];
    for (int p = object.first_point; p < object.first_point + object.points; ++p)
      if (points[static_cast<std::size_t>(p)].y <= reach)
        found.ground.push_back(points[static_cast<std::size_t>(p)]);
    for (const ModelObject& terrain : mesh.objects) {
      if (!terrain.is_static) continue;
      world.add(object, terrain, found.ground);
      world.add(terrain, object, found.ground);
    }
  }
  found.points.insert(found.points.end(), found.ground.begin(), found.ground.end());
  return found;
}

Vec2 outside_force(std::span<const Vec2> centres, int step, const Physics& physics) {
  constexpr int around = 2;  // steps before and after; single ones tremble
  const int last = static_cast<int>(centres.size()) - 1;
  const int from = std::max(1, step - around);
  const int to = std::min(last - 1, step + around);
  if (to < from || physics.gravity <= 0) return {};
  const auto at = [&](int t) { return centres[static_cast<std::size_t>(t)]; };
  const double seconds = physics.substep * physics.substeps;  // raw time of a step
  const double count = to - from + 1;
  // The means of the accelerations and of the velocities from `from` to `to`.
  const auto mean = [&](auto of) {
    const double first = of(at(from)) - of(at(from - 1));
    const double end = of(at(to + 1)) - of(at(to));
    const double acceleration = (end - first) / count / (seconds * seconds);
    const double velocity = (of(at(to + 1)) - of(at(from - 1))) / (count + 1) / seconds;
    return physics.voxel_length * (acceleration + physics.drag * velocity) / physics.gravity;
  };
  return {mean([](Vec2 p) { return p.x; }), 1 + mean([](Vec2 p) { return p.y; })};
}

}  // namespace evo::render
