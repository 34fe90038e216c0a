#include "render/figures/strip.h"

#include <algorithm>
#include <cmath>

#include "libevo/task/spec.h"
#include "render/figures/key.h"
#include "render/figures/label.h"
#include "render/figures/legend.h"
#include "render/painters/drawing.h"
#include "render/scene/projection.h"

namespace evo::render {
namespace {

// The way of the robot's centre between two steps.
Bounds way(const Clip& clip, int from, int to) {
  Bounds extent;
  for (int t = from; t <= to; ++t) extent.add(clip.centre(t));
  return extent;
}

bool climbs(const Bounds& way) {
  constexpr double far = 4.0;  // voxels
  return way.height() > way.width() && way.height() > far;
}

// How high what hangs over the way reaches, if it begins no more than a few voxels above it:
// of a cave, the ceiling with its upper edge, as far as that is no tower.
double ceiling(const Clip& clip, const Bounds& extent) {
  constexpr double near = 3.0;  // voxels
  constexpr double most = 4.0;
  double top = extent.y1;
  const auto points = clip.points(0);
  for (const ModelCell& cell : clip.mesh().cells) {
    Bounds box;
    for (const int p : cell.points) box.add(points[static_cast<std::size_t>(p)]);
    const bool over = box.x1 > extent.x0 && box.x0 < extent.x1 && box.y0 < extent.y1 + near;
    if (over) top = std::max(top, std::min(box.y1, extent.y1 + most));
  }
  return top;
}

// ---- what to draw -----------------------------------------------------------------------

Vec2 middle_of(const Clip& clip, int step, const ModelObject& object) {
  const Bounds extent = clip.extent(step, object);
  return {(extent.x0 + extent.x1) / 2, (extent.y0 + extent.y1) / 2};
}

// The way of the middle of an object between two steps.
Bounds way_of(const Clip& clip, int from, int to, const ModelObject& object) {
  Bounds extent;
  for (int t = from; t <= to; ++t) extent.add(middle_of(clip, t, object));
  return extent;
}

// Objects that are shown at every moment: the robot, and what goes far.
std::vector<bool> travelling(const Clip& clip, const std::vector<int>& moments) {
  constexpr double far = 1.0;  // voxels
  std::vector<bool> result;
  for (const ModelObject& object : clip.mesh().objects) {
    Bounds centres;
    for (const int step : moments) centres.add(middle_of(clip, step, object));
    const bool moves = std::max(centres.width(), centres.height()) >= far;
    result.push_back(object.name == robot_name || (!object.is_static && moves));
  }
  return result;
}

// What a strip is about: the robot, or an object that goes much farther than it does.
const ModelObject& protagonist(const Clip& clip, int from, int to) {
  const auto& objects = clip.mesh().objects;
  const auto far = [&](const ModelObject& object) {
    const Bounds path = way_of(clip, from, to, object);
    return std::max(path.width(), path.height());
  };
  constexpr double much = 2.0;
  const ModelObject* best = &objects.front();
  double most = much * far(objects.front());
  for (std::size_t k = 1; k < objects.size(); ++k) {
    if (objects[k].is_static || far(objects[k]) <= most) continue;
    best = &objects[k];
    most = far(objects[k]);
  }
  return *best;
}

// All points at the last moment; those of objects that stay, such as a bridge that
// gives way, as they were when the robot was nearest.
std::vector<Vec2> composed(const Clip& clip, const std::vector<int>& moments,
                           const std::vector<bool>& travels) {
  const auto last = clip.points(moments.back());
  std::vector<Vec2> points(last.begin(), last.end());
  for (std::size_t k = 0; k < travels.size(); ++k) {
    const ModelObject& object = clip.mesh().objects[k];
    if (travels[k] || object.is_static) continue;
    for (int p = object.first_point; p < object.first_point + object.points; ++p) {
      const auto at = static_cast<std::size_t>(p);
      double nearest = 1e30;
      for (const int step : moments) {
        const double distance = std::abs(clip.centre(step).x - last[at].x);
        if (distance >= nearest) continue;
        nearest = distance;
        points[at] = clip.points(step)[at];
      }
    }
  }
  return points;
}

// Those that travel and are drawn at each moment but the last: a heap of what hardly
// moved shows nothing, so that only the first stands where others would lie on it.
std::vector<std::vector<bool>> apart(const Clip& clip, const std::vector<int>& moments,
                                     const std::vector<bool>& travels) {
  constexpr double least = 0.5;  // of its size
  std::vector<std::vector<bool>> drawn(moments.size() - 1, travels);
  for (std::size_t k = 0; k < travels.size(); ++k) {
    const ModelObject& object = clip.mesh().objects[k];
    const Bounds size = clip.extent(moments.front(), object);
    const auto near = [&](Vec2 a, Vec2 b) {
      return std::hypot(a.x - b.x, a.y - b.y) < least * std::max(size.width(), size.height());
    };
    Vec2 before = middle_of(clip, moments.front(), object);
    for (std::size_t m = 1; m < drawn.size(); ++m) {
      const Vec2 here = middle_of(clip, moments[m], object);
      drawn[m][k] =
          travels[k] && !near(here, before) && !near(here, middle_of(clip, moments.back(), object));
      if (drawn[m][k]) before = here;
    }
  }
  return drawn;
}

Scene panorama(const Clip& clip, const std::vector<int>& moments) {
  constexpr double palest = 0.62;
  Scene scene = clip.scene(moments.back());
  scene.travels = travelling(clip, moments);
  scene.points = composed(clip, moments, scene.travels);
  const auto drawn = apart(clip, moments, scene.travels);
  const auto intervals = static_cast<double>(std::max<std::size_t>(1, moments.size() - 1));
  for (std::size_t k = 0; k + 1 < moments.size(); ++k) {
    const auto then = clip.points(moments[k]);
    scene.ghosts.push_back({{then.begin(), then.end()},
                            clip.values(moments[k]),
                            palest * (1 - static_cast<double>(k) / intervals),
                            drawn[k]});
  }
  scene.trail.clear();
  for (int t = moments.front(); t <= moments.back(); ++t) scene.trail.push_back(clip.centre(t));
  for (const int step : moments) scene.marks.push_back(clip.centre(step));
  const auto& objects = clip.mesh().objects;
  for (std::size_t k = 1; k < objects.size(); ++k) {
    if (!scene.travels[k]) continue;
    std::vector<Vec2>& path = scene.object_trails.emplace_back();
    for (int t = moments.front(); t <= moments.back(); ++t)
      path.push_back(middle_of(clip, t, objects[k]));
  }
  return scene;
}

// Everything that is shown at every moment, and the way between.
Bounds shown(const Clip& clip, const std::vector<int>& moments, const std::vector<bool>& travels) {
  Bounds extent = way(clip, moments.front(), moments.back());
  for (const int step : moments)
    for (std::size_t k = 0; k < travels.size(); ++k)
      if (travels[k]) extent.cover(clip.extent(step, clip.mesh().objects[k]));
  return extent;
}

// ---- labels -------------------------------------------------------------------------------

// Places for labels of one length that want to be at `wanted`, sorted: as near as
// they can be without touching, between `low` and `high`. Neighbours that would
// touch form a block about the mean of what they want (pool adjacent violators).
std::vector<float> spread(const std::vector<float>& wanted, float length, float low, float high) {
  struct Block {
    float sum = 0;  // of the places wanted for its first label
    std::size_t count = 0;
    float first() const { return sum / static_cast<float>(count); }
    float end(float length) const { return first() + static_cast<float>(count) * length; }
  };
  std::vector<Block> blocks;
  for (const float place : wanted) {
    blocks.push_back({place, 1});
    while (blocks.size() > 1 && blocks[blocks.size() - 2].end(length) > blocks.back().first()) {
      const Block last = blocks.back();
      blocks.pop_back();
      Block& block = blocks.back();
      block.sum += last.sum - static_cast<float>(last.count * block.count) * length;
      block.count += last.count;
    }
  }
  std::vector<float> places;
  for (const Block& block : blocks)
    for (std::size_t k = 0; k < block.count; ++k)
      places.push_back(block.first() + static_cast<float>(k) * length);
  // Pushed back from the ends, the far one first.
  for (std::size_t k = places.size(); k-- > 0;)
    places[k] = std::min(places[k], high - static_cast<float>(places.size() - 1 - k) * length);
  for (std::size_t k = 0; k < places.size(); ++k)
    places[k] = std::max(places[k], low + static_cast<float>(k) * length);
  return places;
}

struct Label {
  float at = 0;  // where what the strip is about is, along the axis
  std::string step;
  std::string score;
};

std::vector<Label> labels(const Clip& clip, const std::vector<int>& moments, bool upright,
                          const Projection& to_pixels) {
  std::vector<Label> all;
  const ModelObject& about = protagonist(clip, moments.front(), moments.back());
  for (const int step : moments) {
    const Point middle = to_pixels(middle_of(clip, step, about));
    const std::string turns = clip.turns(step);
    all.push_back({upright ? middle.y : middle.x,
                   fmt::format("step {}{}{}", step, turns.empty() ? "" : ", ", turns),
                   signed_score(clip.score(step))});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Label& a, const Label& b) { return a.at < b.at; });
  return all;
}

float widest(const std::vector<Label>& labels, float size, Typesetter& typesetter) {
  float most = 0;
  for (const Label& label : labels)
    most = std::max({most, typesetter.width(label.step, 0.9F * size),
                     typesetter.width(label.score, size, true)});
  return most;
}

std::vector<float> places_of(const std::vector<Label>& labels, float length, float low,
                             float high) {
  std::vector<float> wanted;
  for (const Label& label : labels) wanted.push_back(label.at);
  return spread(wanted, length, low, high);
}

// Below a panorama that lies, each under what it is about.
void draw_labels_below(const std::vector<Label>& labels, const Rect& area, float size,
                       const Theme& theme, Typesetter& typesetter, Drawing& drawing) {
  const float length = widest(labels, size, typesetter) + 0.8F * size;
  const float edge = 0.5F * length;
  const auto places = places_of(labels, length, area.x + edge, area.x + area.width - edge);
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const float y = area.y + 0.9F * size;
    drawing.line({labels[k].at, area.y + 1}, {places[k], y - 0.1F * size}, 1.0F, theme.text_muted);
    drawing.text({places[k], y + 1.05F * size}, size, labels[k].score, theme.text, Align::centre,
                 true);
    drawing.text({places[k], y + 2.25F * size}, 0.9F * size, labels[k].step, theme.text_muted,
                 Align::centre);
  }
}

