#include "render/film/loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <ranges>
#include <span>
#include <tuple>

#include "formats/io/text.h"
#include "render/painters/vector.h"
#include "render/scene/moments.h"
#include "render/scene/objects.h"

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
  const auto before = clip.points(a, robot);
  const auto after = clip.points(b, robot);
  double sum = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const double x = (after[k].x - clip.centre(b).x) - (before[k].x - clip.centre(a).x);
    const double y = after[k].y - before[k].y;
    sum += x * x + y * y;
  }
  return sum / robot.points;
}

// Whether an object is the robot or within its reach.
bool is_company(const Clip& clip, const ModelObject& object, int step) {
  constexpr double reach = 6.0;  // voxels from the centre of the one to a corner of the other
  const Vec2 corner = clip.points(step)[static_cast<std::size_t>(object.first_point)];
  return &object == &clip.mesh().objects.front() ||
         (!object.is_static && distance(corner, clip.centre(step)) < reach);
}

// The places of the cells of what stands still.
template <typename Visit>
void for_each_still_cell(const Clip& clip, const Visit& visit) {
  for (const ModelObject& object : clip.mesh().objects)
    for (int c = object.first_cell; object.is_static && c < object.first_cell + object.cells; ++c) {
      const ModelCell& cell = clip.mesh().cells[static_cast<std::size_t>(c)];
      Bounds box;
      for (const int p : cell.points) box.add(clip.points(0)[static_cast<std::size_t>(p)]);
      visit(box);
    }
}

// The height of what stands still below the robot's way; nothing where that is not flat, or the
// robot is on something else.
std::optional<double> floor_below(const Clip& clip, const Stretch& stretch) {
  Bounds way;
  for (int t = stretch.first; t <= stretch.last; ++t)
    way.cover(clip.extent(t, clip.mesh().objects.front()));
  double top = 0.0;
  for_each_still_cell(clip, [&](const Bounds& box) {
    if (box.x1 > way.x0 && box.x0 < way.x1) top = std::max(top, box.y1);
  });
  if (std::abs(top - way.y0) > 0.5) return std::nullopt;
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

// Where most moves in two seconds, or until the robot is eight voxels away.
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
  while (distance(clip.centre(best.first), clip.centre(best.last)) > 8.0) --best.last;
  return best;
}

std::string tenths(double value) { return fmt::format("{:.1f}", value == 0 ? 0.0 : value); }

// The classes of fills, by the kind of voxel.
std::string fill_class(Voxel voxel, bool robot) {
  if (voxel == Voxel::fixed) return "w";
  return fmt::format("{}{}", robot ? 'r' : 'o', letter(voxel));
}

std::string line_rule(const char* name, Color color, double width) {
  return fmt::format(".{}{{fill:none;stroke:{};stroke-opacity:{:.2f};stroke-width:{:.1f}}}", name,
                     hex(color), color.a / 255.0, std::max(1.0, width));
}

std::string rules(const Theme& theme, double scale) {
  std::string text = line_rule("c", theme.seam, seam_width * scale) +
                     line_rule("l", theme.outline, outline_width * scale) +
                     line_rule("f", theme.fixed_outline, terrain_outline_width * scale) +
                     line_rule("g", theme.grid_minor, 1.0);
  const auto add = [&](const std::string& name, const char* property, Color color) {
    text += fmt::format(".{}{{{}:{}}}", name, property, hex(color));
  };
  add("s", "stop-color", theme.sky_top);
  add("t", "stop-color", theme.sky_bottom);
  add("e", "stop-color", theme.earth_top);
  add("b", "stop-color", theme.earth_bottom);
  add("w", "fill", theme.fixed);
  for (const Voxel voxel : {Voxel::rigid, Voxel::soft, Voxel::horizontal, Voxel::vertical})
    add(fill_class(voxel, true), "fill", color_of(theme, voxel));
  for (const Voxel voxel : {Voxel::rigid, Voxel::soft})
    add(fill_class(voxel, false), "fill", color_of_object(theme, voxel));
  return text;
}

