#include "render/render.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libevo/base/error.h"
#include "render/figures/key.h"
#include "render/figures/label.h"
#include "render/figures/legend.h"
#include "render/figures/plot.h"
#include "render/figures/strip.h"
#include "render/film/loop.h"
#include "render/film/movie.h"
#include "render/film/race.h"
#include "render/film/workers.h"
#include "render/painters/painter.h"
#include "render/painters/vector.h"

namespace evo::render {
namespace {

namespace fs = std::filesystem;

double aspect_of(const Rect& panel) {
  return static_cast<double>(panel.width) / static_cast<double>(panel.height);
}

// ---- several episodes in one picture ------------------------------------------------------

// Panels for `n` clips: the division of the picture whose panels come nearest to
// a pleasant shape.
std::vector<Rect> panels(std::size_t n, Size size) {
  constexpr double pleasant = 16.0 / 9.0;
  const auto whole_width = static_cast<float>(size.width);
  const auto whole_height = static_cast<float>(size.height);
  std::size_t best = 1;
  double least = 1e30;
  for (std::size_t columns = 1; columns <= n; ++columns) {
    const std::size_t rows = (n + columns - 1) / columns;
    const double aspect = (static_cast<double>(size.width) / static_cast<double>(columns)) /
                          (static_cast<double>(size.height) / static_cast<double>(rows));
    const double empty = static_cast<double>(columns * rows - n) / static_cast<double>(n);
    const double badness = std::abs(std::log(aspect / pleasant)) + empty;
    if (badness < least) {
      least = badness;
      best = columns;
    }
  }
  const std::size_t rows = (n + best - 1) / best;
  const float gap = n > 1 ? std::max(1.0F, std::round(0.004F * whole_height)) : 0;
  const auto across = static_cast<float>(best);
  const auto down = static_cast<float>(rows);
  const float width = (whole_width - (across - 1) * gap) / across;
  const float height = (whole_height - (down - 1) * gap) / down;
  std::vector<Rect> result;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t column = k % best;
    const std::size_t row = k / best;
    const float x = std::round(static_cast<float>(column) * (width + gap));
    const float y = std::round(static_cast<float>(row) * (height + gap));
    result.push_back({x, y, std::round(width), std::round(height)});
  }
  return result;
}

// Episodes, where they are shown, and when.
struct Film {
  std::vector<Clip> clips;
  std::vector<Rect> areas;    // of the scenes
  std::vector<Rect> plots;    // empty: none
  std::vector<double> steps;  // of each frame
  const RenderOptions* options = nullptr;
  const Theme* theme = nullptr;

  Film(const std::vector<Episode>& episodes, const RenderOptions& chosen)
      : options(&chosen), theme(&theme_by_name(chosen.theme)) {
    if (episodes.empty()) throw Error(Failure::data, "there is no episode to draw");
    areas = panels(episodes.size(), chosen.size);
    if (chosen.overlays.plot != Plot::none)
      for (Rect& area : areas) {
        plots.push_back(plot_area(area));
        area.height -= plots.back().height;
      }
    int longest = 0;
    for (std::size_t k = 0; k < episodes.size(); ++k) {
      clips.emplace_back(episodes[k], chosen, aspect_of(areas[k]));
      longest = std::max(longest, clips.back().steps());
    }
    share_value_scale(clips);
    steps = timeline(chosen, longest, clips.front().steps_per_second());
  }

  Drawing frame(double step, Typesetter& typesetter) const {
    Drawing drawing(options->size);
    if (clips.size() > 1) drawing.rectangle(drawing.whole(), theme->paper);
    for (std::size_t k = 0; k < clips.size(); ++k) {
      Scene scene = clips[k].scene(step);
      if (options->overlays.labels) scene.captions = caption_height(areas[k], scene.goal ? 2 : 1);
      draw_scene(scene, *theme, areas[k], drawing);
      if (options->overlays.labels) {
        draw_caption(clips[k].caption(step), *theme, areas[k], typesetter, drawing);
        draw_key(scene, *theme, areas[k], 2, typesetter, drawing);
      }
      if (!plots.empty())
        draw_plot(clips[k], options->overlays.plot, step, *theme, plots[k], drawing);
    }
    return drawing;
  }