// To the right of one that stands.
void draw_labels_beside(const std::vector<Label>& labels, const Rect& area, float size,
                        const Theme& theme, Drawing& drawing) {
  const float length = 2.6F * size;
  const auto places =
      places_of(labels, length, area.y + length / 2, area.y + area.height - length / 2);
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const float x = area.x + 1.6F * size;
    drawing.line({area.x + 1, labels[k].at}, {x - 0.3F * size, places[k]}, 1.0F, theme.text_muted);
    drawing.text({x, places[k] - 0.1F * size}, size, labels[k].score, theme.text, Align::left,
                 true);
    drawing.text({x, places[k] + 1.05F * size}, 0.9F * size, labels[k].step, theme.text_muted);
  }
}

// ---- layouts ---------------------------------------------------------------------------------

constexpr double beside = 2.0;  // voxels left and right of what is shown
constexpr double above = 1.2;

std::string duration(const Clip& clip, const std::vector<int>& moments) {
  const int steps = moments.back() - moments.front();
  return fmt::format("{} steps, {:.3g} s", steps, clip.seconds(steps));
}

Drawing lying(const Clip& clip, const std::vector<int>& moments, Scene scene, const Bounds& extent,
              const Theme& theme, Size most, Typesetter& typesetter) {
  const auto width = static_cast<float>(most.width);
  const float size = std::max(9.0F, 0.0125F * width);
  const float heading = 2.2F * size;
  const float below = 3.6F * size;
  const float legend = 2.4F * size;
  const float earth = 2.4F * size;
  double scale = static_cast<double>(width) / (extent.width() + 2 * beside);
  // The bar of colours has the sky above the robot.
  constexpr double bar = 48;  // pixels
  const double sky =
      above + (ceiling(clip, extent) - extent.y1) + (scene.values.empty() ? 0.0 : bar / scale);
  const double high = std::max(1.0, extent.y1 + sky - std::min(0.0, extent.y0));
  const double room =
      static_cast<double>(most.height) - static_cast<double>(heading + below + legend + earth);
  scale = std::min(scale, std::max(room, 0.1 * static_cast<double>(width)) / high);
  const float panel_height = std::round(static_cast<float>(high * scale) + earth);
  const Rect panel{0, std::round(heading), width, panel_height};
  const double panel_voxels = static_cast<double>(panel_height) / scale;
  scene.view = {(extent.x0 + extent.x1) / 2, extent.y1 + sky - panel_voxels / 2,
                static_cast<double>(width) / scale, panel_voxels};
  const float total = panel.y + panel.height + below + legend;
  Drawing drawing({most.width, static_cast<int>(std::lround(total))});
  check_size(drawing.size());
  drawing.rectangle(drawing.whole(), theme.paper);
  scene.ruler_text = 0.8F * size;
  draw_scene(scene, theme, panel, drawing);
  draw_key(scene, theme, panel, 0, typesetter, drawing);
  drawing.clip(drawing.whole());

  const Caption who = clip.caption(0);
  const float margin = 0.6F * size;
  const float baseline = 1.45F * size;
  drawing.text({margin, baseline}, 1.1F * size, who.title, theme.text, Align::left, true);
  drawing.text({margin + typesetter.width(who.title, 1.1F * size, true) + 0.8F * size, baseline},
               size, who.detail, theme.text_muted);
  drawing.text({width - margin, baseline}, size, duration(clip, moments), theme.text_muted,
               Align::right);
  const Projection to_pixels(scene.view, panel);
  const Rect under{0, panel.y + panel.height, width, below};
  draw_labels_below(labels(clip, moments, false, to_pixels), under, size, theme, typesetter,
                    drawing);
  draw_legend(Kinds(clip.mesh(), clip.values(clip.steps())), scale, theme,
              {margin, under.y + below, width - 2 * margin, 1.6F * size}, size, typesetter,
              drawing);
  return drawing;
}

