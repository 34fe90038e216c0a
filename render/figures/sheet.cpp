#include "render/figures/sheet.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "libevo/base/error.h"
#include "libevo/body/changes.h"
#include "libevo/body/extent.h"
#include "render/figures/key.h"
#include "render/figures/label.h"
#include "render/figures/legend.h"
#include "render/painters/drawing.h"

namespace evo::render {
namespace {

std::string fitness_text(const Robot& robot) {
  const auto fitness = robot.fitness();
  if (fitness) return signed_score(*fitness);
  return robot.failure() ? "failed" : std::string();
}

// Text centred at x, cut to `most` pixels.
void centred(std::string_view text, Point at, float size, Color color, bool bold, float most,
             Typesetter& typesetter, Drawing& drawing) {
  drawing.text(at, size, typesetter.shortened(text, size, bold, most), color, Align::centre, bold);
}

// The centre of the box around all cells.
Vec2 centre_of_voxels(const Mesh& mesh, const std::vector<Vec2>& points) {
  if (mesh.cells.empty()) return points.back();
  Bounds box;
  for (const ModelCell& cell : mesh.cells)
    for (const int k : cell.points) box.add(points[static_cast<std::size_t>(k)]);
  return {(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2};
}

// ---- cards ------------------------------------------------------------------------

// The measures of sheets of robots, all from the width of a card and the extents of
// the largest body.
struct CardStyle {
  float width;
  Span span;
  int text_lines;
  float text = 0.105F * width;
  float inset = 0.1F * width;
  float body() const {  // height of the space for the body
    const float proportion = static_cast<float>(span.rows) / static_cast<float>(span.cols);
    return (width - 2 * inset) * proportion + 1.5F * inset;
  }
  float height() const { return body() + (static_cast<float>(text_lines) * 1.35F + 0.55F) * text; }
};

// The name a robot was given, such as that of its run, or its id.
std::string name_of(const Robot& robot) {
  const auto given = robot.document.find("name");
  const bool named = given != robot.document.end() && given->is_string();
  return named ? given->get<std::string>() : robot.id;
}

void draw_card(const Robot& robot, const Theme& theme, const CardStyle& style, Point at,
               Typesetter& typesetter, Drawing& drawing) {
  drawing.rounded_rectangle({at.x, at.y, style.width, style.height()}, 0.06F * style.width,
                            theme.card);
  draw_body(robot.body, style.span, theme,
            {at.x + style.inset, at.y + style.inset, style.width - 2 * style.inset,
             style.body() - 1.5F * style.inset},
            drawing);
  const float most = style.width - style.inset;
  const float x = at.x + style.width / 2;
  float y = at.y + style.body() + style.text;
  const std::string fitness = fitness_text(robot);
  centred(fitness, {x, y}, style.text, theme.text, true, most, typesetter, drawing);
  if (style.text_lines > 1) y += 1.35F * style.text;
  centred(name_of(robot), {x, y}, 0.88F * style.text, theme.text_muted, false, most, typesetter,
          drawing);
}

// What holds every body of a sheet; never narrower than high by more than a half,
// so that text finds room below slim ones.
Span largest(const std::vector<Robot>& robots) {
  Span span;
  for (const Robot& robot : robots) {
    const Span own = span_of(robot.body);
    span = {std::max(span.cols, own.cols), std::max(span.rows, own.rows)};
  }
  return {std::max(span.cols, (2 * span.rows + 2) / 3), span.rows};
}

Drawing blank(Size size, const Theme& theme) {
  check_size(size);
  Drawing drawing(size);
  drawing.rectangle(drawing.whole(), theme.paper);
  return drawing;
}

struct GridLayout {
  int columns = 1;
  int rows = 1;
  float card = 0;
  float gap = 0;
  Size size;
};

// About `wished` columns, so that the last row is as full as possible.
int tidy_columns(int count, double wished) {
  const int middle = std::max(1, static_cast<int>(std::lround(wished)));
  int best = middle;
  const auto missing = [count](int columns) { return (columns - count % columns) % columns; };
  for (const int columns : {middle + 1, middle - 1, middle + 2})
    if (columns > 0 && missing(columns) < missing(best)) best = columns;
  return best;
}

// Fitness and names, or names alone where no robot has been evaluated.
int lines_below(const std::vector<Robot>& robots) {
  const auto scored = [](const Robot& robot) { return !fitness_text(robot).empty(); };
  return std::ranges::any_of(robots, scored) ? 2 : 1;
}

GridLayout lay_out(const std::vector<Robot>& robots, int width) {
  constexpr float smallest_card = 104;  // pixels, for ids that can be read
  constexpr float largest_card = 260;   // few robots make a small sheet, not huge letters
  constexpr float gap_share = 0.08F;    // of a card
  const auto count = static_cast<int>(robots.size());
  const Span span = largest(robots);
  const auto across = static_cast<float>(width);
  int columns = std::max(1, static_cast<int>(across / (smallest_card * (1 + gap_share))));
  // Few robots are drawn larger, on a sheet about as wide as a screen.
  constexpr double proportion = 1.9;  // columns to rows
  columns = std::min({columns, count, tidy_columns(count, std::sqrt(count * proportion))});
  for (;; ++columns) {
    GridLayout layout;
    layout.columns = columns;
    layout.rows = (count + columns - 1) / columns;
    const float units = static_cast<float>(columns) * (1 + gap_share) + gap_share;
    layout.card = std::min(largest_card, across / units);
    layout.gap = gap_share * layout.card;
    const float height =
        static_cast<float>(layout.rows) *
            (CardStyle{layout.card, span, lines_below(robots)}.height() + layout.gap) +
        layout.gap;
    if (height > static_cast<float>(largest_side) && columns < count) continue;
    layout.size = {static_cast<int>(std::lround(layout.card * units)),
                   static_cast<int>(std::lround(height))};
    return layout;
  }
}

}  // namespace

// ---- robots -------------------------------------------------------------------------

Span span_of(const Body& body) {
  const Extent around = extent(body);
  return {std::max(1, around.cols()), std::max(1, around.rows())};
}

void draw_body(const Body& body, const Span& span, const Theme& theme, const Rect& area,
               Drawing& drawing, const Body* before) {
  constexpr double border = 0.2;  // voxels, for the outline
  Scene scene;
  const Mesh mesh = make_mesh(body, scene.points);
  scene.mesh = &mesh;
  const Vec2 centre = centre_of_voxels(mesh, scene.points);
  scene.view = {centre.x, centre.y, span.cols + border, span.rows + border};
  scene.backdrop = scene.grid = scene.tint = false;
  if (before != nullptr)
    for (const Change& change : changes(*before, body)) {
      const double x = change.col;
      const double y = body.rows - change.row;
      scene.framed.push_back({Vec2{x, y}, {x + 1, y}, {x + 1, y - 1}, {x, y - 1}});
    }
  draw_scene(scene, theme, area, drawing);
  drawing.clip(drawing.whole());
}

Drawing robot_picture(const Robot& robot, const Theme& theme, Size size, Typesetter& typesetter) {
  check_size(size);
  Drawing drawing(size);
  const Rect whole = drawing.whole();
  const float text = std::max(8.0F, 0.045F * std::min(whole.height, 0.75F * whole.width));
  const float strip = whole.height > 8 * text ? 5.8F * text : 0;
  const Rect panel{0, 0, whole.width, whole.height - strip};
  Scene scene;
  const Mesh mesh = make_mesh(robot.body, scene.points);
  scene.mesh = &mesh;
  constexpr double margin = 1.0;  // voxels around the body
  const Vec2 centre = centre_of_voxels(mesh, scene.points);
  scene.view = {centre.x, centre.y, robot.body.cols + 2 * margin, robot.body.rows + 2 * margin};
  scene.floor = scene.tint = false;
  draw_scene(scene, theme, panel, drawing);
  drawing.clip(whole);
  if (strip == 0) return drawing;
  drawing.rectangle({0, panel.height, whole.width, strip}, theme.paper);
  const float x = whole.width / 2;
  const float most = whole.width - 2 * text;
  const auto named = robot.task();
  const std::string task = named ? *named + "   " : "";
  const std::string score = fitness_text(robot);
  const bool scored = !score.empty();
  const float middle = panel.height + 2.1F * text;
  const float first = scored ? middle - 0.35F * text : middle + 0.36F * text;
  centred(robot.id, {x, first}, text, theme.text, true, most, typesetter, drawing);
  if (scored)
    centred(task + "fitness " + score, {x, first + 1.45F * text}, 0.9F * text, theme.text_muted,
            false, most, typesetter, drawing);
  Kinds kinds;
  kinds.add(robot.body);
  draw_legend(kinds, 0, theme, {text, panel.height + 4.0F * text, most, 1.4F * text}, 0.8F * text,
              typesetter, drawing);
  return drawing;
}

Drawing robot_grid(const std::vector<Robot>& robots, const Theme& theme, int width,
                   Typesetter& typesetter) {
  if (robots.empty()) throw Error(Failure::data, "there is no robot to draw");
  check_size({width, 1});
  const GridLayout layout = lay_out(robots, width);
  const CardStyle style{layout.card, largest(robots), lines_below(robots)};
  const float text = std::max(8.0F, style.text);
  Size size = layout.size;
  size.height += static_cast<int>(std::lround(2.2F * text));
  Drawing drawing = blank(size, theme);
  Kinds kinds;
  for (std::size_t k = 0; k < robots.size(); ++k) {
    kinds.add(robots[k].body);
    const std::size_t column = k % static_cast<std::size_t>(layout.columns);
    const std::size_t row = k / static_cast<std::size_t>(layout.columns);
    draw_card(robots[k], theme, style,
              {layout.gap + static_cast<float>(column) * (layout.card + layout.gap),
               layout.gap + static_cast<float>(row) * (style.height() + layout.gap)},
              typesetter, drawing);
  }
  draw_legend(kinds, 0, theme,
              {layout.gap, static_cast<float>(layout.size.height),
               static_cast<float>(size.width) - 2 * layout.gap, 1.6F * text},
              text, typesetter, drawing);
  return drawing;
}

// ---- moments --------------------------------------------------------------------------------

namespace {

constexpr std::size_t most_in_a_row = 8;

std::size_t moment_columns(std::size_t moments) {
  if (moments <= most_in_a_row) return moments;
  return static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(moments) * 1.5)));
}

