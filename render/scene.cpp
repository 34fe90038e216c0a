#include "render/scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace evo::render {
namespace {

// ---- line widths, in voxels unless said otherwise ---------------------------------

constexpr double outline_width = 0.12;  // surfaces of what moves
constexpr double terrain_outline_width = 0.09;
constexpr double seam_width = 0.045;
constexpr double trail_width = 0.11;
constexpr double arrow_width = 0.06;
// Every edge of a cell is covered by a line at least this wide, pixels: fills
// have jagged edges, lines smooth ones.
constexpr double least_line = 1.25;

// The grid has a line per voxel from the first size on, in pixels, fully visible
// from the second; below the last one it is left out.
constexpr double fine_grid_from = 6.0;
constexpr double fine_grid_full = 18.0;
constexpr double least_grid_voxel = 0.5;

// ---- from voxels to pixels -----------------------------------------------------------

struct Projection {
  Rect panel;
  double left, top;  // voxels at the panel's upper left corner
  double scale;      // pixels per voxel

  Projection(const ViewRect& view, const Rect& area)
      : panel(area),
        left(view.centre_x - view.width / 2),
        top(view.centre_y + view.height / 2),
        scale(static_cast<double>(area.width) / view.width) {}

  Point operator()(Vec2 p) const {
    return {panel.x + static_cast<float>((p.x - left) * scale),
            panel.y + static_cast<float>((top - p.y) * scale)};
  }
  float pixels(double voxels, double least) const {
    return static_cast<float>(std::max(voxels * scale, least));
  }
  double right() const { return left + panel.width / scale; }
  double low() const { return top - panel.height / scale; }
};

// ---- background ------------------------------------------------------------------------

void draw_sky_and_earth(const Scene& scene, const Theme& theme, const Projection& to_pixels,
                        Drawing& drawing) {
  if (!scene.sky) return;
  const Rect& panel = to_pixels.panel;
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
  drawing.line({to_pixels.panel.x, floor}, {to_pixels.panel.x + to_pixels.panel.width, floor},
               to_pixels.pixels(0.08, 1.0), theme.floor_line);
  const float size = label_size(to_pixels.panel) * 0.8F;
  const float strip = to_pixels.panel.y + to_pixels.panel.height - floor;
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
    drawing.text({{at.x, at.y + tick + 1.15F * size},
                  size,
                  digits,
                  theme.text_on_earth,
                  Align::centre,
                  false});
  });
}

// ---- objects ------------------------------------------------------------------------------

double distance(Vec2 a, Vec2 b) { return std::hypot(a.x - b.x, a.y - b.y); }

// An actuator's colour by how long it is now: darker when contracted, lighter
// when expanded. Lightness is seen with any colour vision.
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

class ObjectPainter {
 public:
  ObjectPainter(const Scene& scene, const Theme& theme, const Projection& to_pixels,
                Drawing& drawing)
      : scene_(scene),
        theme_(theme),
        to_pixels_(to_pixels),
        drawing_(drawing),
        colors_(scene.mesh->cells.size()) {
    pixels_.reserve(scene.points.size());
    for (const Vec2& p : scene.points) pixels_.push_back(to_pixels(p));
  }

  void draw(std::size_t object) {
    const ModelObject& cells = scene_.mesh->objects[object];
    for (int k = cells.first_cell; k < cells.first_cell + cells.cells; ++k) fill(k);
    for (std::size_t k = scene_.mesh->first_edge[object]; k < scene_.mesh->first_edge[object + 1];
         ++k)
      if (scene_.mesh->edges[k].other >= 0) seam(scene_.mesh->edges[k]);
    for (const Mesh::Outline& line : scene_.mesh->outlines[object]) outline(line);
  }

 private:
  Point pixel(int point) const { return pixels_[static_cast<std::size_t>(point)]; }
  Vec2 point(int k) const { return scene_.points[static_cast<std::size_t>(k)]; }
  const ModelCell& cell(int k) const { return scene_.mesh->cells[static_cast<std::size_t>(k)]; }
  bool both(const Mesh::Edge& edge, Voxel type) const {
    return cell(edge.cell).type == type && cell(edge.other).type == type;
  }

