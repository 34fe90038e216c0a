#include "render/figures/legend.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "libevo/task/spec.h"
#include "render/figures/sheet.h"
#include "render/scene/round_numbers.h"

namespace evo::render {
namespace {

// Left out where it would reach to the left of `from`.
void draw_scale_bar(double scale, float from, const Theme& theme, const Rect& area, float size,
                    Typesetter& typesetter, Drawing& drawing) {
  constexpr double least = 4.0;  // widths of a letter
  const double wanted = std::max(1.0, least * static_cast<double>(size) / scale);
  const int voxels = static_cast<int>(std::lround(round_number_from(wanted)));
  const float right = area.x + area.width;
  const auto length = static_cast<float>(voxels * scale);
  const float y = area.y + area.height / 2;
  const float tick = 0.3F * size;
  const std::string name = std::to_string(voxels) + (voxels == 1 ? " voxel" : " voxels");
  if (right - length - 0.6F * size - typesetter.width(name, size) < from) return;
  drawing.segment({right - length, y}, {right, y}, 1.5F, theme.text);
  for (const float x : {right - length, right})
    drawing.segment({x, y - tick}, {x, y + tick}, 1.5F, theme.text);
  drawing.text({right - length - 0.6F * size, y + 0.36F * size}, size, name, theme.text,
               Align::right);
}

// A legend being drawn, from the left.
struct Row {
  const Theme& theme;
  const Rect& area;
  float size;
  Typesetter& typesetter;
  Drawing& drawing;
  float x = area.x;
  float side = 1.15F * size;
  float top = area.y + (area.height - side) / 2;
  float baseline = area.y + area.height / 2 + 0.36F * size;

  void name(const std::string& text) {
    x += side + 0.45F * size;
    drawing.text({x, baseline}, size, text, theme.text);
    x += typesetter.width(text, size) + 1.4F * size;
  }
  void robot(const std::set<Voxel>& kinds) {
    for (const Voxel kind : voxel_kinds) {
      if (!kinds.contains(kind)) continue;
      const Body voxel = Body::from_rows({std::string(1, letter(kind))});
      draw_body(voxel, {1, 1}, theme, {x, top, side, side}, drawing);
      name(kind_name(kind) + std::string(is_actuator(kind) ? " actuator" : ""));
    }
  }
  void objects(const std::set<Voxel>& kinds) {
    for (const Voxel type : {Voxel::rigid, Voxel::soft}) {
      if (!kinds.contains(type)) continue;
      drawing.rectangle({x, top, side, side}, theme.outline);
      drawing.rectangle({x + 1.5F, top + 1.5F, side - 3, side - 3}, color_of_object(theme, type));
      name(type == Voxel::rigid ? "object" : "soft object");
    }
  }
};

constexpr float least_size = 5.5F;  // pixels; smaller cannot be read

// The size of text, `size` at most, with which a row stays inside of the area.
template <typename RowOf>
float fitting(const RowOf& row_of, const Rect& area, float size) {
  Drawing aside({1, 1});
  const float length = row_of(size, aside).x - area.x - size;
  return length > area.width ? size * area.width / length : size;
}

}  // namespace

void Kinds::add(const Mesh& mesh, std::span<const float> values) {
  for (const ModelObject& object : mesh.objects) {
    std::set<Voxel>& kinds = object.name == robot_name ? of_robots : of_objects;
    for (int k = object.first_cell; k < object.first_cell + object.cells; ++k)
      if (values.empty() || std::isnan(values[static_cast<std::size_t>(k)]))
        kinds.insert(mesh.cells[static_cast<std::size_t>(k)].type);
  }
}

void draw_legend(const Kinds& kinds, double scale, const Theme& theme, const Rect& area, float size,
                 Typesetter& typesetter, Drawing& drawing, bool plate) {
  const auto row_of = [&](float text, Drawing& where) {
    Row row{theme, area, text, typesetter, where};
    row.robot(kinds.of_robots);
    row.objects(kinds.of_objects);
    return row;
  };
  size = fitting(row_of, area, size);
  if (size < least_size) return;
  Drawing aside({1, 1});
  const float end = row_of(size, aside).x;
  if (plate && end > area.x)
    drawing.rounded_rectangle(
        {area.x - 0.5F * size, area.y + area.height / 2 - 0.95F * size, end - area.x, 1.9F * size},
        0.4F * size, theme.label);
  row_of(size, drawing);
  if (scale > 0) draw_scale_bar(scale, end, theme, area, size, typesetter, drawing);
}

}  // namespace evo::render
