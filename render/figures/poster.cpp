#include "render/figures/poster.h"

#include <algorithm>
#include <cmath>

#include "render/figures/legend.h"
#include "render/figures/sheet.h"
#include "render/painters/drawing.h"
#include "render/scene/round_numbers.h"

namespace evo::render {
namespace {

constexpr int width = 794;  // of A4
constexpr float margin = 48;
constexpr float inside = static_cast<float>(width) - 2 * margin;
constexpr float text = 12;

void heading(const char* words, Point at, const Theme& theme, Drawing& drawing) {
  drawing.text(at, 1.15F * text, words, theme.text, Align::left, true);
}

// A step for each robot; the axes have few, round numbers.
void draw_curve(const std::vector<double>& best, const Rect& area, const Theme& theme,
                Drawing& drawing) {
  const Rect plot{area.x + 3.5F * text, area.y, area.width - 3.5F * text, area.height - 3 * text};
  const double low = std::min(0.0, *std::ranges::min_element(best));
  const double high = std::max(low + 1e-6, *std::ranges::max_element(best));
  const auto robots = static_cast<double>(best.size());
  const auto x_of = [&](double k) { return plot.x + plot.width * static_cast<float>(k / robots); };
  const auto y_of = [&](double value) {
    return plot.y + plot.height * static_cast<float>((high - value) / (high - low));
  };
  const double tick = round_number_from((high - low) / 6);
  for (double y = std::ceil(low / tick - 1e-9) * tick; y <= high + 1e-9; y += tick) {
    drawing.segment({plot.x, y_of(y)}, {plot.x + plot.width, y_of(y)}, 1, theme.grid_major);
    drawing.text({plot.x - 0.6F * text, y_of(y) + 0.36F * text}, text, axis_number(y, tick),
                 theme.text_muted, Align::right);
  }
  const double every = std::max(1.0, round_number_from(robots / 6));
  for (double k = 0; k <= robots + 1e-9; k += every)
    drawing.text({x_of(k), plot.y + plot.height + 1.4F * text}, text, axis_number(k, 1),
                 theme.text_muted, Align::centre);
  drawing.text({plot.x + plot.width / 2, plot.y + plot.height + 2.8F * text}, text, "robots tried",
               theme.text_muted, Align::centre);
  std::vector<Point> line;
  for (std::size_t k = 0; k < best.size(); ++k)
    if (k == 0 || best[k] != best[k - 1]) {
      const float x = x_of(static_cast<double>(k));
      if (k > 0) line.push_back({x, y_of(best[k - 1])});
      line.push_back({x, y_of(best[k])});
    }
  line.push_back({x_of(robots), y_of(best.back())});
  drawing.stroke(line, false, 2, theme.trail);
}

// Returns how high it is.
float draw_line(const PosterContent& content, const Rect& area, const Theme& theme,
                Typesetter& typesetter, Drawing& drawing) {
  constexpr std::size_t most = 8;
  const auto shown = chosen_generations(content.line.size(), most);
  Span span;
  for (const auto& [robot, generation] : content.line) {
    const Span own = span_of(robot.body);
    span = {std::max(span.cols, own.cols), std::max(span.rows, own.rows)};
  }
  const float gap = 10;
  const float card = (area.width + gap) / static_cast<float>(most) - gap;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const auto& [robot, generation] = content.line[shown[k]];
    const float x = area.x + static_cast<float>(k) * (card + gap);
    const Rect body{x + 6, area.y + 6, card - 12, card - 12};
    drawing.rounded_rectangle({x, area.y, card, card + 2.9F * text}, 6, theme.card);
    const Body* before = k > 0 ? &content.line[shown[k - 1]].robot.body : nullptr;
    draw_body(robot.body, span, theme, body, drawing, before);
    drawing.clip(drawing.whole());
    const Point below{x + card / 2, area.y + card + 0.9F * text};
    drawing.text(below, text, robot.fitness() ? signed_score(*robot.fitness()) : "failed",
                 theme.text, Align::centre, true);
    drawing.text(
        {below.x, below.y + 1.3F * text}, 0.85F * text,
        typesetter.shortened(fmt::format("generation {}", generation), 0.85F * text, false, card),
        theme.text_muted, Align::centre);
  }
  return card + 2.9F * text;
}

}  // namespace

int poster_width() { return static_cast<int>(inside); }

Drawing poster(const PosterContent& content, const Drawing& moments, const Theme& theme,
               Typesetter& typesetter) {
  Drawing drawing({width, largest_side});
  float y = margin + 1.2F * text;
  drawing.text({margin, y}, 2.2F * text, content.title, theme.text, Align::left, true);
  y += 2.0F * text;
  drawing.text({margin, y}, text, typesetter.shortened(content.sentence, text, false, inside),
               theme.text_muted);
  y += 3.0F * text;
  heading("What it does", {margin, y}, theme, drawing);
  y += text;
  constexpr float tallest = 380;
  const float scale = std::min({1.0F, inside / static_cast<float>(moments.size().width),
                                tallest / static_cast<float>(moments.size().height)});
  drawing.place(moments, {margin, y}, scale);
  y += scale * static_cast<float>(moments.size().height) + 2.6F * text;

  const Robot& best = content.line.back().robot;
  constexpr float tall = 230;
  heading("What it is", {margin, y}, theme, drawing);
  heading("The best so far", {margin + 270, y}, theme, drawing);
  y += text;
  draw_body(best.body, span_of(best.body), theme, {margin, y, tall, tall}, drawing);
  drawing.clip(drawing.whole());
  drawing.text({margin, y + tall + 1.5F * text}, text,
               best.id + (best.fitness() ? ", fitness " + signed_score(*best.fitness()) : ""),
               theme.text_muted);
  if (!content.best.empty())
    draw_curve(content.best, {margin + 270, y, inside - 270, tall + 2.2F * text}, theme, drawing);
  y += tall + 5.0F * text;
  heading("Where it comes from", {margin, y}, theme, drawing);
  y += text;
  y += draw_line(content, {margin, y, inside, 0}, theme, typesetter, drawing);
  Drawing page({width, static_cast<int>(y + margin)});
  page.rectangle(page.whole(), theme.paper);
  page.place(drawing, {0, 0}, 1);
  return page;
}

}  // namespace evo::render