  void fill(int k) {
    const auto [tl, tr, bl, br] = cell(k).points;
    const std::array<Point, 4> corners{pixel(tl), pixel(tr), pixel(br), pixel(bl)};
    Color color = color_of(theme_, cell(k).type);
    if (scene_.tint && is_actuator(cell(k).type))
      color = tinted(color, cell(k).type, {point(tl), point(tr), point(bl), point(br)});
    colors_[static_cast<std::size_t>(k)] = color;
    if (visible(to_pixels_, corners)) drawing_.quad(corners, color);
  }

  // Opaque, the colours of both cells shining through; a seam thinner than the
  // line that stands for it is paler.
  void seam(const Mesh::Edge& edge) {
    if (!visible(to_pixels_, std::array<Point, 2>{pixel(edge.a), pixel(edge.b)})) return;
    const Color line = both(edge, Voxel::fixed)   ? theme_.fixed_seam
                       : both(edge, Voxel::rigid) ? theme_.seam_on_dark
                                                  : theme_.seam;
    const float width = to_pixels_.pixels(seam_width, least_line);
    const double strength = line.a / 255.0 * std::min(1.0, seam_width * to_pixels_.scale / width);
    const Color below = mix(colors_[static_cast<std::size_t>(edge.cell)],
                            colors_[static_cast<std::size_t>(edge.other)], 0.5);
    drawing_.segment(pixel(edge.a), pixel(edge.b), width,
                     mix(below, with_alpha(line, 1.0), strength));
  }

  void outline(const Mesh::Outline& line) {
    std::vector<Point> points;
    points.reserve(line.points.size());
    for (const int k : line.points) points.push_back(pixel(k));
    const double width = line.fixed ? terrain_outline_width : outline_width;
    drawing_.stroke(points, line.closed, to_pixels_.pixels(width, least_line),
                    line.fixed ? theme_.fixed_outline : theme_.outline);
  }

  const Scene& scene_;
  const Theme& theme_;
  const Projection& to_pixels_;
  Drawing& drawing_;
  std::vector<Point> pixels_;
  std::vector<Color> colors_;  // of cells, as filled
};

// ---- overlays --------------------------------------------------------------------------------