// Windows that differ little in height become one, so that the ground is on one line and a
// robot that hops is higher in one panel than in the next.
void align_windows(std::vector<Scene>& scenes) {
  constexpr double most = 1.5;  // of the largest window
  double low = 1e30;
  double top = -1e30;
  double largest = 0;
  for (const Scene& scene : scenes) {
    low = std::min(low, scene.view.centre_y - scene.view.height / 2);
    top = std::max(top, scene.view.centre_y + scene.view.height / 2);
    largest = std::max(largest, scene.view.height);
  }
  if (top - low > most * largest) return;
  for (Scene& scene : scenes) {
    const double aspect = scene.view.width / scene.view.height;
    scene.view = {scene.view.centre_x, (low + top) / 2, aspect * (top - low), top - low};
  }
}

}  // namespace

double moment_aspect(std::size_t moments) { return moments <= 2 ? 1.5 : moments <= 4 ? 1.2 : 0.95; }

namespace {

// A picture of a sheet, with two lines below.
struct Panel {
  Scene scene;
  std::string name;
  std::string note;
};

// What a sheet says above and below its panels: whose they are on the left, what they have in
// common on the right; the voxels of all.
struct Frame {
  std::string title;
  std::string detail;
  Kinds kinds;
};

Drawing panel_sheet(const std::vector<Panel>& panels, std::size_t columns, const Frame& frame,
                    const Theme& theme, int width, Typesetter& typesetter) {
  check_size({width, 1});
  const std::size_t rows = (panels.size() + columns - 1) / columns;
  const float gap = 0.008F * static_cast<float>(width);
  const auto across = static_cast<float>(columns);
  const float panel = (static_cast<float>(width) - (across + 1) * gap) / across;
  const float high = panel / static_cast<float>(moment_aspect(panels.size()));
  const float text = std::max(8.0F, 0.07F * panel);
  const float strip = 3.6F * text;
  const float heading = 2.6F * text + gap;
  const bool colors = !panels.front().scene.values.empty();
  const float key = 2.4F * text;
  const float end = heading + static_cast<float>(rows) * (high + strip);
  Drawing drawing = blank({width, static_cast<int>(std::lround(end + key))}, theme);
  drawing.text({gap, gap + 1.5F * text}, 1.1F * text, frame.title, theme.text, Align::left, true);
  drawing.text({static_cast<float>(width) - gap, gap + 1.5F * text}, text, frame.detail,
               theme.text_muted, Align::right);
  for (std::size_t k = 0; k < panels.size(); ++k) {
    const std::size_t column = k % columns;
    const std::size_t row = k / columns;
    const float x = gap + static_cast<float>(column) * (panel + gap);
    const float y = heading + static_cast<float>(row) * (high + strip);
    // Whole pixels, so that all panels are cut alike.
    draw_scene(panels[k].scene, theme,
               {std::round(x), std::round(y), std::round(panel), std::round(high)}, drawing);
    drawing.clip(drawing.whole());
    const float middle = x + panel / 2;
    centred(panels[k].name, {middle, y + high + 1.35F * text}, text, theme.text, true, panel,
            typesetter, drawing);
    centred(panels[k].note, {middle, y + high + 2.6F * text}, 0.9F * text, theme.text_muted, false,
            panel, typesetter, drawing);
  }
  const Rect below{gap, end, static_cast<float>(width) - 2 * gap, 1.6F * text};
  if (colors)
    draw_value_line(panels.front().scene.value_scale, theme,
                    {below.x + below.width / 2, below.y + below.height / 2}, text, typesetter,
                    drawing);
  else
    draw_legend(frame.kinds, 0, theme, below, text, typesetter, drawing);
  return drawing;
}

// Rows as full as can be, near the shape of a sheet of moments.
std::size_t robot_columns(std::size_t robots) {
  const std::size_t usual = moment_columns(robots);
  std::size_t best = usual;
  const auto empty = [&](std::size_t columns) { return (columns - robots % columns) % columns; };
  for (const std::size_t columns : {usual - 1, usual + 1})
    if (columns > 2 && columns <= most_in_a_row && empty(columns) < empty(best)) best = columns;
  return best;
}

std::string return_of(const Clip& clip, double step) {
  return "return " + signed_score(clip.score(step));
}

}  // namespace

