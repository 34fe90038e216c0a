#include "render/film/loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "formats/io/text.h"
#include "libevo/task/bounds.h"
#include "render/painters/vector.h"
#include "render/scene/moments.h"

namespace evo::render {
namespace {

// What is repeated: steps `first` to `last`, which look alike, or, there and back, do not.
struct Stretch {
  int first = 0;
  int last = 0;
  bool back = false;
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

// What moves with the robot: itself, and objects that stay within reach of it.
std::vector<const ModelObject*> company(const Clip& clip, int step) {
  constexpr double reach = 6.0;  // voxels from centre to centre
  std::vector<const ModelObject*> result;
  for (const ModelObject& object : clip.mesh().objects) {
    if (object.is_static) continue;
    const Vec2 corner = clip.points(step)[static_cast<std::size_t>(object.first_point)];
    if (&object == &clip.mesh().objects.front() || distance(corner, clip.centre(step)) < reach)
      result.push_back(&object);
  }
  return result;
}

Bounds place_of(const Clip& clip, const ModelObject& object, int step) {
  Bounds box;
  for (int k = object.first_point; k < object.first_point + object.points; ++k)
    box.add(clip.points(step)[static_cast<std::size_t>(k)]);
  return box;
}

// The cells of what stands still, each with its corners.
template <typename Visit>
void for_each_still_cell(const Clip& clip, const Visit& visit) {
  for (const ModelObject& object : clip.mesh().objects)
    for (int c = object.first_cell; object.is_static && c < object.first_cell + object.cells; ++c) {
      const ModelCell& cell = clip.mesh().cells[static_cast<std::size_t>(c)];
      Bounds box;
      for (const int p : cell.points) box.add(clip.points(0)[static_cast<std::size_t>(p)]);
      visit(cell, box);
    }
}

// The height of what stands still below the robot's way; nothing where that is not flat.
std::optional<double> floor_below(const Clip& clip, const Stretch& stretch) {
  Bounds way;
  for (int t = stretch.first; t <= stretch.last; ++t) {
    const Bounds box = place_of(clip, clip.mesh().objects.front(), t);
    way.add({box.x0, box.y0});
    way.add({box.x1, box.y1});
  }
  double top = 0.0;
  double low = std::numeric_limits<double>::infinity();
  for_each_still_cell(clip, [&](const ModelCell&, const Bounds& box) {
    if (box.x1 <= way.x0 || box.x0 >= way.x1) return;
    top = std::max(top, box.y1);
    low = std::min(low, box.y1);
  });
  if (std::isfinite(low) && top > way.y0 + 0.5) return std::nullopt;
  return top;
}

// The cycle over flat ground that ends nearest to how it began, in any part of the steps in
// which the robot has a gait.
std::optional<Stretch> best_cycle(const Clip& clip, int from, int to) {
  constexpr int part = 120;  // steps
  std::vector<Stretch> parts{{from, to}};
  for (int first = from; to - from > part && first + part <= to; first += part / 2)
    parts.push_back({first, first + part});
  std::optional<Stretch> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Stretch& each : parts) {
    const auto period = gait_period(clip, each.first, each.last);
    if (!period) continue;
    for (int t = each.first; t + *period <= each.last; ++t) {
      const Stretch cycle{t, t + *period};
      const double difference = apart(clip, cycle.first, cycle.last);
      if (difference >= least || !floor_below(clip, cycle)) continue;
      least = difference;
      best = cycle;
    }
  }
  return best;
}

// Where most moves in two seconds.
Stretch liveliest(const Clip& clip, int from, int to) {
  const int steps = std::min(to - from, static_cast<int>(std::lround(2 * clip.steps_per_second())));
  const auto moved = [&](int t) {
    return apart(clip, t, t + 1) + std::pow(distance(clip.centre(t), clip.centre(t + 1)), 2);
  };
  double sum = 0;
  for (int t = from; t < from + steps; ++t) sum += moved(t);
  Stretch best{from, from + steps, true};
  double most = sum;
  for (int t = from; t + steps < to; ++t) {
    sum += moved(t + steps) - moved(t);
    if (sum <= most) continue;
    most = sum;
    best = {t + 1, t + 1 + steps, true};
  }
  return best;
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

std::string gait_loop(const Clip& clip, int from, int to, Size size, const std::string& title) {
  const auto cycle = best_cycle(clip, from, to);
  const Stretch stretch = cycle ? *cycle : liveliest(clip, from, to);
  const auto objects = company(clip, stretch.first);
  // A camera that moves evenly, as fast as the robot does over a cycle; else it stands still.
  const double start = clip.centre(stretch.first).x;
  const double advance = cycle ? clip.centre(stretch.last).x - start : 0.0;
  const auto camera = [&](int t) {
    return start + advance * (t - stretch.first) / std::max(1, stretch.last - stretch.first);
  };
  // What is shown, picture by picture: the last is the first, so that nothing jumps.
  constexpr int stride = 2;  // there and back
  std::vector<int> steps;
  for (int t = stretch.first; t == stretch.first || t < stretch.last; t += cycle ? 1 : stride)
    steps.push_back(t);
  for (std::size_t k = steps.size(); stretch.back && k-- > 1;) steps.push_back(steps[k - 1]);
  if (cycle) steps.push_back(stretch.first);
  const std::string duration = fmt::format(
      "{:.2f}s", clip.seconds((cycle ? 1 : stride) * static_cast<int>(steps.size() - 1)));

  Bounds seen;
  for (int t = stretch.first; t <= stretch.last; ++t)
    for (const ModelObject* object : objects) {
      const Bounds box = place_of(clip, *object, t);
      seen.add({box.x0 - camera(t), box.y0});
      seen.add({box.x1 - camera(t), box.y1});
    }
  constexpr double margin = 1.5;  // voxels
  constexpr double earth = 1.0;
  const double ground = cycle ? *floor_below(clip, stretch) : 0.0;
  const double low = cycle ? ground - earth : std::max(seen.y0 - margin, -earth);
  const double left = seen.x0 - margin;
  const double high = std::max(seen.y1, ground + 1) + margin;
  const double columns = seen.width() + 2 * margin;
  const double scale = std::min(size.width / columns, size.height / (high - low));
  const double width = columns * scale;
  const double height = (high - low) * scale;
  const auto x_of = [&](double x) { return (x - left) * scale; };
  const auto y_of = [&](double y) { return (high - y) * scale; };

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" "
      "height=\"{:.0f}\" role=\"img\"><title>{}</title><style>{}@media(prefers-color-scheme:dark)"
      "{{{}}}</style><rect class=\"s\" width=\"100%\" height=\"100%\"/>"
      "<rect class=\"e\" y=\"{}\" width=\"100%\" height=\"100%\"/>",
      width, height, width, height, escaped(title), rules(theme_by_name("light")),
      rules(theme_by_name("dark")), tenths(y_of(ground)));
  const auto polygon = [&](const ModelCell& cell, int at, double shift) {
    constexpr std::array<std::size_t, 4> round{0, 1, 3, 2};  // corners, around the cell
    std::string shape;
    for (const std::size_t corner : round) {
      const Vec2 p = clip.points(at)[static_cast<std::size_t>(cell.points[corner])];
      shape += fmt::format("{}{},{}", shape.empty() ? "" : " ", tenths(x_of(p.x - shift)),
                           tenths(y_of(p.y)));
    }
    return shape;
  };
  if (!cycle)
    for_each_still_cell(clip, [&](const ModelCell& cell, const Bounds& box) {
      if (box.x1 - start > left && x_of(box.x0 - start) < width && box.y1 > low)
        svg += fmt::format("<polygon class=\"p e\" points=\"{}\"/>", polygon(cell, 0, start));
    });
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
      for (const int t : steps) shapes += (shapes.empty() ? "" : ";") + polygon(cell, t, camera(t));
      svg += fmt::format(
          "<polygon class=\"p {}\" points=\"{}\"><animate attributeName=\"points\" dur=\"{}\" "
          "repeatCount=\"indefinite\" values=\"{}\"/></polygon>",
          fill_class(cell.type, object == objects.front()),
          polygon(cell, steps.front(), camera(steps.front())), duration, shapes);
    }
  return svg + "</svg>\n";
}

}  // namespace evo::render
