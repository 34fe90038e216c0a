// Bodies, packages and terrain: cells filled, the seams between them, outlines.
#pragma once

#include <array>
#include <span>

#include "render/scene/mesh.h"
#include "render/scene/projection.h"
#include "render/scene/theme.h"
#include "render/scene/value_scale.h"

namespace evo::render {

// ---- widths, in voxels ----
inline constexpr double outline_width = 0.12;  // surfaces of what moves
inline constexpr double terrain_outline_width = 0.09;
inline constexpr double seam_width = 0.045;

// An actuator's colour by how long it is now: darker when contracted, lighter when expanded.
// Lightness is seen with any colour vision. `p`: as ModelCell's points.
Color tinted(Color color, Voxel type, const std::array<Vec2, 4>& p);

struct ObjectStyle {
  bool tint = true;                 // actuators lighter when expanded, darker when contracted
  double pale = 0.0;                // share of the background in every colour, for ghosts
  std::span<const float> values{};  // of cells, for colours in place of their kinds'
  const ValueScale* scale = nullptr;
  std::span<const Color> outlines{};  // of objects that move, for the theme's
  bool edges = true;                  // outlines and seams are drawn
  bool voxels = true;                 // cells are filled
};

// Objects of a mesh whose points are at `points`, voxels.
class ObjectPainter {
 public:
  ObjectPainter(const Mesh& mesh, std::span<const Vec2> points, const ObjectStyle& style,
                const Theme& theme, const Projection& to_pixels, Drawing& drawing);

  void draw(std::size_t object);

 private:
  Point pixel(int point) const { return pixels_[static_cast<std::size_t>(point)]; }
  Vec2 point(int k) const { return points_[static_cast<std::size_t>(k)]; }
  const ModelCell& cell(int k) const { return mesh_.cells[static_cast<std::size_t>(k)]; }
  bool both(const Mesh::Edge& edge, Voxel type) const {
    return cell(edge.cell).type == type && cell(edge.other).type == type;
  }
  Color pale(Color color) const { return mix(color, with_alpha(background_, 1.0), style_.pale); }

  void fill(int k, bool robot);
  void sign(int k);
  void seam(const Mesh::Edge& edge);
  void outline(const Mesh::Outline& line, Color color);

  const Mesh& mesh_;
  std::span<const Vec2> points_;
  ObjectStyle style_;
  const Theme& theme_;
  const Projection& to_pixels_;
  Drawing& drawing_;
  Color background_;
  std::vector<Point> pixels_;
  std::vector<Color> colors_;  // of cells, as filled
};

}  // namespace evo::render
