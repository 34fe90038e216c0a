#include "render/figures/strip.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libevo/task/bounds.h"
#include "libevo/task/spec.h"
#include "render/figures/key.h"
#include "render/figures/legend.h"
#include "render/painters/drawing.h"
#include "render/painters/label.h"
#include "render/scene/projection.h"

namespace evo::render {
namespace {

Bounds extent_of(const Clip& clip, int step, const ModelObject& object) {
  Bounds extent;
  for (int k = 0; k < object.points; ++k)
    extent.add(clip.points(step)[static_cast<std::size_t>(object.first_point + k)]);
  return extent;
}

// Of the robot's centre between two steps.
Bounds way(const Clip& clip, int from, int to) {
  Bounds extent;
  for (int t = from; t <= to; ++t) extent.add(clip.centre(t));
  return extent;
}

bool climbs(const Bounds& way) {
  constexpr double far = 4.0;  // voxels
  return way.height() > way.width() && way.height() > far;
}

// ---- what to draw -----------------------------------------------------------------------

// Objects that are shown at every moment: the robot, and what goes far.
std::vector<bool> travelling(const Clip& clip, const std::vector<int>& moments) {
  constexpr double far = 1.0;  // voxels
  std::vector<bool> result;
  for (const ModelObject& object : clip.mesh().objects) {
    Bounds centres;
    for (const int step : moments) {
      const Bounds extent = extent_of(clip, step, object);
      centres.add({(extent.x0 + extent.x1) / 2, (extent.y0 + extent.y1) / 2});
    }
    const bool moves = std::max(centres.width(), centres.height()) >= far;
    result.push_back(object.name == robot_name || (!object.is_static && moves));
  }
  return result;
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

Scene panorama(const Clip& clip, const std::vector<int>& moments) {
  constexpr double palest = 0.62;
  Scene scene = clip.scene(moments.back());
  scene.travels = travelling(clip, moments);
  scene.points = composed(clip, moments, scene.travels);
  const auto intervals = static_cast<double>(std::max<std::size_t>(1, moments.size() - 1));
  for (std::size_t k = 0; k + 1 < moments.size(); ++k) {
    const auto then = clip.points(moments[k]);
    scene.ghosts.push_back({{then.begin(), then.end()},
                            clip.values(moments[k]),
                            palest * (1 - static_cast<double>(k) / intervals)});
  }
  scene.trail.clear();
  for (int t = moments.front(); t <= moments.back(); ++t) scene.trail.push_back(clip.centre(t));
  for (const int step : moments) scene.marks.push_back(clip.centre(step));
  return scene;
}

// Everything that is shown at every moment, and the way between.
Bounds shown(const Clip& clip, const std::vector<int>& moments, const std::vector<bool>& travels) {
  Bounds extent = way(clip, moments.front(), moments.back());
  for (const int step : moments)
    for (std::size_t k = 0; k < travels.size(); ++k) {
      if (!travels[k]) continue;
      const Bounds object = extent_of(clip, step, clip.mesh().objects[k]);
      extent.add({object.x0, object.y0});
      extent.add({object.x1, object.y1});
    }
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
  float at = 0;  // where the robot is, along the axis
  std::string step;
  std::string score;
};

std::vector<Label> labels(const Clip& clip, const std::vector<int>& moments, bool upright,
                          const Projection& to_pixels) {
  std::vector<Label> all;
  for (const int step : moments) {
    const Point centre = to_pixels(clip.centre(step));
    all.push_back({upright ? centre.y : centre.x, fmt::format("step {}", step),
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

// Below a panorama that lies, each under its robot.
void draw_labels_below(const std::vector<Label>& labels, const Rect& area, float size,
                       const Theme& theme, Typesetter& typesetter, Drawing& drawing) {
  const float length = widest(labels, size, typesetter) + 0.8F * size;
  const float edge = 0.5F * length;
  const auto places = places_of(labels, length, area.x + edge, area.x + area.width - edge);
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const float y = area.y + 0.9F * size;
    drawing.line({labels[k].at, area.y + 1}, {places[k], y - 0.1F * size}, 1.0F, theme.text_muted);
    drawing.text(
        {{places[k], y + 1.05F * size}, size, labels[k].score, theme.text, Align::centre, true});
    drawing.text({{places[k], y + 2.25F * size},
                  0.9F * size,
                  labels[k].step,
                  theme.text_muted,
                  Align::centre,
                  false});
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
    drawing.text(
        {{x, places[k] - 0.1F * size}, size, labels[k].score, theme.text, Align::left, true});
    drawing.text({{x, places[k] + 1.05F * size},
                  0.9F * size,
                  labels[k].step,
                  theme.text_muted,
                  Align::left,
                  false});
  }
}

// ---- layouts ---------------------------------------------------------------------------------

constexpr double beside = 2.0;  // voxels left and right of what is shown
constexpr double above = 1.2;

std::string duration(const std::vector<int>& moments) {
  const int steps = moments.back() - moments.front();
  return fmt::format("{} steps, {:.3g} s", steps, steps / steps_per_second);
}

Drawing lying(const Clip& clip, const std::vector<int>& moments, Scene scene, const Bounds& extent,
              const Theme& theme, Size most, Typesetter& typesetter) {
  const auto width = static_cast<float>(most.width);
  const float size = std::max(9.0F, 0.0125F * width);
  const float heading = 2.2F * size;
  const float below = 3.6F * size;
  const float legend = theme.signs ? 2.4F * size : 0.0F;
  const float earth = 2.4F * size;
  double scale = static_cast<double>(width) / (extent.width() + 2 * beside);
  // The bar of colours has the sky above the robot.
  constexpr double bar = 48;  // pixels
  const double sky = above + (scene.values.empty() ? 0.0 : bar / scale);
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
  drawing.text({{margin, baseline}, 1.1F * size, who.title, theme.text, Align::left, true});
  drawing.text({{margin + typesetter.width(who.title, 1.1F * size, true) + 0.8F * size, baseline},
                size,
                who.detail,
                theme.text_muted,
                Align::left,
                false});
  drawing.text(
      {{width - margin, baseline}, size, duration(moments), theme.text_muted, Align::right, false});
  const Projection to_pixels(scene.view, panel);
  const Rect under{0, panel.y + panel.height, width, below};
  draw_labels_below(labels(clip, moments, false, to_pixels), under, size, theme, typesetter,
                    drawing);
  if (legend > 0)
    draw_legend(clip.mesh(), scale, theme,
                {margin, under.y + below, width - 2 * margin, 1.6F * size}, size, typesetter,
                drawing);
  return drawing;
}

Drawing standing(const Clip& clip, const std::vector<int>& moments, Scene scene,
                 const Bounds& extent, const Theme& theme, Size most, Typesetter& typesetter) {
  const auto height = static_cast<float>(most.height);
  const float size = std::max(9.0F, 0.022F * height);
  const float earth = 2.4F * size;
  const double high = extent.y1 + above - std::min(0.0, extent.y0);
  const double scale = static_cast<double>(height - earth) / std::max(1.0, high);
  // Walls beside the robot are part of the story.
  constexpr double walls = 4.0;
  const double across = extent.width() + 2 * walls;
  const float panel_width = std::round(std::max(0.3F * height, static_cast<float>(across * scale)));
  const Rect panel{0, 0, panel_width, height};
  scene.view = {(extent.x0 + extent.x1) / 2,
                extent.y1 + above - static_cast<double>(height) / scale / 2,
                static_cast<double>(panel_width) / scale, static_cast<double>(height) / scale};
  const Projection to_pixels(scene.view, panel);
  const auto texts = labels(clip, moments, true, to_pixels);
  const Caption who = clip.caption(0);
  const float column = std::max({widest(texts, size, typesetter) + 2.6F * size,
                                 typesetter.width(who.title, 1.1F * size, true) + 2.2F * size,
                                 typesetter.width(duration(moments), 0.9F * size) + 2.2F * size,
                                 typesetter.width(who.detail, 0.9F * size) + 2.2F * size});
  const float legend = theme.signs ? 2.4F * size : 0.0F;
  Drawing drawing({static_cast<int>(std::lround(panel_width + column)),
                   static_cast<int>(std::lround(height + legend))});
  check_size(drawing.size());
  drawing.rectangle(drawing.whole(), theme.paper);
  scene.ruler_text = 0.8F * size;
  draw_scene(scene, theme, panel, drawing);
  draw_key(scene, theme, panel, 0, typesetter, drawing);
  drawing.clip(drawing.whole());
  const float x = panel_width + 1.2F * size;
  drawing.text({{x, 1.6F * size}, 1.1F * size, who.title, theme.text, Align::left, true});
  drawing.text({{x, 2.9F * size}, 0.9F * size, who.detail, theme.text_muted, Align::left, false});
  drawing.text(
      {{x, 4.1F * size}, 0.9F * size, duration(moments), theme.text_muted, Align::left, false});
  draw_labels_beside(texts, {panel_width, 5.0F * size, column, height - 5.0F * size}, size, theme,
                     drawing);
  if (legend > 0)
    draw_legend(clip.mesh(), 0, theme, {0.6F * size, height, panel_width, legend}, 0.8F * size,
                typesetter, drawing);
  return drawing;
}

}  // namespace

bool hops(const Clip& clip, int from, int to) {
  return climbs(way(clip, from, to)) && !travels(clip, from, to);
}

bool travels(const Clip& clip, int from, int to) {
  constexpr double bodies = 1.5;  // lengths of the robot
  const Bounds body = extent_of(clip, from, clip.mesh().objects.front());
  const Bounds path = way(clip, from, to);
  return path.width() >= bodies * body.width() || path.height() >= bodies * body.height();
}

Drawing strip(const Clip& clip, const std::vector<int>& moments, const Theme& theme, Size most,
              Typesetter& typesetter) {
  Scene scene = panorama(clip, moments);
  const Bounds extent = shown(clip, moments, scene.travels);
  const Bounds path = way(clip, moments.front(), moments.back());
  return climbs(path) ? standing(clip, moments, std::move(scene), extent, theme, most, typesetter)
                      : lying(clip, moments, std::move(scene), extent, theme, most, typesetter);
}

}  // namespace evo::render