Drawing moment_sheet(const Clip& clip, const std::vector<double>& moments, const Theme& theme,
                     int width, Typesetter& typesetter) {
  std::vector<Scene> scenes;
  for (const double moment : moments) scenes.push_back(clip.scene(moment));
  align_windows(scenes);
  std::vector<Panel> panels;
  for (std::size_t k = 0; k < moments.size(); ++k) {
    const int step = static_cast<int>(std::lround(moments[k]));
    const std::string turns = clip.turns(moments[k]);
    panels.push_back({std::move(scenes[k]),
                      fmt::format("step {}{}{}", step, turns.empty() ? "" : ", ", turns),
                      return_of(clip, moments[k])});
  }
  const Caption who = clip.caption(0);
  return panel_sheet(panels, moment_columns(panels.size()),
                     {who.title, who.detail, Kinds(clip.mesh())}, theme, width, typesetter);
}

Drawing robot_sheet(const std::vector<Clip>& clips, double step, const Theme& theme, int width,
                    Typesetter& typesetter) {
  std::vector<Panel> panels;
  std::set<std::string> tasks;
  for (const Clip& clip : clips) tasks.insert(clip.caption(0).title);
  const bool one_task = tasks.size() == 1;
  Frame frame{one_task ? *tasks.begin() : fmt::format("{} tasks", tasks.size()),
              fmt::format("step {}", step),
              {}};
  for (const Clip& clip : clips) {
    const Caption who = clip.caption(0);
    const double shown = std::min(step, static_cast<double>(clip.steps()));
    const std::string end = shown < step ? fmt::format(" at step {}", shown) : "";
    panels.push_back({clip.scene(shown), one_task ? who.detail : who.title,
                      (one_task ? "" : who.detail + "  ") + return_of(clip, shown) + end});
    frame.kinds.add(clip.mesh());
  }
  return panel_sheet(panels, robot_columns(panels.size()), frame, theme, width, typesetter);
}

}  // namespace evo::render
