#include "render/scene/notes.h"

#include <algorithm>
#include <cmath>

namespace evo::render {
namespace {

float text_size(const Rect& panel) { return std::max(8.0F, 0.85F * label_size(panel)); }

float plate_width(const std::string& text, float size) {
  return (0.7F * static_cast<float>(text.size()) + 0.6F) * size;
}
float plate_height(float size) { return 1.4F * size; }

void draw_plate(const Rect& plate, const Note& note, float size, const Theme& theme,
                Drawing& drawing) {
  const Color color = note.color.value_or(theme.trail);
  drawing.rounded_rectangle(plate, 0.4F * size, color);
  drawing.text({plate.x + plate.width / 2, plate.y + plate.height / 2 + 0.36F * size}, size,
               note.text, ink_on(color), Align::centre, true);
}

bool touch(const Rect& a, const Rect& b, float gap) {
  return a.x < b.x + b.width + gap && b.x < a.x + a.width + gap && a.y < b.y + b.height + gap &&
         b.y < a.y + a.height + gap;
}

bool inside(const Rect& area, const Rect& panel) {
  return area.x >= panel.x && area.x + area.width <= panel.x + panel.width && area.y >= panel.y &&
         area.y + area.height <= panel.y + panel.height;
}

}  // namespace

// ---- tags ----------------------------------------------------------------------------

std::vector<Rect> tag_plates(const std::vector<Note>& tags, const Projection& to_pixels) {
  const Rect& panel = to_pixels.panel;
  const float size = text_size(panel);
  const float height = plate_height(size);
  const float gap = 0.25F * size;
  std::vector<Rect> plates;
  for (const Note& tag : tags) {
    const float width = plate_width(tag.text, size);
    const Point at = to_pixels(tag.at);
    const float x =
        std::clamp(at.x - width / 2, panel.x + gap, panel.x + panel.width - width - gap);
    float y = std::clamp(at.y - height / 2, panel.y + gap, panel.y + panel.height - height - gap);
    for (const Rect& other : plates) {
      const float reach = (other.width + width) / 2 + gap;
      const float away = std::abs(other.x + other.width / 2 - x - width / 2);
      const float near = std::clamp(2 * (1.5F * reach - away) / reach, 0.0F, 1.0F);
      y = std::min(y, y + near * (other.y - height - gap - y));
    }
    plates.push_back({x, y, width, height});
  }
  // A pile that is too high for the panel stands lower.
  float top = panel.y + gap;
  for (const Rect& plate : plates) top = std::min(top, plate.y);
  for (Rect& plate : plates) plate.y += panel.y + gap - top;
  return plates;
}

void draw_tags(const std::vector<Note>& tags, const Theme& theme, const Projection& to_pixels,
               Drawing& drawing) {
  const float size = text_size(to_pixels.panel);
  const std::vector<Rect> plates = tag_plates(tags, to_pixels);
  for (std::size_t k = 0; k < tags.size(); ++k) {
    const float x = plates[k].x + plates[k].width / 2;
    const float y = plates[k].y + plates[k].height / 2;
    const Point named = to_pixels(tags[k].at);
    if (std::hypot(named.x - x, named.y - y) > plates[k].height)
      drawing.line({x, y}, named, 0.12F * size, tags[k].color.value_or(theme.trail));
  }
  for (std::size_t k = 0; k < tags.size(); ++k)
    draw_plate(plates[k], tags[k], size, theme, drawing);
}

// ---- pins ----------------------------------------------------------------------------

float pin_row(const Rect& panel) { return 2.1F * text_size(panel); }

void draw_pins(const Scene& scene, const Theme& theme, const Projection& to_pixels,
               Drawing& drawing) {
  const Rect& panel = to_pixels.panel;
  const float size = text_size(panel);
  const float height = plate_height(size);
  const float mark = 0.45F * size;
  const bool heights = scene.heights;
  // Beside the ruler, and below the captions.
  const float left = panel.x + 3.6F * size;
  const float top = panel.y + (heights ? scene.captions + 0.5F * size : 0);
  const Rect free{panel.x, top, panel.width, panel.y + panel.height - top};
  std::vector<Rect> plates;
  for (auto pin = scene.pins.rbegin(); pin != scene.pins.rend(); ++pin) {
    const float width = plate_width(pin->text, size);
    const Point at = to_pixels(pin->at);
    const Rect plate = heights ? Rect{left, at.y - height / 2, width, height}
                               : Rect{at.x - width / 2,
                                      panel.y + panel.height - height - 0.2F * size, width, height};
    const bool seen = heights ? at.y > free.y + mark && at.y < free.y + free.height - mark
                              : at.x > free.x + mark && at.x < free.x + free.width - mark;
    if (!seen) continue;
    const bool named = inside(plate, free) && std::ranges::none_of(plates, [&](const Rect& other) {
                         return touch(plate, other, 0.3F * size);
                       });
    // The tip of its mark, a triangle on a plate or a line without one.
    const Point tip = heights ? Point{left + width + mark, at.y} : Point{at.x, plate.y - mark};
    const float half = named ? 0.6F * mark : 0.12F * mark;
    const Color color = named ? theme.trail : mix(theme.trail, theme.paper, 0.4);
    const Point one =
        heights ? Point{tip.x - mark, tip.y - half} : Point{tip.x - half, tip.y + mark};
    const Point two =
        heights ? Point{tip.x - mark, tip.y + half} : Point{tip.x + half, tip.y + mark};
    if (named)
      drawing.triangle({tip, one, two}, color);
    else
      drawing.line({(one.x + two.x) / 2, (one.y + two.y) / 2}, tip, 2 * half, color);
    if (!named) continue;
    draw_plate(plate, *pin, size, theme, drawing);
    plates.push_back(plate);
  }
}

}  // namespace evo::render