void draw_trail(const Scene& scene, const Theme& theme, const Projection& to_pixels,
                Drawing& drawing) {
  if (scene.trail.empty()) return;
  const float width = to_pixels.pixels(trail_width, 1.2);
  const auto n = static_cast<double>(scene.trail.size());
  for (std::size_t k = 1; k < scene.trail.size(); ++k) {
    // The past is paler, never invisible.
    const double age = (n - static_cast<double>(k)) / n;
    drawing.line(to_pixels(scene.trail[k - 1]), to_pixels(scene.trail[k]), width,
                 mix(theme.trail, theme.sky_bottom, 0.6 * age));
  }
  drawing.disc(to_pixels(scene.trail.back()), 1.6F * width, theme.trail);
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
// lie between.
void draw_way_to_goal(Vec2 goal, const Theme& theme, const Projection& to_pixels,
                      Drawing& drawing) {
  const Rect& panel = to_pixels.panel;
  const float size = std::max(8.0F, label_size(panel));
  const bool right = goal.x > to_pixels.right();
  const float side = right ? 1.0F : -1.0F;
  const float border = right ? panel.x + panel.width : panel.x;
  const float y = panel.y + 0.45F * panel.height;
  const Point tip{border - side * 0.6F * size, y};
  const float base = tip.x - side * 1.1F * size;
  smooth_triangle({tip, {base, y - 0.8F * size}, {base, y + 0.8F * size}}, theme.trail, drawing);
  const double voxels = right ? goal.x - to_pixels.right() : to_pixels.left - goal.x;
  drawing.text({{base - side * 0.4F * size, y + 0.36F * size},
                size,
                std::to_string(std::lround(voxels)),
                theme.trail,
                right ? Align::right : Align::left,
                true});
}

void draw_goal(Vec2 goal, const Theme& theme, const Projection& to_pixels, Drawing& drawing) {
  if (goal.x < to_pixels.left || goal.x > to_pixels.right()) {
    draw_way_to_goal(goal, theme, to_pixels, drawing);
  } else {
    draw_flag(goal, theme, to_pixels, drawing);
  }
}

void draw_arrow(const Arrow& arrow, const Theme& theme, const Projection& to_pixels,
                Drawing& drawing) {
  const Point a = to_pixels(arrow.from);
  const Point b = to_pixels(arrow.to);
  const float length = std::hypot(b.x - a.x, b.y - a.y);
  const float width = to_pixels.pixels(arrow_width, 1.0);
  if (length < width) return;
  drawing.line(a, b, width, theme.arrow);
  const float head = std::min(length, 4.5F * width);
  const Point along{(b.x - a.x) / length, (b.y - a.y) / length};
  const Point base{b.x - along.x * head, b.y - along.y * head};
  const float half = 0.45F * head;
  const Point tip{b.x + along.x * width, b.y + along.y * width};
  drawing.triangle({tip,
                    {base.x - along.y * half, base.y + along.x * half},
                    {base.x + along.y * half, base.y - along.x * half}},
                   theme.arrow);
}

// ---- outlines ---------------------------------------------------------------------------------

// Joins surface edges of one look end to end.
class Tracer {
 public:
  explicit Tracer(std::vector<Mesh::Edge> edges) : edges_(std::move(edges)), used_(edges_.size()) {
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      at_[edges_[k].a].push_back(k);
      at_[edges_[k].b].push_back(k);
    }
  }

  // Open lines first, from their ends; what is left are closed ones.
  std::vector<Mesh::Outline> trace(bool fixed) {
    std::vector<Mesh::Outline> lines;
    for (const bool ends_only : {true, false})
      for (std::size_t k = 0; k < edges_.size(); ++k)
        for (const int start : {edges_[k].a, edges_[k].b})
          if (!used_[k] && (!ends_only || at_[start].size() % 2 == 1))
            lines.push_back(walk(start, k, fixed));
    return lines;
  }

 private:
  Mesh::Outline walk(int start, std::size_t edge, bool fixed) {
    Mesh::Outline line{{start}, false, fixed};
    for (std::optional<std::size_t> next = edge; next; next = follow(line.points.back(), *next)) {
      used_[*next] = true;
      const Mesh::Edge& e = edges_[*next];
      line.points.push_back(e.a == line.points.back() ? e.b : e.a);
    }
    line.closed = line.points.size() > 3 && line.points.back() == start;
    if (line.closed) line.points.pop_back();
    return line;
  }

  // Where two corners touch, the border of the same cell goes on.
  std::optional<std::size_t> follow(int point, std::size_t from) const {
    std::optional<std::size_t> next;
    for (const std::size_t k : at_.at(point)) {
      if (used_[k]) continue;
      if (!next || edges_[k].cell == edges_[from].cell) next = k;
    }
    return next;
  }

  std::vector<Mesh::Edge> edges_;
  std::vector<bool> used_;
  std::map<int, std::vector<std::size_t>> at_;  // edges at a point
};

std::vector<Mesh::Outline> outlines(const Mesh& mesh, std::size_t object) {
  std::vector<Mesh::Outline> all;
  for (const bool fixed : {true, false}) {
    std::vector<Mesh::Edge> surfaces;
    for (std::size_t k = mesh.first_edge[object]; k < mesh.first_edge[object + 1]; ++k) {
      const Mesh::Edge& edge = mesh.edges[k];
      const bool terrain = mesh.cells[static_cast<std::size_t>(edge.cell)].type == Voxel::fixed;
      if (edge.other < 0 && terrain == fixed) surfaces.push_back(edge);
    }
    const auto lines = Tracer(std::move(surfaces)).trace(fixed);
    all.insert(all.end(), lines.begin(), lines.end());
  }
  return all;
}

}  // namespace

// ---- mesh
// ----------------------------------------------------------------------------------------

int Mesh::object_index(const std::string& name) const {
  for (std::size_t k = 0; k < objects.size(); ++k)
    if (objects[k].name == name) return static_cast<int>(k);
  return -1;
}