// A piece of a panorama that stands: the heights between `low` and `high`.
struct Storey {
  double low = 0;
  double high = 0;
  std::vector<int> moments;
};

// A climb as high as several pictures are wide has two columns, the lower half at the left.
std::vector<Storey> storeys(const Clip& clip, const std::vector<int>& moments, double low,
                            double high, double across) {
  constexpr double slim = 4.0;
  if (high - low < slim * across) return {{low, high, moments}};
  const double middle = (low + high) / 2;
  std::vector<Storey> halves{{low, middle, {}}, {middle, high, {}}};
  const ModelObject& about = protagonist(clip, moments.front(), moments.back());
  for (const int step : moments)
    halves[middle_of(clip, step, about).y < middle ? 0 : 1].moments.push_back(step);
  return halves;
}

Drawing standing(const Clip& clip, const std::vector<int>& moments, const Scene& whole,
                 const Bounds& extent, const Theme& theme, Size most, Typesetter& typesetter) {
  const float size = std::max(9.0F, 0.022F * static_cast<float>(most.height));
  const float legend = 2.4F * size;
  const float height = static_cast<float>(most.height) - legend;
  const float earth = 2.4F * size;
  // Walls beside the robot are part of the story.
  constexpr double walls = 4.0;
  const double across = extent.width() + 2 * walls;
  const double low = std::min(0.0, extent.y0);
  const auto parts = storeys(clip, moments, low, std::max(low + 1.0, extent.y1 + above), across);
  const double scale =
      static_cast<double>(height - earth) / (parts.front().high - parts.front().low);
  const float panel_width = std::round(std::max(0.3F * height, static_cast<float>(across * scale)));
  const Caption who = clip.caption(0);
  const float heading = 5.0F * size;  // lines beside the last column
  const auto texts_of = [&](const Storey& storey, const Projection& to_pixels) {
    return labels(clip, storey.moments, true, to_pixels);
  };
  const auto view_of = [&](const Storey& storey) -> ViewRect {
    const double voxels = static_cast<double>(height) / scale;
    return {(extent.x0 + extent.x1) / 2, storey.high - voxels / 2,
            static_cast<double>(panel_width) / scale, voxels};
  };
  float column = std::max({typesetter.width(who.title, 1.1F * size, true),
                           typesetter.width(duration(clip, moments), 0.9F * size),
                           typesetter.width(who.detail, 0.9F * size)}) +
                 2.2F * size;
  for (const Storey& storey : parts) {
    const Projection to_pixels(view_of(storey), {0, 0, panel_width, height});
    column = std::max(column, widest(texts_of(storey, to_pixels), size, typesetter) + 2.6F * size);
  }
  const auto columns = static_cast<float>(parts.size());
  Drawing drawing({static_cast<int>(std::lround(columns * (panel_width + column))),
                   static_cast<int>(std::lround(height + legend))});
  check_size(drawing.size());
  drawing.rectangle(drawing.whole(), theme.paper);
  float x = 0;
  for (const Storey& storey : parts) {
    const Rect panel{std::round(x), 0, panel_width, height};
    Scene scene = whole;
    scene.view = view_of(storey);
    scene.ruler_text = 0.8F * size;
    draw_scene(scene, theme, panel, drawing);
    if (x == 0) draw_key(scene, theme, panel, 0, typesetter, drawing);
    drawing.clip(drawing.whole());
    x = panel.x + panel_width;
    const bool last = &storey == &parts.back();
    const float from = last ? heading : size;
    draw_labels_beside(texts_of(storey, Projection(scene.view, panel)),
                       {x, from, column, height - from}, size, theme, drawing);
    if (!last) x += column;
  }
  x += 1.2F * size;
  drawing.text({x, 1.6F * size}, 1.1F * size, who.title, theme.text, Align::left, true);
  drawing.text({x, 2.9F * size}, 0.9F * size, who.detail, theme.text_muted);
  drawing.text({x, 4.1F * size}, 0.9F * size, duration(clip, moments), theme.text_muted);
  draw_legend(Kinds(clip.mesh(), clip.values(clip.steps())), 0, theme,
              {0.6F * size, height, static_cast<float>(drawing.size().width), legend}, 0.8F * size,
              typesetter, drawing);
  return drawing;
}

