#include "render/scene/scene.h"

#include <algorithm>
#include <cmath>

#include "render/scene/notes.h"
#include "render/scene/objects.h"
#include "render/scene/round_numbers.h"

namespace evo::render {
namespace {

// ---- line widths, in voxels unless said otherwise ---------------------------------

constexpr double trail_width = 0.11;
constexpr double arrow_width = 0.06;
constexpr double force_width = 0.16;
constexpr double touch_radius = 0.16;
// The grid has a line per voxel from the first size on, in pixels, fully visible
// from the second; below the last one it is left out.
constexpr double fine_grid_from = 6.0;
constexpr double fine_grid_full = 18.0;
constexpr double least_grid_voxel = 0.5;

// ---- background ------------------------------------------------------------------------

void draw_sky_and_earth(const Scene& scene, const Theme& theme, const Projection& to_pixels,
                        Drawing& drawing) {
  const Rect& panel = to_pixels.panel;
  if (scene.white) {
    constexpr Color white{255, 255, 255, 255};
    return drawing.gradient(panel, white, white);
  }
  drawing.gradient(panel, theme.sky_top, theme.sky_bottom);
  if (!scene.floor || to_pixels.low() >= 0) return;
  const float floor = std::max(panel.y, to_pixels({0, 0}).y);
  const Rect earth{panel.x, floor, panel.width, panel.y + panel.height - floor};
  drawing.gradient(earth, theme.earth_top, theme.earth_bottom);
}

// Whole numbers of voxels between a and b, every `step`.
template <typename F>
void each_line(double a, double b, int step, F f) {
  for (auto k = static_cast<long>(std::ceil(a / step)); static_cast<double>(k) * step <= b; ++k)
    f(k * step);
}

void draw_grid(const Scene& scene, const Theme& theme, const Projection& to_pixels,
               Drawing& drawing) {
  constexpr int major = 10;
  if (to_pixels.scale < least_grid_voxel) return;
  const double bottom = scene.floor ? std::max(0.0, to_pixels.low()) : to_pixels.low();
  if (bottom >= to_pixels.top) return;
  const bool fine = scene.fine_grid && to_pixels.scale >= fine_grid_from;
  const float width = to_pixels.pixels(0.025, 1.0);
  const double fade =
      std::clamp((to_pixels.scale - fine_grid_from) / (fine_grid_full - fine_grid_from), 0.0, 1.0);
  const Color minor = with_alpha(theme.grid_minor, theme.grid_minor.a / 255.0 * fade);
  const auto color = [&](long k) { return k % major == 0 ? theme.grid_major : minor; };
  const int step = fine ? 1 : major;
  each_line(to_pixels.left, to_pixels.right(), step, [&](long x) {
    const auto at = static_cast<double>(x);
    drawing.segment(to_pixels({at, to_pixels.top}), to_pixels({at, bottom}), width, color(x));
  });
  each_line(bottom, to_pixels.top, step, [&](long y) {
    const auto at = static_cast<double>(y);
    drawing.segment(to_pixels({to_pixels.left, at}), to_pixels({to_pixels.right(), at}), width,
                    color(y));
  });
}

// Distances in the strip of earth below the floor, when there is room.
void draw_ruler(const Scene& scene, const Theme& theme, const Projection& to_pixels,
                Drawing& drawing) {
  if (!scene.floor || to_pixels.low() >= 0) return;
  const float floor = to_pixels({0, 0}).y;
  if (!scene.white)
    drawing.line({to_pixels.panel.x, floor}, {to_pixels.panel.x + to_pixels.panel.width, floor},
                 to_pixels.pixels(0.08, 1.0), theme.floor_line);
  const float size = scene.ruler_text > 0 ? scene.ruler_text : label_size(to_pixels.panel) * 0.8F;
  const float pins = scene.heights || scene.pins.empty() ? 0 : pin_row(to_pixels.panel);
  const float strip = to_pixels.panel.y + to_pixels.panel.height - floor - pins;
  if (!scene.grid || size < 7 || strip < 1.8F * size) return;
  if (to_pixels.scale < least_grid_voxel) return;
  int step = 5;
  for (int k = 0; to_pixels.scale * step < 4.5 * size; ++k) step *= k % 2 == 0 ? 2 : 5;
  const float tick = std::min(0.3F * size, 0.2F * strip);
  each_line(to_pixels.left, to_pixels.right(), step, [&](long x) {
    const Point at = to_pixels({static_cast<double>(x), 0});
    drawing.line(at, {at.x, at.y + tick}, to_pixels.pixels(0.05, 1.0), theme.floor_line);
    const std::string digits = (x < 0 ? "−" : "") + std::to_string(std::abs(x));
    const float margin = 0.35F * size * static_cast<float>(digits.size());
    if (at.x < to_pixels.panel.x + margin ||
        at.x > to_pixels.panel.x + to_pixels.panel.width - margin)
      return;
    drawing.text({at.x, at.y + tick + 1.15F * size}, size, digits, theme.text_on_earth,
                 Align::centre);
  });
}

// Heights along the left border, from the floor up to where captions begin; the numbers
// on plates of their own, since anything may be behind them.
void draw_heights(const Scene& scene, const Theme& theme, const Projection& to_pixels,
                  Drawing& drawing) {
  const Rect& panel = to_pixels.panel;
  constexpr float least = 7.0F;  // pixels
  const float size =
      scene.ruler_text > 0 ? scene.ruler_text : std::max(least, label_size(panel) * 0.8F);
  if (panel.height < 20 * size || to_pixels.scale < least_grid_voxel) return;
  const double least_step = std::max(1.0, 2.5 * static_cast<double>(size) / to_pixels.scale);
  const int step = static_cast<int>(std::lround(round_number_from(least_step)));
  const float top = panel.y + scene.captions + 0.8F * size;
  const float bottom = panel.y + panel.height - 0.8F * size;
  each_line(std::max(0.0, to_pixels.low()), to_pixels.top, step, [&](long y) {
    const float at = to_pixels({0, static_cast<double>(y)}).y;
    if (at < top || at > bottom) return;
    const std::string digits = std::to_string(y);
    const float width = (0.64F * static_cast<float>(digits.size()) + 0.5F) * size;
    const float x = panel.x + 0.3F * size;
    // At the right: at the left it would be a minus.
    drawing.segment({x + width, at}, {x + width + 0.7F * size, at}, to_pixels.pixels(0.05, 1.0),
                    theme.text_muted);
    drawing.rounded_rectangle({x, at - 0.65F * size, width, 1.3F * size}, 0.35F * size,
                              theme.label);
    drawing.text({x + width / 2, at + 0.36F * size}, size, digits, theme.text, Align::centre);
  });
}

void draw_touches(const Scene& scene, const Theme& theme, const Projection& to_pixels,
                  Drawing& drawing) {
  const float radius = to_pixels.pixels(touch_radius, 1.8);
  for (const Vec2& place : scene.touches) {
    drawing.disc(to_pixels(place), 1.4F * radius, theme.sky_bottom);
    drawing.disc(to_pixels(place), radius, theme.trail);
  }
}

// ---- overlays --------------------------------------------------------------------------------

void draw_trail(const Scene& scene, const Theme& theme, const Projection& to_pixels,
                Drawing& drawing) {
  const float width = to_pixels.pixels(trail_width, 1.2);
  for (const std::vector<Vec2>& path : scene.object_trails)
    for (std::size_t k = 1; k < path.size(); ++k)
      drawing.line(to_pixels(path[k - 1]), to_pixels(path[k]), 0.8F * width, theme.arrow);
  if (scene.trail.empty()) return;
  const auto n = static_cast<double>(scene.trail.size());
  for (std::size_t k = 1; k < scene.trail.size(); ++k) {
    // The past is paler, never invisible.
    const double age = (n - static_cast<double>(k)) / n;
    drawing.line(to_pixels(scene.trail[k - 1]), to_pixels(scene.trail[k]), width,
                 mix(theme.trail, theme.sky_bottom, 0.6 * age));
  }
  drawing.disc(to_pixels(scene.trail.back()), 1.6F * width, theme.trail);
  for (const Vec2& mark : scene.marks) {
    drawing.disc(to_pixels(mark), 2.2F * width, theme.sky_bottom);
    drawing.disc(to_pixels(mark), 1.6F * width, theme.trail);
  }
}

void smooth_triangle(const std::array<Point, 3>& corners, Color color, Drawing& drawing) {
  drawing.triangle(corners, color);
  drawing.stroke(corners, true, static_cast<float>(least_line), color);
}

// A flag on the ground, as tall as a robot.
void draw_flag(Vec2 foot, const Theme& theme, const Projection& to_pixels, Drawing& drawing) {
  constexpr double pole = 6.0;  // voxels
  constexpr double cloth = 1.6;
  const float width = to_pixels.pixels(0.14, 1.2);
  const Point top = to_pixels({foot.x, foot.y + pole});
  drawing.line(to_pixels(foot), top, width, theme.outline);
  smooth_triangle({top, to_pixels({foot.x + 1.5 * cloth, foot.y + pole - cloth / 2}),
                   to_pixels({foot.x, foot.y + pole - cloth})},
                  theme.trail, drawing);
  drawing.disc(to_pixels(foot), 1.6F * width, theme.outline);
}

// Towards a goal out of the picture: a triangle at its border, and how many voxels
// it is away from the robot.
void draw_way_to_goal(const Goal& goal, const Theme& theme, const Projection& to_pixels,
                      Drawing& drawing) {
  const Rect& panel = to_pixels.panel;
  const float size = std::max(8.0F, label_size(panel));
  const bool right = goal.at.x > to_pixels.right();
  const float side = right ? 1.0F : -1.0F;
  const float border = right ? panel.x + panel.width : panel.x;
  const float y = panel.y + 0.45F * panel.height;
  const Point tip{border - side * 0.6F * size, y};
  const float base = tip.x - side * 1.1F * size;
  smooth_triangle({tip, {base, y - 0.8F * size}, {base, y + 0.8F * size}}, theme.trail, drawing);
  drawing.text({base - side * 0.4F * size, y + 0.36F * size}, size,
               std::to_string(std::lround(std::abs(goal.away))), theme.trail,
               right ? Align::right : Align::left, true);
}

void draw_goal(const Goal& goal, const Theme& theme, const Projection& to_pixels,
               Drawing& drawing) {
  if (goal.at.x < to_pixels.left || goal.at.x > to_pixels.right()) {
    draw_way_to_goal(goal, theme, to_pixels, drawing);
  } else {
    draw_flag(goal.at, theme, to_pixels, drawing);
  }
}

// Two squares wide.
void draw_finish(double x, const Projection& to_pixels, Drawing& drawing) {
  constexpr double square = 0.5;
  const auto side = to_pixels.pixels(square, 1.0);
  const double low = std::floor(to_pixels.low() / square) * square;
  for (int row = 0; low + row * square < to_pixels.top; ++row)
    for (int column = 0; column < 2; ++column) {
      const Point corner = to_pixels({x + column * square, low + (row + 1) * square});
      const bool dark = (row + column) % 2 == 0;
      drawing.rectangle({corner.x, corner.y, side, side},
                        with_alpha(dark ? Color{0, 0, 0, 255} : Color{255, 255, 255, 255}, 0.8));
    }
}

void draw_arrow(const Arrow& arrow, const Theme& theme, const Projection& to_pixels,
                Drawing& drawing) {
  const Point a = to_pixels(arrow.from);
  const Point b = to_pixels(arrow.to);
  const float length = std::hypot(b.x - a.x, b.y - a.y);
  const float width = to_pixels.pixels(arrow.force ? force_width : arrow_width, 1.0);
  if (length < width) return;
  const Color color = arrow.force ? theme.trail : theme.arrow;
  drawing.line(a, b, width, color);
  const float head = std::min(length, 4.5F * width);
  const Point along{(b.x - a.x) / length, (b.y - a.y) / length};
  const Point base{b.x - along.x * head, b.y - along.y * head};
  const float half = 0.45F * head;
  const Point tip{b.x + along.x * width, b.y + along.y * width};
  drawing.triangle({tip,
                    {base.x - along.y * half, base.y + along.x * half},
                    {base.x + along.y * half, base.y - along.x * half}},
                   color);
}

void draw_frame(const std::array<Vec2, 4>& place, const Theme& theme, const Projection& to_pixels,
                Drawing& drawing) {
  std::array<Point, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) corners[k] = to_pixels(place[k]);
  drawing.stroke(corners, true, to_pixels.pixels(0.2, 2.0), theme.trail);
}

// The robot comes first in world order and is seen in front of everything; what
// travels, as it was before, stands in front of what does not.
void draw_objects(const Scene& scene, const Theme& theme, const Projection& to_pixels,
                  Drawing& drawing) {
  const std::size_t count = scene.mesh->objects.size();
  const auto is_ghost = [&](std::size_t k) { return k < scene.travels.size() && scene.travels[k]; };
  ObjectPainter now(*scene.mesh, scene.points,
                    {scene.tint, 0.0, scene.values, &scene.value_scale, scene.outlines, scene.edges,
                     scene.voxels},
                    theme, to_pixels, drawing);
  for (std::size_t k = count; k-- > 0;)
    if (!is_ghost(k) && (scene.backdrop || !scene.mesh->objects[k].is_static)) now.draw(k);
  for (const Ghost& ghost : scene.ghosts) {
    ObjectPainter before(*scene.mesh, ghost.points,
                         {scene.tint, ghost.pale, ghost.values, &scene.value_scale, scene.outlines},
                         theme, to_pixels, drawing);
    for (std::size_t k = count; k-- > 0;)
      if (ghost.objects[k]) before.draw(k);
  }
  for (std::size_t k = count; k-- > 0;)
    if (is_ghost(k)) now.draw(k);
}

}  // namespace