Mesh make_mesh(const RolloutWorld& world) {
  Mesh mesh;
  mesh.objects = world.objects;
  mesh.cells = world.cells;
  mesh.first_edge.push_back(0);
  for (std::size_t k = 0; k < mesh.objects.size(); ++k) {
    const ModelObject& object = mesh.objects[k];
    std::map<std::pair<int, int>, Mesh::Edge> edges;
    for (int c = object.first_cell; c < object.first_cell + object.cells; ++c) {
      const auto [tl, tr, bl, br] = mesh.cells[static_cast<std::size_t>(c)].points;
      for (const auto& [a, b] :
           {std::minmax(tl, tr), std::minmax(bl, br), std::minmax(tl, bl), std::minmax(tr, br)}) {
        const auto [entry, fresh] = edges.try_emplace({a, b}, Mesh::Edge{a, b, c, -1});
        if (!fresh) entry->second.other = c;
      }
    }
    for (const auto& [ends, edge] : edges) mesh.edges.push_back(edge);
    mesh.first_edge.push_back(mesh.edges.size());
    mesh.outlines.push_back(outlines(mesh, k));
  }
  return mesh;
}

Mesh make_mesh(const Body& body, std::vector<Vec2>& corners) {
  Mesh mesh;
  const int across = body.cols + 1;
  corners.clear();
  for (int row = 0; row <= body.rows; ++row)
    for (int col = 0; col <= body.cols; ++col)
      corners.push_back({static_cast<double>(col), static_cast<double>(body.rows - row)});
  const auto linked = [&](int a, int b) {
    return std::binary_search(body.links.begin(), body.links.end(),
                              Link{std::min(a, b), std::max(a, b)});
  };
  std::map<std::pair<int, int>, std::size_t> edge_at;  // by its ends, the latest
  for (int row = 0; row < body.rows; ++row)
    for (int col = 0; col < body.cols; ++col) {
      const Voxel type = body.at(row, col);
      if (type == Voxel::empty) continue;
      const int here = body.index(row, col);
      const auto cell = static_cast<int>(mesh.cells.size());
      const int tl = row * across + col;
      const int bl = tl + across;
      mesh.cells.push_back({0, type, {tl, tl + 1, bl, bl + 1}});
      const auto add = [&](int a, int b) {
        edge_at[{a, b}] = mesh.edges.size();
        mesh.edges.push_back({a, b, cell, -1});
      };
      // The cells above and to the left are there already.
      const auto join = [&](int a, int b, bool inside, int there) {
        if (inside && linked(there, here))
          mesh.edges[edge_at.at({a, b})].other = cell;
        else
          add(a, b);
      };
      join(tl, tl + 1, row > 0, here - body.cols);
      join(tl, bl, col > 0, here - 1);
      add(bl, bl + 1);
      add(tl + 1, bl + 1);
    }
  mesh.objects.push_back({"robot", 0, static_cast<int>(corners.size()), 0,
                          static_cast<int>(mesh.cells.size()), false});
  mesh.first_edge = {0, mesh.edges.size()};
  mesh.outlines.push_back(outlines(mesh, 0));
  return mesh;
}

// ---- scene ---------------------------------------------------------------------------------

void draw_scene(const Scene& scene, const Theme& theme, const Rect& panel, Drawing& drawing) {
  const Projection to_pixels(
      fit(scene.view, static_cast<double>(panel.width) / static_cast<double>(panel.height)), panel);
  drawing.clip(panel);
  draw_sky_and_earth(scene, theme, to_pixels, drawing);
  if (scene.grid) draw_grid(scene, theme, to_pixels, drawing);
  draw_ruler(scene, theme, to_pixels, drawing);
  if (scene.goal) draw_goal(*scene.goal, theme, to_pixels, drawing);
  ObjectPainter objects(scene, theme, to_pixels, drawing);
  // The robot comes first in world order and is seen in front of everything.
  for (std::size_t k = scene.mesh->objects.size(); k-- > 0;) objects.draw(k);
  draw_trail(scene, theme, to_pixels, drawing);
  for (const Arrow& arrow : scene.arrows) draw_arrow(arrow, theme, to_pixels, drawing);
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