bool has_room(const Clip& clip, const std::vector<int>& moments) {
  constexpr double least = 0.6;  // of its size, from one moment to the next
  const ModelObject& about = protagonist(clip, moments.front(), moments.back());
  const Bounds body = clip.extent(moments.front(), about);
  const Bounds path = way_of(clip, moments.front(), moments.back(), about);
  const auto gaps = static_cast<double>(moments.size() - 1);
  return path.width() >= least * gaps * body.width() ||
         path.height() >= least * gaps * body.height();
}

// Whether anything goes farther than the robot is long.
bool travels(const Clip& clip, int from, int to) {
  constexpr double bodies = 1.5;
  const Bounds body = clip.extent(from, clip.mesh().objects.front());
  return std::ranges::any_of(clip.mesh().objects, [&](const ModelObject& object) {
    if (object.is_static) return false;
    const Bounds path = way_of(clip, from, to, object);
    return path.width() >= bodies * body.width() || path.height() >= bodies * body.height();
  });
}

}  // namespace

bool suits_strip(const Clip& clip, const std::vector<int>& moments) {
  return moments.size() > 1 && travels(clip, moments.front(), moments.back()) &&
         has_room(clip, moments);
}

Drawing strip(const Clip& clip, const std::vector<int>& moments, const Theme& theme, Size most,
              Typesetter& typesetter) {
  Scene scene = panorama(clip, moments);
  const Bounds extent = shown(clip, moments, scene.travels);
  const Bounds path = way_of(clip, moments.front(), moments.back(),
                             protagonist(clip, moments.front(), moments.back()));
  return climbs(path) ? standing(clip, moments, scene, extent, theme, most, typesetter)
                      : lying(clip, moments, std::move(scene), extent, theme, most, typesetter);
}

}  // namespace evo::render