// One loop: what is repeated, how it is seen, and its parts as SVG.
class Loop {
 public:
  Loop(const Clip& clip, int from, int to, Size size)
      : clip_(clip),
        size_(size),
        cycle_(best_cycle(clip, from, to)),
        stretch_(cycle_ ? *cycle_ : liveliest(clip, from, to)),
        start_(clip.centre(stretch_.first).x),
        advance_(cycle_ ? clip.centre(stretch_.last).x - start_ : 0.0),
        ground_(cycle_ ? *floor_below(clip, stretch_) : 0.0) {
    const int stride = cycle_ ? 1 : 2;
    for (int t = stretch_.first; t == stretch_.first || t < stretch_.last; t += stride)
      steps_.push_back(t);
    for (std::size_t k = steps_.size(); stretch_.back && k-- > 1;) steps_.push_back(steps_[k - 1]);
    if (cycle_) steps_.push_back(stretch_.first);
    duration_ = fmt::format("{:.2f}s", clip.seconds(stride * static_cast<int>(steps_.size() - 1)));

    Bounds seen;
    for (int t = stretch_.first; t <= stretch_.last; ++t)
      for (const ModelObject& each : clip.mesh().objects) {
        if (!is_company(clip, each, t)) continue;
        const Bounds box = clip.extent(t, each);
        seen.add({box.x0 - camera(t), box.y0});
        seen.add({box.x1 - camera(t), box.y1});
      }
    constexpr double margin = 1.0;
    constexpr double earth = 1.6;
    const double lowest = cycle_ ? ground_ - earth : std::max(seen.y0 - margin, -earth);
    const double highest = std::max(seen.y1, ground_ + 1) + margin;
    scale_ = std::min(size.width / (seen.width() + 2 * margin), size.height / (highest - lowest));
    left_ = (seen.x0 + seen.x1 - size.width / scale_) / 2;
    // What is not used is sky, or on both sides where no floor is seen.
    const double spare = size.height / scale_ - (highest - lowest);
    low_ = cycle_ ? lowest : std::max(lowest - spare / 2, -earth);
  }

