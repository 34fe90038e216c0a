#include "render/figures/key.h"

#include <cmath>

#include "libevo/base/error.h"
#include "render/figures/label.h"
#include "render/scene/projection.h"
#include "render/scene/round_numbers.h"

namespace evo::render {
namespace {

// Plates from the top down, all as wide as the first ones need.
struct Column {
  Rect panel;
  float size;
  float y;
  float right() const { return panel.x + panel.width - 0.8F * size; }
  // The next plate, its inside.
  Rect next(float width, float height) {
    const Rect inside{right() - width - 0.75F * size, y + 0.5F * size, width, height};
    y += height + 1.4F * size;
    return inside;
  }
};

void plate(const Rect& inside, float size, const Theme& theme, Drawing& drawing) {
  drawing.rounded_rectangle({inside.x - 0.75F * size, inside.y - 0.5F * size,
                             inside.width + 1.5F * size, inside.height + size},
                            0.5F * size, theme.label);
}

void draw_arrow_key(double pixels_of_one, const char* one, const char* many, Color color,
                    const Theme& theme, Column& column, Typesetter& typesetter, Drawing& drawing) {
  const float size = column.size;
  const double amount = round_number_from(2.5 * static_cast<double>(size) / pixels_of_one);
  const auto length = static_cast<float>(amount * pixels_of_one);
  const std::string words = fmt::format("{:.3g} {}", amount, amount == 1 ? one : many);
  const Rect inside =
      column.next(length + 0.7F * size + typesetter.width(words, size), 0.9F * size);
  if (inside.x < column.panel.x) return;
  plate(inside, size, theme, drawing);
  const float y = inside.y + inside.height / 2;
  const float tip = inside.x + length;
  const float head = 0.5F * size;
  drawing.line({inside.x, y}, {tip - head, y}, 0.12F * size, color);
  drawing.triangle({Point{tip, y}, {tip - head, y - 0.45F * head}, {tip - head, y + 0.45F * head}},
                   color);
  drawing.text({tip + 0.7F * size, y + cap_height * size / 2}, size, words, theme.text);
}

std::string end_of(const ValueScale& scale, double value) {
  if (scale.powers) value = std::pow(10.0, value);
  const double size = std::abs(value);
  const std::string text = size < 1000 ? fmt::format("{:.3g}", size) : fmt::format("{:.0f}", size);
  return (value < 0 ? "\u2212" : "") + text;
}

void draw_colors(const ValueScale& scale, const Rect& bar, Drawing& drawing) {
  constexpr int parts = 48;
  for (int k = 0; k < parts; ++k) {
    const double share = (k + 0.5) / parts;
    // Each reaches to the end, under the next ones, so that no seam shows.
    const float x = bar.x + bar.width * static_cast<float>(k) / parts;
    drawing.rectangle({x, bar.y, bar.x + bar.width - x, bar.height},
                      color_of(scale, scale.low + share * (scale.high - scale.low)));
  }
}

void draw_value_bar(const ValueScale& scale, const Theme& theme, Column& column,
                    Typesetter& typesetter, Drawing& drawing) {
  const float size = column.size;
  const float width = std::max(9 * size, typesetter.width(scale.title, size));
  const Rect inside = column.next(width, 3.3F * size);
  if (inside.x < column.panel.x) return;
  plate(inside, size, theme, drawing);
  drawing.text({inside.x, inside.y + cap_height * size}, size, scale.title, theme.text);
  const Rect bar{inside.x, inside.y + 1.2F * size, inside.width, 0.8F * size};
  draw_colors(scale, bar, drawing);
  const float y = bar.y + bar.height + 0.2F * size + cap_height * size;
  const auto place = [&](double value) {
    return bar.x + bar.width * static_cast<float>((value - scale.low) / (scale.high - scale.low));
  };
  drawing.text({bar.x, y}, 0.9F * size, end_of(scale, scale.low), theme.text);
  drawing.text({place(scale.middle), y}, 0.9F * size, end_of(scale, scale.middle), theme.text,
               Align::centre);
  drawing.text({bar.x + bar.width, y}, 0.9F * size, end_of(scale, scale.high), theme.text,
               Align::right);
}

}  // namespace

void draw_value_line(const ValueScale& scale, const Theme& theme, Point centre, float size,
                     Typesetter& typesetter, Drawing& drawing) {
  const float length = 9 * size;
  const std::string low = end_of(scale, scale.low);
  const std::string high = end_of(scale, scale.high);
  const float gap = 0.5F * size;
  const float title = typesetter.width(scale.title, size);
  const float before = typesetter.width(low, size);
  float x = centre.x - (title + before + length + typesetter.width(high, size) + 4 * gap) / 2;
  const float baseline = centre.y + cap_height * size / 2;
  drawing.text({x, baseline}, size, scale.title, theme.text);
  drawing.text({x += title + 2 * gap, baseline}, size, low, theme.text_muted);
  const Rect bar{x += before + gap, centre.y - 0.45F * size, length, 0.9F * size};
  draw_colors(scale, bar, drawing);
  drawing.text({bar.x + length + gap, baseline}, size, high, theme.text_muted);
}

void draw_key(const Scene& scene, const Theme& theme, const Rect& panel, int captions,
              Typesetter& typesetter, Drawing& drawing) {
  const float size = key_size(panel);
  if (panel.height < (11 + 2.5F * static_cast<float>(captions)) * size) return;
  const Projection to_pixels(
      fit(scene.view, static_cast<double>(panel.width) / static_cast<double>(panel.height)), panel);
  Column column{panel, size,
                panel.y + (0.8F + static_cast<float>(captions) * row_of_labels) * size};
  drawing.clip(panel);
  if (!scene.values.empty()) draw_value_bar(scene.value_scale, theme, column, typesetter, drawing);
  if (scene.velocity_length > 0)
    draw_arrow_key(scene.velocity_length * to_pixels.scale, "voxel/s", "voxels/s", theme.arrow,
                   theme, column, typesetter, drawing);
  if (scene.force_length > 0)
    draw_arrow_key(scene.force_length * to_pixels.scale, "robot weight", "robot weights",
                   theme.trail, theme, column, typesetter, drawing);
}

}  // namespace evo::render
