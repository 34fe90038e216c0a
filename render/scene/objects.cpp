#include "render/scene/objects.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libevo/task/spec.h"

namespace evo::render {
namespace {

constexpr double sign_width = 0.075;      // voxels
constexpr double least_sign_voxel = 7.0;  // pixels; smaller signs are dirt

bool visible(const Projection& to_pixels, std::span<const Point> corners) {
  const Rect& panel = to_pixels.panel;
  float x0 = corners[0].x, x1 = x0, y0 = corners[0].y, y1 = y0;
  for (const Point& p : corners) {
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
    y0 = std::min(y0, p.y);
    y1 = std::max(y1, p.y);
  }
  const auto margin = static_cast<float>(to_pixels.scale);
  return x1 > panel.x - margin && x0 < panel.x + panel.width + margin && y1 > panel.y - margin &&
         y0 < panel.y + panel.height + margin;
}

}  // namespace

Color tinted(Color color, Voxel type, const std::array<Vec2, 4>& p) {
  constexpr double shortest = 0.6;  // of the rest length; the range of targets
  constexpr double longest = 1.6;
  constexpr double strength = 0.55;
  const bool across = type == Voxel::horizontal;
  const double length = across ? (distance(p[0], p[1]) + distance(p[2], p[3])) / 2
                               : (distance(p[0], p[2]) + distance(p[1], p[3])) / 2;
  if (length < 1)
    return mix(color, {40, 24, 30}, strength * std::min(1.0, (1 - length) / (1 - shortest)));
  return mix(color, {255, 255, 255}, strength * std::min(1.0, (length - 1) / (longest - 1)));
}

ObjectPainter::ObjectPainter(const Mesh& mesh, std::span<const Vec2> points,
                             const ObjectStyle& style, const Theme& theme,
                             const Projection& to_pixels, Drawing& drawing)
    : mesh_(mesh),
      points_(points),
      style_(style),
      theme_(theme),
      to_pixels_(to_pixels),
      drawing_(drawing),
      background_(mix(theme.sky_top, theme.sky_bottom, 0.7)),
      colors_(mesh.cells.size()) {
  pixels_.reserve(points.size());
  for (const Vec2& p : points) pixels_.push_back(to_pixels(p));
}

void ObjectPainter::draw(std::size_t object) {
  const ModelObject& cells = mesh_.objects[object];
  const bool robot = cells.name == robot_name;
  for (int k = cells.first_cell; k < cells.first_cell + cells.cells; ++k) fill(k, robot);
  if (!style_.edges) return;
  for (std::size_t k = mesh_.first_edge[object]; k < mesh_.first_edge[object + 1]; ++k)
    if (mesh_.edges[k].other >= 0) seam(mesh_.edges[k]);
  const Color color = object < style_.outlines.size() ? style_.outlines[object] : theme_.outline;
  for (const Mesh::Outline& line : mesh_.outlines[object])
    outline(line, line.fixed ? theme_.fixed_outline : color);
}

void ObjectPainter::fill(int k, bool robot) {
  const auto [tl, tr, bl, br] = cell(k).points;
  const std::array<Point, 4> corners{pixel(tl), pixel(tr), pixel(br), pixel(bl)};
  const Voxel type = cell(k).type;
  Color color = robot ? color_of(theme_, type) : color_of_object(theme_, type);
  if (style_.tint && is_actuator(type))
    color = tinted(color, type, {point(tl), point(tr), point(bl), point(br)});
  if (const auto at = static_cast<std::size_t>(k);
      at < style_.values.size() && !std::isnan(style_.values[at]))
    color = color_of(*style_.scale, style_.values[at]);
  color = pale(color);
  colors_[static_cast<std::size_t>(k)] = color;
  if (!style_.voxels || !visible(to_pixels_, corners)) return;
  drawing_.quad(corners, color);
  if (theme_.signs && is_actuator(type) && to_pixels_.scale >= least_sign_voxel) sign(k);
}

// A double arrow along the axis of an actuator, bent with its cell.
void ObjectPainter::sign(int k) {
  const auto [tl, tr, bl, br] = cell(k).points;
  const bool across = cell(k).type == Voxel::horizontal;
  const auto at = [&](float along, float beside) {
    const float u = across ? along : beside;  // from the left
    const float v = across ? beside : along;  // from the top
    const auto blend = [&](float a, float b, float c, float d) {
      return (a * (1 - u) + b * u) * (1 - v) + (c * (1 - u) + d * u) * v;
    };
    return Point{blend(pixel(tl).x, pixel(tr).x, pixel(bl).x, pixel(br).x),
                 blend(pixel(tl).y, pixel(tr).y, pixel(bl).y, pixel(br).y)};
  };
  const Color color = pale(ink_on(color_of(theme_, cell(k).type)));
  const float width = to_pixels_.pixels(sign_width, 1.0);
  drawing_.segment(at(0.16F, 0.5F), at(0.84F, 0.5F), width, color);
  for (const float end : {0.16F, 0.84F}) {
    const float back = end < 0.5F ? end + 0.18F : end - 0.18F;
    const std::array<Point, 3> head{at(back, 0.32F), at(end, 0.5F), at(back, 0.68F)};
    drawing_.stroke(head, false, width, color);
  }
}

// Opaque, the colours of both cells shining through; a seam thinner than the
// line that stands for it is paler.
void ObjectPainter::seam(const Mesh::Edge& edge) {
  if (!visible(to_pixels_, std::array<Point, 2>{pixel(edge.a), pixel(edge.b)})) return;
  const Color line = both(edge, Voxel::fixed)   ? theme_.fixed_seam
                     : both(edge, Voxel::rigid) ? theme_.seam_on_dark
                                                : theme_.seam;
  const float width = to_pixels_.pixels(seam_width, least_line);
  const double strength = line.a / 255.0 * std::min(1.0, seam_width * to_pixels_.scale / width);
  const Color below = mix(colors_[static_cast<std::size_t>(edge.cell)],
                          colors_[static_cast<std::size_t>(edge.other)], 0.5);
  drawing_.segment(pixel(edge.a), pixel(edge.b), width,
                   mix(below, pale(with_alpha(line, 1.0)), strength));
}

void ObjectPainter::outline(const Mesh::Outline& line, Color color) {
  std::vector<Point> points;
  points.reserve(line.points.size());
  for (const int k : line.points) points.push_back(pixel(k));
  const double width = line.fixed ? terrain_outline_width : outline_width;
  drawing_.stroke(points, line.closed, to_pixels_.pixels(width, least_line), pale(color));
}

}  // namespace evo::render