  std::string svg(const std::string& title) const {
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
        "height=\"{1}\" role=\"img\"><title>{2}</title><style>svg{{stroke-linejoin:round}}{3}"
        "@media(prefers-color-scheme:dark){{{4}}}</style>",
        size_.width, size_.height, escaped(title), rules(theme_by_name("light"), scale_),
        rules(theme_by_name("dark"), scale_));
    for (const auto& [name, end, y] :
         {std::tuple{"s", "t", 0.0}, std::tuple{"e", "b", std::max(0.0, y_of(0))}})
      svg += fmt::format(
          "<linearGradient id=\"{0}\" x2=\"0\" y2=\"1\"><stop class=\"{0}\"/><stop class=\"{1}\" "
          "offset=\"1\"/></linearGradient><rect fill=\"url(#{0})\" y=\"{2}\" width=\"100%\" "
          "height=\"{3}\"/>",
          name, end, tenths(y), tenths(std::max(0.0, size_.height - y)));
    svg += grid("g", std::max(0.0, std::ceil(low_)), top());
    if (ground_ > 0)
      svg += fmt::format("<path class=\"f w\" d=\"M-9 {}H{}V{}H-9z\"/>{}", tenths(y_of(ground_)),
                         size_.width + 9, tenths(y_of(0)), grid("c", 0, ground_));
    for (const ModelObject& each : clip_.mesh().objects | std::views::reverse)
      if (!cycle_ || is_company(clip_, each, stretch_.first)) svg += object(each);
    return svg + "</svg>\n";
  }

 private:
  // The camera moves evenly, as fast as the robot does over a cycle; else it stands still.
  double camera(int t) const {
    return start_ + advance_ * (t - stretch_.first) / std::max(1, stretch_.last - stretch_.first);
  }
  double x_of(double x) const { return (x - left_) * scale_; }
  double y_of(double y) const { return size_.height - (y - low_) * scale_; }
  double top() const { return low_ + size_.height / scale_; }

  // At the start, or nearly.
  bool is_seen(int point) const {
    const Vec2 p = clip_.points(stretch_.first)[static_cast<std::size_t>(point)];
    const double margin = 2 * scale_;
    return x_of(p.x - start_) > -margin && x_of(p.x - start_) < size_.width + margin &&
           y_of(p.y) > -margin && y_of(p.y) < size_.height + margin;
  }

  std::string points(std::span<const int> points, int at, double shift) const {
    std::string text;
    for (const int k : points) {
      const Vec2 p = clip_.points(at)[static_cast<std::size_t>(k)];
      text += fmt::format("{}{},{}", text.empty() ? "" : " ", tenths(x_of(p.x - shift)),
                          tenths(y_of(p.y)));
    }
    return text;
  }

  // Squares of about a voxel. A cycle takes them on by whole ones, so that they meet.
  std::string grid(const char* name, double from, double to) const {
    const double squares = std::max(1.0, std::round(std::abs(advance_)));
    const double square = cycle_ ? std::abs(advance_) / squares : 1.0;
    std::string path;
    for (double y = from; y < to; ++y)
      path += fmt::format("M{} {}H{}", -size_.width, tenths(y_of(y)), 2 * size_.width);
    const double first = cycle_ ? left_ - squares * square : std::ceil(start_ + left_) - start_;
    const double last = left_ + size_.width / scale_ + squares * square;
    for (double x = first; square > 0.5 && x < last; x += square)
      path += fmt::format("M{} {}V{}", tenths(x_of(x)), tenths(y_of(from)), tenths(y_of(to)));
    return fmt::format(
        "<path class=\"{}\" d=\"{}\"><animateTransform attributeName=\"transform\" "
        "type=\"translate\" from=\"0 0\" to=\"{} 0\" dur=\"{}\" repeatCount=\"indefinite\"/>"
        "</path>",
        name, path, tenths(-advance_ * scale_), duration_);
  }

  // Animates an attribute over the pictures.
  std::string animated(const char* attribute, const std::function<std::string(int)>& value) const {
    std::string values;
    for (const int t : steps_) values += (values.empty() ? "" : ";") + value(t);
    return fmt::format(
        "<animate attributeName=\"{}\" dur=\"{}\" repeatCount=\"indefinite\" values=\"{}\"/>",
        attribute, duration_, values);
  }

  std::string shape(const std::string& name, std::span<const int> corners, bool closed, bool still,
                    const std::string& more = "") const {
    if (corners.size() < 2) return "";
    const std::string motion =
        still ? "" : animated("points", [&](int t) { return points(corners, t, camera(t)); });
    return fmt::format("<poly{0} class=\"{1}\" points=\"{2}\">{3}{4}</poly{0}>",
                       closed ? "gon" : "line", name, points(corners, steps_.front(), start_),
                       motion, more);
  }

  std::string object(const ModelObject& object) const {
    const Mesh& mesh = clip_.mesh();
    const bool robot = &object == &mesh.objects.front();
    std::string svg;
    for (int c = object.first_cell; c < object.first_cell + object.cells; ++c) {
      const ModelCell& cell = mesh.cells[static_cast<std::size_t>(c)];
      const auto corner = [&](int t, std::size_t k) {
        return clip_.points(t)[static_cast<std::size_t>(cell.points[k])];
      };
      if (!is_seen(cell.points[0])) continue;
      const auto tint = [&](int t) {
        return hex(tinted(color_of(theme_by_name("light"), cell.type), cell.type,
                          {corner(t, 0), corner(t, 1), corner(t, 2), corner(t, 3)}));
      };
      const auto [tl, tr, bl, br] = cell.points;
      svg += shape("c " + fill_class(cell.type, robot), std::array{tl, tr, br, bl}, true,
                   object.is_static, robot && is_actuator(cell.type) ? animated("fill", tint) : "");
    }
    // Outlines, as far as they are seen.
    for (const Mesh::Outline& line :
         mesh.outlines[static_cast<std::size_t>(&object - mesh.objects.data())]) {
      const char* name = line.fixed ? "f" : "l";
      std::vector<int> part;
      for (const int k : line.points) {
        if (is_seen(k)) part.push_back(k);
        if (is_seen(k) || part.empty()) continue;
        svg += shape(name, part, false, object.is_static);
        part.clear();
      }
      svg += shape(name, part, line.closed && part.size() == line.points.size(), object.is_static);
    }
    return svg;
  }

  const Clip& clip_;
  Size size_;
  std::optional<Stretch> cycle_;
  Stretch stretch_;
  std::vector<int> steps_;  // picture by picture: the last is the first, so that nothing jumps
  std::string duration_;
  double start_;
  double advance_;  // in a cycle
  double ground_;
  double left_;  // from the camera; voxels, as all of these
  double low_;
  double scale_;
};

}  // namespace

std::string gait_loop(const Clip& clip, int from, int to, Size size, const std::string& title) {
  return Loop(clip, from, to, size).svg(title);
}

}  // namespace evo::render
