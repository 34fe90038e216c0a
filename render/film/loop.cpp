#include "render/film/loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/io/text.h"
#include "libevo/base/error.h"
#include "libevo/task/bounds.h"
#include "render/painters/vector.h"
#include "render/scene/moments.h"

namespace evo::render {
namespace {

struct Cycle {
  int first = 0;
  int period = 0;
};

// How far the shape at step a is from that at step b, each about its own centre; voxels squared.
double apart(const Clip& clip, int a, int b) {
  const ModelObject& robot = clip.mesh().objects.front();
  double sum = 0;
  for (int k = robot.first_point; k < robot.first_point + robot.points; ++k) {
    const auto p = static_cast<std::size_t>(k);
    const double x =
        (clip.points(b)[p].x - clip.centre(b).x) - (clip.points(a)[p].x - clip.centre(a).x);
    const double y = clip.points(b)[p].y - clip.points(a)[p].y;
    sum += x * x + y * y;
  }
  return sum / robot.points;
}

Cycle best_cycle(const Clip& clip, int from, int to) {
  const auto period = gait_period(clip, from, to);
  if (!period)
    throw Error(Failure::data,
                "the robot does not move in cycles, so there is none to repeat; --steps "
                "chooses the part of an episode in which it does");
  Cycle best{from, *period};
  double least = std::numeric_limits<double>::infinity();
  for (int t = from; t + *period <= to; ++t) {
    const double distance = apart(clip, t, t + *period);
    if (distance >= least) continue;
    least = distance;
    best.first = t;
  }
  return best;
}

// What moves with the robot: itself, and objects that stay within reach of it.
std::vector<const ModelObject*> company(const Clip& clip, const Cycle& cycle) {
  constexpr double reach = 6.0;  // voxels from centre to centre
  std::vector<const ModelObject*> result;
  for (const ModelObject& object : clip.mesh().objects) {
    if (object.is_static) continue;
    const Vec2 robot = clip.centre(cycle.first);
    const Vec2 corner = clip.points(cycle.first)[static_cast<std::size_t>(object.first_point)];
    if (&object == &clip.mesh().objects.front() ||
        std::hypot(corner.x - robot.x, corner.y - robot.y) < reach)
      result.push_back(&object);
  }
  return result;
}

// The height of what stands still below the way of the cycle.
double floor_of(const Clip& clip, const Bounds& way) {
  double top = 0.0;
  double low = std::numeric_limits<double>::infinity();
  for (const ModelObject& object : clip.mesh().objects) {
    if (!object.is_static) continue;
    for (int c = object.first_cell; c < object.first_cell + object.cells; ++c) {
      Bounds box;
      for (const int p : clip.mesh().cells[static_cast<std::size_t>(c)].points)
        box.add(clip.points(0)[static_cast<std::size_t>(p)]);
      if (box.x1 <= way.x0 || box.x0 >= way.x1) continue;
      top = std::max(top, box.y1);
      low = std::min(low, box.y1);
    }
  }
  if (std::isfinite(low) && top > way.y0 + 0.5)
    throw Error(Failure::data,
                "the ground below the cycle is not flat; --steps chooses another part");
  return top;
}

std::string tenths(double value) { return fmt::format("{:.1f}", value == 0 ? 0.0 : value); }

// The classes of fills, by the kind of voxel.
std::string fill_class(Voxel voxel, bool robot) {
  return fmt::format("{}{}", robot ? 'r' : 'o', letter(voxel));
}

std::string rules(const Theme& theme) {
  std::string text = fmt::format(
      ".p{{stroke:{};stroke-width:1;stroke-linejoin:round}}.s{{fill:{}}}.e{{fill:{}}}.m{{stroke:{}}"
      "}",
      hex(theme.outline), hex(theme.sky_bottom), hex(theme.fixed), hex(theme.fixed_outline));
  for (const Voxel voxel : {Voxel::rigid, Voxel::soft, Voxel::horizontal, Voxel::vertical})
    text += fmt::format(".{}{{fill:{}}}", fill_class(voxel, true), hex(color_of(theme, voxel)));
  for (const Voxel voxel : {Voxel::rigid, Voxel::soft})
    text +=
        fmt::format(".{}{{fill:{}}}", fill_class(voxel, false), hex(color_of_object(theme, voxel)));
  return text;
}

}  // namespace

std::string gait_loop(const Clip& clip, int from, int to, int width, const std::string& title) {
  const Cycle cycle = best_cycle(clip, from, to);
  const auto objects = company(clip, cycle);
  const int last = cycle.first + cycle.period;
  const double start = clip.centre(cycle.first).x;
  const double advance = clip.centre(last).x - start;
  // The camera goes on evenly, as fast as the robot does over a cycle.
  const auto camera = [&](int t) { return start + advance * (t - cycle.first) / cycle.period; };
  Bounds seen;
  Bounds way;
  for (int t = cycle.first; t <= last; ++t)
    for (const ModelObject* object : objects)
      for (int k = object->first_point; k < object->first_point + object->points; ++k) {
        const Vec2 p = clip.points(t)[static_cast<std::size_t>(k)];
        seen.add({p.x - camera(t), p.y});
        way.add(p);
      }
  const double ground = floor_of(clip, way);
  constexpr double margin = 1.5;  // voxels
  constexpr double earth = 1.0;
  const double left = seen.x0 - margin;
  const double across = seen.width() + 2 * margin;
  const double scale = width / across;
  const double high = std::max(seen.y1, ground + 1) + margin;
  const double height = (high - ground + earth) * scale;
  const auto x_of = [&](double x) { return (x - left) * scale; };
  const auto y_of = [&](double y) { return (high - y) * scale; };
  const std::string duration = fmt::format("{:.2f}s", clip.seconds(cycle.period));

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {:.0f}\" width=\"{}\" "
      "height=\"{:.0f}\" role=\"img\"><title>{}</title><style>{}@media(prefers-color-scheme:dark)"
      "{{{}}}</style><rect class=\"s\" width=\"100%\" height=\"100%\"/>"
      "<rect class=\"e\" y=\"{}\" width=\"100%\" height=\"100%\"/>",
      width, height, width, height, escaped(title), rules(theme_by_name("light")),
      rules(theme_by_name("dark")), tenths(y_of(ground)));
  // Marks on the floor, as far apart as the robot goes in a cycle, so that they meet.
  if (const double mark = std::abs(advance) * scale; mark > 4.0) {
    std::string path;
    for (double x = -mark; x < width + 2 * mark; x += mark)
      path += fmt::format("M{} {}v{}", tenths(x), tenths(y_of(ground)), tenths(0.4 * scale));
    svg += fmt::format(
        "<path class=\"m\" d=\"{}\"><animateTransform attributeName=\"transform\" "
        "type=\"translate\" from=\"0 0\" to=\"{} 0\" dur=\"{}\" "
        "repeatCount=\"indefinite\"/></path>",
        path, tenths(advance > 0 ? -mark : mark), duration);
  }
  for (const ModelObject* object : objects)
    for (int c = object->first_cell; c < object->first_cell + object->cells; ++c) {
      const ModelCell& cell = clip.mesh().cells[static_cast<std::size_t>(c)];
      std::string shapes;
      std::string first;
      constexpr std::array<std::size_t, 4> round{0, 1, 3, 2};  // corners, around the cell
      for (int t = cycle.first; t <= last; ++t) {
        std::string shape;
        for (const std::size_t corner : round) {
          // The last picture is the first, so that nothing jumps.
          const int at = t == last ? cycle.first : t;
          const Vec2 p = clip.points(at)[static_cast<std::size_t>(cell.points[corner])];
          shape += fmt::format("{}{},{}", shape.empty() ? "" : " ", tenths(x_of(p.x - camera(at))),
                               tenths(y_of(p.y)));
        }
        if (first.empty()) first = shape;
        shapes += (shapes.empty() ? "" : ";") + shape;
      }
      svg += fmt::format(
          "<polygon class=\"p {}\" points=\"{}\"><animate attributeName=\"points\" dur=\"{}\" "
          "repeatCount=\"indefinite\" values=\"{}\"/></polygon>",
          fill_class(cell.type, object == objects.front()), first, duration, shapes);
    }
  return svg + "</svg>\n";
}

}  // namespace evo::render
