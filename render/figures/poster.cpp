#include "render/figures/poster.h"

#include <algorithm>
#include <cmath>

#include "render/figures/chart.h"
#include "render/figures/sheet.h"
#include "render/painters/drawing.h"

namespace evo::render {
namespace {

constexpr Size a4{794, 1123};
constexpr float margin = 48;
constexpr float inside = static_cast<float>(a4.width) - 2 * margin;
constexpr float text = 12;

void heading(const char* words, Point at, const Theme& theme, Drawing& drawing) {
  drawing.text(at, 1.15F * text, words, theme.text, Align::left, true);
}

// A step for each robot, from the first with a fitness.
Chart curve(const std::vector<double>& best) {
  Series series{"", Series::Look::step};
  for (std::size_t k = 0; k < best.size(); ++k)
    if (!std::isnan(best[k]))
      series.points.push_back({static_cast<double>(k + 1), best[k], best[k], best[k]});
  return {"robots tried", "fitness", true, {series}};
}

// At most `most` (2 or more) places in the line, evenly chosen, the first and the last among them.
std::vector<std::size_t> chosen(std::size_t line, std::size_t most) {
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < std::min(line, most); ++k)
    places.push_back(line <= most ? k : (k * (line - 1) + (most - 1) / 2) / (most - 1));
  return places;
}

void draw_line(const PosterContent& content, const Rect& area, const Theme& theme,
               Typesetter& typesetter, Drawing& drawing) {
  constexpr std::size_t most = 8;
  const auto shown = chosen(content.line.size(), most);
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
}

}  // namespace

int poster_width() { return static_cast<int>(inside); }

Drawing poster(const PosterContent& content, const Drawing& moments, const Theme& theme,
               Typesetter& typesetter) {
  Drawing drawing(a4);
  drawing.rectangle(drawing.whole(), theme.paper);
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
    drawing.place(draw_chart(curve(content.best),
                             {static_cast<int>(inside) - 270, static_cast<int>(tall + 2.5F * text)},
                             theme, typesetter)
                      .drawing,
                  {margin + 270, y - 0.5F * text}, 1);
  y += tall + 5.0F * text;
  heading("Where it comes from", {margin, y}, theme, drawing);
  y += text;
  draw_line(content, {margin, y, inside, 0}, theme, typesetter, drawing);
  return drawing;
}

}  // namespace evo::render