// ---- scene ---------------------------------------------------------------------------------

void draw_scene(const Scene& scene, const Theme& theme, const Rect& panel, Drawing& drawing) {
  const Projection to_pixels(
      fit(scene.view, static_cast<double>(panel.width) / static_cast<double>(panel.height)), panel);
  drawing.clip(panel);
  if (scene.backdrop) {
    draw_sky_and_earth(scene, theme, to_pixels, drawing);
    if (scene.grid) draw_grid(scene, theme, to_pixels, drawing);
    draw_ruler(scene, theme, to_pixels, drawing);
  }
  if (scene.goal) draw_goal(*scene.goal, theme, to_pixels, drawing);
  if (scene.finish) draw_finish(*scene.finish, to_pixels, drawing);
  draw_objects(scene, theme, to_pixels, drawing);
  draw_trail(scene, theme, to_pixels, drawing);
  draw_touches(scene, theme, to_pixels, drawing);
  for (const Arrow& arrow : scene.arrows) draw_arrow(arrow, theme, to_pixels, drawing);
  for (const auto& place : scene.framed) draw_frame(place, theme, to_pixels, drawing);
  if (scene.heights && scene.grid) draw_heights(scene, theme, to_pixels, drawing);
  draw_pins(scene, theme, to_pixels, drawing);
  draw_tags(scene.tags, theme, to_pixels, drawing);
}

ViewRect fit(ViewRect view, double aspect) {
  if (view.width < view.height * aspect)
    view.width = view.height * aspect;
  else
    view.height = view.width / aspect;
  return view;
}

float label_size(const Rect& panel) {
  // Wide and flat panels are measured by their height, tall ones by their width.
  return 0.031F * std::min(panel.height, panel.width * 0.75F);
}

}  // namespace evo::render
