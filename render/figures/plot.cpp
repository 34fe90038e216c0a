#include "render/figures/plot.h"

#include <algorithm>
#include <cmath>

#include "libevo/base/error.h"
#include "render/scene/quantity.h"
#include "render/scene/round_numbers.h"

namespace evo::render {
namespace {

// Where steps are, and what every plot has.
struct Axes {
  Rect inside;
  float size;  // of text
  int first;   // step at the left
  int last;
  const Theme& theme;
  Drawing& drawing;

  float x(double step) const {
    return inside.x + inside.width * static_cast<float>((step - first) / (last - first));
  }
  void title(const char* text) const {
    drawing.text({inside.x, inside.y - 0.75F * size}, size, text, theme.text, Align::left, true);
  }
  void steps_below() const {
    const double between = round_number_from((last - first) / 8.0);
    for (double t = std::ceil(first / between) * between; t <= last + 1e-9; t += between)
      drawing.text({x(t), inside.y + inside.height + 1.35F * size}, 0.9F * size,
                   fmt::format("{:.0f}", t), theme.text_muted, Align::centre);
  }
  void cursor(double now) const {
    drawing.segment({x(now), inside.y - 0.3F * size},
                    {x(now), inside.y + inside.height + 0.3F * size}, std::max(1.0F, 0.12F * size),
                    theme.text);
  }
};

constexpr double future = 0.7;  // share of the paper in colours of what comes

void draw_return(const Clip& clip, double now, const Axes& axes) {
  double low = 0;
  double high = 0.1;
  for (int t = 0; t <= clip.steps(); ++t) {
    low = std::min(low, clip.score(t));
    high = std::max(high, clip.score(t));
  }
  const auto& [inside, size, first, last, theme, drawing] = axes;
  const auto y_of = [&, area = inside](double value) {
    return area.y + area.height * static_cast<float>((high - value) / (high - low));
  };
  axes.title("return");
  const double every = round_number_from((high - low) / 3);
  for (double y = std::ceil(low / every - 1e-9) * every; y <= high + 1e-9; y += every) {
    drawing.segment({inside.x, y_of(y)}, {inside.x + inside.width, y_of(y)}, 1, theme.grid_major);
    drawing.text({inside.x - 0.5F * size, y_of(y) + 0.36F * size}, 0.9F * size,
                 axis_number(y, every), theme.text_muted, Align::right);
  }
  for (const bool past : {false, true}) {
    std::vector<Point> points;
    const int end = past ? static_cast<int>(now) : last;
    for (int t = past ? first : static_cast<int>(now); t <= end; ++t)
      points.push_back({axes.x(t), y_of(clip.score(t))});
    const Color color = past ? theme.trail : mix(theme.trail, theme.paper, future);
    if (points.size() > 1) drawing.stroke(points, false, std::max(1.0F, 0.16F * size), color);
  }
  drawing.disc({axes.x(now), y_of(clip.score(now))}, 0.35F * size, theme.trail);
}

// A row per actuator, marked with its kind's colour: with twenty of them that follow
// each other, lines cannot be told apart.
void draw_commands(const Clip& clip, double now, const Axes& axes) {
  const std::vector<int> cells = actuators_of(clip.mesh());
  const auto& [inside, size, first, last, theme, drawing] = axes;
  axes.title("commanded length");
  const ValueScale scale = command_scale();
  // Colours in few steps, so that runs of one colour are one rectangle.
  constexpr double shades = 24;
  const auto shade = [&](int t, std::size_t k) {
    const auto commands = clip.commands(t);
    if (commands.size() != cells.size())
      throw Error(Failure::data,
                  "the episode does not have the actions of its actuators, so "
                  "commanded lengths cannot be plotted");
    return static_cast<int>(std::lround((commands[k] - scale.low) * shades));
  };
  const float row = inside.height / static_cast<float>(std::max<std::size_t>(1, cells.size()));
  const float gap = row >= 5 ? 1.0F : 0.0F;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const float y = inside.y + row * static_cast<float>(k);
    drawing.rectangle({inside.x - 0.9F * size, y, 0.6F * size, row - gap},
                      color_of(theme, clip.mesh().cells[static_cast<std::size_t>(cells[k])].type));
    const int end = std::min(last, clip.steps());
    for (int from = first, to = first; from < end; from = to) {
      const int here = shade(from, k);
      const bool past = from < now;
      while (to < end && (to < now) == past && shade(to, k) == here) ++to;
      const Color color = color_of(scale, scale.low + here / shades);
      drawing.rectangle({axes.x(from), y, axes.x(to) - axes.x(from), row - gap},
                        past ? color : mix(color, theme.paper, future));
    }
  }
  // The colours' meaning, at the right of the title.
  const float width = 7 * size;
  const float right = inside.x + inside.width - 1.8F * size;
  const float y = inside.y - 1.5F * size;
  constexpr int parts = 24;
  for (int part = 0; part < parts; ++part) {
    const float x = right - width + width * static_cast<float>(part) / parts;
    drawing.rectangle({x, y, right - x, 0.8F * size},
                      color_of(scale, scale.low + (scale.high - scale.low) * (part + 0.5) / parts));
  }
  drawing.text({right - width - 0.4F * size, y + 0.75F * size}, 0.9F * size,
               axis_number(scale.low, 0.1), theme.text_muted, Align::right);
  drawing.text({right + 0.4F * size, y + 0.75F * size}, 0.9F * size, axis_number(scale.high, 0.1),
               theme.text_muted);
}

}  // namespace

Rect plot_area(const Rect& whole) {
  const float height = std::round(0.24F * whole.height);
  return {whole.x, whole.y + whole.height - height, whole.width, height};
}

void draw_plot(const Clip& clip, Plot plot, double step, const Theme& theme, const Rect& area,
               Drawing& drawing) {
  drawing.clip(area);
  drawing.rectangle(area, theme.paper);
  const float size = std::max(8.0F, 0.085F * area.height);
  const Rect inside{area.x + 4.2F * size, area.y + 2.1F * size, area.width - 5.8F * size,
                    area.height - 4.0F * size};
  if (inside.width < 8 * size || inside.height < size) return;
  const double now = std::clamp(step, 0.0, static_cast<double>(clip.steps()));
  // About the present moment: what happened long ago says nothing of what is seen.
  constexpr int most = 240;
  const int shown = std::clamp(clip.steps(), 1, most);
  const int first =
      std::clamp(static_cast<int>(now) - shown / 2, 0, std::max(0, clip.steps() - shown));
  const Axes axes{inside, size, first, first + shown, theme, drawing};
  if (plot == Plot::reward_sum)
    draw_return(clip, now, axes);
  else
    draw_commands(clip, now, axes);
  axes.steps_below();
  axes.cursor(now);
}

}  // namespace evo::render
