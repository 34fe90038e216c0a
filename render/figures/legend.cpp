#include "render/figures/legend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "libevo/task/spec.h"
#include "render/figures/round_numbers.h"
#include "render/figures/sheet.h"

namespace evo::render {
namespace {

bool has(const Mesh& mesh, bool robot, Voxel type) {
  for (const ModelObject& object : mesh.objects) {
    if ((object.name == robot_name) != robot) continue;
    for (int k = object.first_cell; k < object.first_cell + object.cells; ++k)
      if (mesh.cells[static_cast<std::size_t>(k)].type == type) return true;
  }
  return false;
}

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
  drawing.text({{right - length - 0.6F * size, y + 0.36F * size},
                size,
                name,
                theme.text,
                Align::right,
                false});
}

}  // namespace

void draw_legend(const Mesh& mesh, double scale, const Theme& theme, const Rect& area, float size,
                 Typesetter& typesetter, Drawing& drawing) {
  struct Entry {
    Voxel type;
    const char* name;
  };
  constexpr std::array kinds{Entry{Voxel::rigid, "rigid"}, Entry{Voxel::soft, "soft"},
                             Entry{Voxel::horizontal, "horizontal actuator"},
                             Entry{Voxel::vertical, "vertical actuator"}};
  float x = area.x;
  const float side = 1.15F * size;
  const float top = area.y + (area.height - side) / 2;
  const float baseline = area.y + area.height / 2 + 0.36F * size;
  const auto name = [&](const char* text) {
    x += side + 0.45F * size;
    drawing.text({{x, baseline}, size, text, theme.text, Align::left, false});
    x += typesetter.width(text, size) + 1.4F * size;
  };
  for (const Entry& kind : kinds) {
    if (!has(mesh, true, kind.type)) continue;
    const Body voxel = Body::from_rows({std::string(1, letter(kind.type))});
    draw_body(voxel, {1, 1}, theme, {x, top, side, side}, drawing);
    name(kind.name);
  }
  for (const Voxel type : {Voxel::rigid, Voxel::soft}) {
    if (!has(mesh, false, type)) continue;
    drawing.rectangle({x, top, side, side}, theme.outline);
    drawing.rectangle({x + 1.5F, top + 1.5F, side - 3, side - 3}, color_of_object(theme, type));
    name(type == Voxel::rigid ? "object" : "soft object");
  }
  if (scale > 0) draw_scale_bar(scale, x, theme, area, size, typesetter, drawing);
}

}  // namespace evo::render