  // Videos that come to the end of an episode stay there for a while, so that one can
  // read why it ended.
  void hold() {
    constexpr double seconds = 0.5;
    const bool ends = std::ranges::any_of(
        clips, [&](const Clip& clip) { return clip.over() && steps.back() >= clip.steps(); });
    if (!ends || steps.size() < 2) return;
    const auto more = static_cast<std::size_t>(std::lround(seconds * options->fps));
    steps.insert(steps.end(), more, steps.back());
  }
};

// ---- stills -----------------------------------------------------------------------------------

// The film of one episode that shows `step`, whatever range was asked for.
Film film_at(const Episode& episode, double step, const RenderOptions& options) {
  check_options(options);
  Film film({episode}, options);
  if (!(step >= 0 && step <= film.clips.front().steps()))
    throw error(Failure::usage, "there is no step {}: the episode has steps 0 to {}", step,
                film.clips.front().steps());
  return film;
}

constexpr std::size_t most_panels = 100;
constexpr double panel_zoom = 2.5;  // small panels have no room to spare

RenderOptions without_range(RenderOptions options) {
  options.from = 0;
  options.to.reset();
  return options;
}

}  // namespace

Drawing draw_moment(const Episode& episode, double step, const RenderOptions& options) {
  const RenderOptions whole = without_range(options);
  const Film film = film_at(episode, step, whole);
  Typesetter typesetter;
  Drawing drawing = film.frame(step, typesetter);
  if (!options.overlays.labels) return drawing;
  const Rect& area = film.areas.front();
  const float size = 0.75F * label_size(area);
  drawing.clip(area);
  const Clip& clip = film.clips.front();
  draw_legend(
      Kinds(clip.mesh(), clip.values(step)), 0, *film.theme,
      {area.x + size, area.y + area.height - 2.4F * size, area.width - 2 * size, 2.4F * size}, size,
      typesetter, drawing, true);
  return drawing;
}

Drawing draw_moment(const std::vector<Episode>& episodes, double step,
                    const RenderOptions& options) {
  if (episodes.size() == 1) return draw_moment(episodes.front(), step, options);
  check_options(options);
  if (episodes.empty() || episodes.size() > most_panels)
    throw error(Failure::usage, "{} episodes cannot be drawn side by side: allowed are 1 to {}",
                episodes.size(), most_panels);
  RenderOptions closer = without_range(options);
  closer.camera.zoom *= panel_zoom;
  std::vector<Clip> clips;
  int longest = 0;
  for (const Episode& episode : episodes) {
    clips.emplace_back(episode, closer, moment_aspect(episodes.size()));
    longest = std::max(longest, clips.back().steps());
  }
  share_value_scale(clips);
  if (!(step >= 0 && step <= longest))
    throw error(Failure::usage, "there is no step {}: the longest episode has steps 0 to {}", step,
                longest);
  Typesetter typesetter;
  return robot_sheet(clips, step, theme_by_name(options.theme), options.size.width, typesetter);
}

Drawing draw_moments(const Episode& episode, const Moments& moments, const RenderOptions& options) {
  check_options(options);
  if (moments.count < 1 || moments.count > static_cast<int>(most_panels))
    throw error(Failure::usage, "{} moments of an episode cannot be drawn: allowed are 1 to {}",
                moments.count, most_panels);
  const auto n = static_cast<std::size_t>(moments.count);
  RenderOptions closer = options;
  closer.camera.zoom *= panel_zoom;
  const Clip clip(episode, closer, moment_aspect(n));
  const std::vector<double> range = timeline(options, clip.steps(), clip.steps_per_second());
  const auto from = static_cast<int>(range.front());
  const auto to = static_cast<int>(range.back());
  const std::vector<int> steps = choose_moments(clip, from, to, moments.count, moments.choice);
  const Theme& theme = theme_by_name(options.theme);
  const bool as_strip = moments.layout == Layout::strip && suits_strip(clip, steps);
  Typesetter typesetter;
  return as_strip ? strip(clip, steps, theme, options.size, typesetter)
                  : moment_sheet(clip, {steps.begin(), steps.end()}, theme, options.size.width,
                                 typesetter);
}

std::string draw_gait(const Episode& episode, const RenderOptions& options) {
  check_options(options);
  const Clip clip(episode, options, 1.0);
  const std::vector<double> range = timeline(options, clip.steps(), clip.steps_per_second());
  const Caption who = clip.caption(0);
  return gait_loop(clip, static_cast<int>(range.front()), static_cast<int>(range.back()),
                   options.size, who.title + ", robot " + who.detail);
}

Drawing draw_robot(const Robot& robot, const RenderOptions& options) {
  check_options(options);
  Typesetter typesetter;
  return robot_picture(robot, theme_by_name(options.theme), options.size, typesetter);
}

Drawing draw_robots(const std::vector<Robot>& robots, const RenderOptions& options) {
  check_options(options);
  Typesetter typesetter;
  return robot_grid(robots, theme_by_name(options.theme), options.size.width, typesetter);
}

Drawing draw_poster(const PosterContent& content, const Episode& best,
                    const RenderOptions& options) {
  RenderOptions inside = options;
  inside.size = {poster_width(), poster_width() * 3 / 5};
  const Drawing moments = draw_moments(best, {}, inside);
  Typesetter typesetter;
  return poster(content, moments, theme_by_name(options.theme), typesetter);
}

Image paint(const Drawing& drawing) {
  Image image(drawing.size());
  run_workers({1, image.rgba.size(), 1,
               [&](Painter& painter, std::size_t, std::span<std::uint8_t> rgba) {
                 painter.paint(drawing, {image.size, rgba});
               },
               [&](std::size_t, std::span<const std::uint8_t> rgba) {
                 std::copy(rgba.begin(), rgba.end(), image.rgba.begin());
               }});
  return image;
}

std::string encode_picture(const Drawing& drawing, const std::string& title,
                           const std::string& name) {
  const std::string extension = fs::path(name).extension().string();
  if (extension == ".png") return encode_png(paint(drawing));
  Typesetter typesetter;
  if (extension == ".svg") return encode_svg(drawing, title, typesetter);
  if (extension == ".pdf") return encode_pdf(drawing, title, typesetter);
  throw error(Failure::usage, "{}: a still picture ends in .png, .svg or .pdf", name);
}

// ---- moving pictures --------------------------------------------------------------------------

std::size_t render_video(const std::vector<Episode>& episodes, const RenderOptions& options,
                         const std::string& output, const Progress& progress) {
  check_options(options);
  check_movie(options.size, output);
  Film film(episodes, options);
  if (!is_sequence(output)) film.hold();
  return write_movie(
      {options.size, options.fps, options.workers, film.steps.size(),
       [&](std::size_t k, Typesetter& typesetter) { return film.frame(film.steps[k], typesetter); },
       progress},
      output);
}

std::size_t render_race(const std::vector<Episode>& episodes, const RenderOptions& options,
                        const std::string& output, const Progress& progress) {
  check_options(options);
  check_movie(options.size, output);
  const Race race(episodes, options);
  const std::vector<double> steps = timeline(options, race.steps(), race.steps_per_second());
  return write_movie(
      {options.size, options.fps, options.workers, steps.size(),
       [&](std::size_t k, Typesetter& typesetter) { return race.frame(steps[k], typesetter); },
       progress},
      output);
}

std::size_t render_evolution(const std::vector<Champion>& champions, const RenderOptions& options,
                             const std::string& output, const Progress& progress) {
  check_options(options);
  check_movie(options.size, output);
  const EvolutionFilm film(champions, options);
  return write_movie(
      {options.size, options.fps, options.workers, film.frames(),
       [&](std::size_t k, Typesetter& typesetter) { return film.frame(k, typesetter); }, progress},
      output);
}

}  // namespace evo::render
