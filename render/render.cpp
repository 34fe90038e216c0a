#include "render/render.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "formats/files.h"
#include "libevo/base/error.h"
#include "render/gif.h"
#include "render/label.h"
#include "render/painter.h"
#include "render/strip.h"
#include "render/vector.h"
#include "render/video.h"
#include "render/workers.h"

namespace evo::render {
namespace {

namespace fs = std::filesystem;

std::size_t rgba_bytes(Size size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height) * 4;
}

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
  std::vector<Rect> areas;
  std::vector<double> steps;  // of each frame
  const RenderOptions* options = nullptr;
  const Theme* theme = nullptr;
  Progress progress;

  Film(const std::vector<Episode>& episodes, const RenderOptions& chosen)
      : options(&chosen), theme(&theme_by_name(chosen.theme)) {
    if (episodes.empty()) throw Error(Failure::data, "there is no episode to draw");
    areas = panels(episodes.size(), chosen.size);
    int longest = 0;
    for (std::size_t k = 0; k < episodes.size(); ++k) {
      clips.emplace_back(episodes[k], chosen, aspect_of(areas[k]));
      longest = std::max(longest, clips.back().steps());
    }
    steps = timeline(chosen, longest);
  }

  Drawing frame(double step, Typesetter& typesetter) const {
    Drawing drawing(options->size);
    if (clips.size() > 1) drawing.rectangle(drawing.whole(), theme->paper);
    for (std::size_t k = 0; k < clips.size(); ++k) {
      draw_scene(clips[k].scene(step), *theme, areas[k], drawing);
      if (options->overlays.labels)
        draw_caption(clips[k].caption(step), *theme, areas[k], typesetter, drawing);
    }
    return drawing;
  }

  void finished(std::size_t k) const {
    if (progress) progress(k + 1, steps.size());
  }

  // Pixels of frame k.
  void paint(Painter& painter, std::size_t k, std::span<std::uint8_t> rgba) const {
    painter.paint(frame(steps[k], painter.typesetter()), {options->size, rgba});
  }
};

using TakePixels = std::function<bool(std::size_t frame, PixelView pixels)>;

void each_frame(const Film& film, const TakePixels& take) {
  const Size size = film.options->size;
  run_workers({film.steps.size(), rgba_bytes(size), film.options->workers,
               [&](Painter& painter, std::size_t k, std::span<std::uint8_t> buffer) {
                 film.paint(painter, k, buffer.first(rgba_bytes(size)));
                 return rgba_bytes(size);
               },
               [&](std::size_t k, std::span<const std::uint8_t> bytes) {
                 film.finished(k);
                 return take(k, {size, bytes});
               }});
}

// As each_frame, in planes for video; the conversion is the workers' work.
void each_yuv_frame(const Film& film,
                    const std::function<bool(std::span<const std::uint8_t>)>& take) {
  const Size size = film.options->size;
  run_workers({film.steps.size(), yuv_bytes(size), film.options->workers,
               [&film, size, image = Image(size)](Painter& painter, std::size_t k,
                                                  std::span<std::uint8_t> buffer) mutable {
                 film.paint(painter, k, image.rgba);
                 to_yuv(view(image), buffer);
                 return yuv_bytes(size);
               },
               [&](std::size_t k, std::span<const std::uint8_t> bytes) {
                 film.finished(k);
                 return take(bytes);
               }});
}

// ---- forms of output -------------------------------------------------------------------------

void write_ffmpeg(const Film& film, const fs::path& path) {
  FfmpegEncoder encoder(path, film.options->size, film.options->fps);
  each_yuv_frame(film, [&](std::span<const std::uint8_t> planes) {
    encoder.add(planes);
    return true;
  });
  encoder.finish();
}

void write_y4m(const Film& film) {
  const std::string label = "standard output";
  if (!write_quietly(STDOUT_FILENO, y4m_header(film.options->size, film.options->fps), label))
    return;
  each_yuv_frame(film, [&](std::span<const std::uint8_t> planes) {
    const std::string_view bytes(reinterpret_cast<const char*>(planes.data()),  // NOLINT: bytes
                                 planes.size());
    return write_quietly(STDOUT_FILENO, y4m_frame_line, label) &&
           write_quietly(STDOUT_FILENO, bytes, label);
  });
}

// Frames whose colours make the palette, from the whole film.
Histogram sample_colors(const Film& film) {
  constexpr std::size_t most = 12;
  const std::size_t n = std::min(most, film.steps.size());
  Histogram histogram;
  run_workers({n, rgba_bytes(film.options->size), film.options->workers,
               [&](Painter& painter, std::size_t k, std::span<std::uint8_t> buffer) {
                 const std::size_t bytes = rgba_bytes(film.options->size);
                 film.paint(painter, k * (film.steps.size() - 1) / std::max<std::size_t>(1, n - 1),
                            buffer.first(bytes));
                 return bytes;
               },
               [&](std::size_t, std::span<const std::uint8_t> bytes) {
                 histogram.add(bytes);
                 return true;
               }});
  return histogram;
}

void write_gif(const Film& film, const fs::path& path) {
  AtomicFile file(path);
  GifEncoder encoder(film.options->size, make_palette(sample_colors(film), gif_colors));
  constexpr double ticks = 100;  // a second
  const auto moment = [&](std::size_t k) {
    return static_cast<int>(std::lround(static_cast<double>(k) * ticks / film.options->fps));
  };
  each_frame(film, [&](std::size_t k, PixelView pixels) {
    encoder.add(pixels, moment(k + 1) - moment(k));
    return true;
  });
  file.write(encoder.finish());
  file.commit();
}

void write_png_or_apng(const Film& film, const fs::path& path) {
  if (film.steps.size() == 1) {
    each_frame(film, [&](std::size_t, PixelView pixels) {
      write_png(path, pixels);
      return true;
    });
    return;
  }
  AtomicFile file(path);
  constexpr int ticks = 10000;  // a second
  ApngEncoder encoder(film.options->size, film.steps.size(), ticks);
  const int delay = static_cast<int>(std::lround(ticks / film.options->fps));
  each_frame(film, [&](std::size_t, PixelView pixels) {
    encoder.add(pixels, delay);
    return true;
  });
  file.write(encoder.finish());
  file.commit();
}

// "frames/%05d.png": what stands before the number, its width, what comes after.
struct Pattern {
  std::string before, after;
  std::size_t digits = 1;
  std::string name(std::size_t k) const {
    const std::string number = std::to_string(k);
    return before + std::string(digits - std::min(digits, number.size()), '0') + number + after;
  }
};

std::optional<Pattern> pattern_of(const std::string& output) {
  constexpr std::size_t most_digits = 20;
  const std::size_t percent = output.find('%');
  const std::size_t letter = output.find_first_not_of("0123456789", percent + 1);
  if (percent == std::string::npos || letter == std::string::npos || output[letter] != 'd' ||
      output.find('%', letter) != std::string::npos)
    return std::nullopt;
  const std::string width = output.substr(percent + 1, letter - percent - 1);
  const bool padded = width.size() >= 2 && width.size() <= 3 && width.front() == '0';
  if (!width.empty() && !padded) return std::nullopt;
  const std::size_t digits = padded ? std::stoul(width) : 1;
  if (digits > most_digits) return std::nullopt;
  return Pattern{output.substr(0, percent), output.substr(letter + 1), digits};
}

// Workers write the files of their frames themselves.
void write_sequence(const Film& film, const Pattern& pattern) {
  const fs::path folder = fs::path(pattern.name(0)).parent_path();
  std::error_code failed;
  if (!folder.empty()) fs::create_directories(folder, failed);
  if (failed)
    throw error(Failure::cannot_create, "{}: cannot be created: {}", folder.string(),
                failed.message());
  run_workers({film.steps.size(), 0, film.options->workers,
               [&film, &pattern, image = Image(film.options->size)](
                   Painter& painter, std::size_t k, std::span<std::uint8_t>) mutable {
                 constexpr int quick = 2;
                 film.paint(painter, k, image.rgba);
                 write_png(pattern.name(k), view(image), quick);
                 return std::size_t{0};
               },
               [&film](std::size_t k, std::span<const std::uint8_t>) {
                 film.finished(k);
                 return true;
               }});
}

void check_video_size(Size size, const std::string& output) {
  if (size.width % 2 == 0 && size.height % 2 == 0) return;
  throw error(Failure::usage, "{}: videos need even sides, {}x{} has an odd one: use {}x{}", output,
              size.width, size.height, size.width + size.width % 2, size.height + size.height % 2);
}

enum class Form { y4m, sequence, ffmpeg, gif, png };

Form form_of(const std::string& output) {
  if (output == standard_stream) return Form::y4m;
  const std::string extension = fs::path(output).extension().string();
  if (output.find('%') != std::string::npos) {
    if (extension == ".png" && pattern_of(output)) return Form::sequence;
    throw error(Failure::usage, "{}: a sequence of pictures is named like frames/%05d.png", output);
  }
  if (extension == ".mp4" || extension == ".webm") return Form::ffmpeg;
  if (extension == ".gif") return Form::gif;
  if (extension == ".png" || extension == ".apng") return Form::png;
  throw error(Failure::usage,
              "{}: unknown kind of picture '{}'; allowed are .mp4, .webm, .gif, .png, .apng, a "
              "sequence like frames/%05d.png, and - for Y4M",
              output, extension);
}

}  // namespace

// ---- stills -----------------------------------------------------------------------------------

namespace {

// The film of one episode that shows `step`, whatever range was asked for.
Film film_at(const Episode& episode, double step, const RenderOptions& options) {
  check_options(options);
  Film film({episode}, options);
  if (!(step >= 0 && step <= film.clips.front().steps()))
    throw error(Failure::usage, "there is no step {}: the episode has steps 0 to {}", step,
                film.clips.front().steps());
  return film;
}

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
  return film.frame(step, typesetter);
}

Viewer::Viewer() : painter_(std::make_unique<Painter>()) {}
Viewer::~Viewer() = default;

Image Viewer::draw(const Episode& episode, double step, const RenderOptions& options) {
  const RenderOptions whole = without_range(options);
  const Film film = film_at(episode, step, whole);
  Image image(options.size);
  painter_->paint(film.frame(step, painter_->typesetter()), target(image));
  return image;
}

Drawing draw_moments(const Episode& episode, const Moments& moments, const RenderOptions& options) {
  check_options(options);
  constexpr int most = 100;
  constexpr double moment_zoom = 2.5;
  if (moments.count < 1 || moments.count > most)
    throw error(Failure::usage, "{} moments of an episode cannot be drawn: allowed are 1 to {}",
                moments.count, most);
  const auto n = static_cast<std::size_t>(moments.count);
  RenderOptions closer = options;  // small panels have no room to spare
  closer.camera.zoom *= moment_zoom;
  const Clip clip(episode, closer, moment_aspect(n));
  const std::vector<double> range = timeline(options, clip.steps());
  const auto from = static_cast<int>(range.front());
  const auto to = static_cast<int>(range.back());
  const std::vector<int> steps = choose_moments(clip, from, to, moments.count, moments.choice);
  const Theme& theme = theme_by_name(options.theme);
  const bool as_strip = moments.layout == Layout::strip ||
                        (moments.layout == Layout::automatic && n > 1 && travels(clip, from, to));
  Typesetter typesetter;
  return as_strip ? strip(clip, steps, theme, options.size, typesetter)
                  : moment_sheet(clip, {steps.begin(), steps.end()}, theme, options.size.width,
                                 typesetter);
}

Drawing draw_world(const Model& model, const std::string& title, const RenderOptions& options) {
  Rollout rollout;
  rollout.task = title;
  rollout.points = model.points();
  rollout.world = {model.objects(), model.cells()};
  rollout.episodes.emplace_back().positions = model.initial_positions();
  return draw_moment({&rollout, 0, ""}, 0, options);
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

Drawing draw_generations(const std::vector<Generation>& generations, int rows,
                         const RenderOptions& options) {
  check_options(options);
  constexpr int most_rows = 50;
  if (rows < 1 || rows > most_rows)
    throw error(Failure::usage, "{} robots of a generation: allowed are 1 to {}", rows, most_rows);
  Typesetter typesetter;
  return generation_sheet(generations, rows, theme_by_name(options.theme), options.size.width,
                          typesetter);
}

Image paint(const Drawing& drawing) {
  Image image(drawing.size());
  run_workers({1, image.rgba.size(), 1,
               [&](Painter& painter, std::size_t, std::span<std::uint8_t> buffer) {
                 painter.paint(drawing, {image.size, buffer.first(image.rgba.size())});
                 return image.rgba.size();
               },
               [&](std::size_t, std::span<const std::uint8_t> bytes) {
                 std::copy(bytes.begin(), bytes.end(), image.rgba.begin());
                 return true;
               }});
  return image;
}

std::string encode_picture(const Drawing& drawing, const std::string& title,
                           const std::string& name) {
  const std::string extension = fs::path(name).extension().string();
  if (extension == ".png") return encode_png(view(paint(drawing)));
  Typesetter typesetter;
  if (extension == ".svg") return encode_svg(drawing, title, typesetter);
  if (extension == ".pdf") return encode_pdf(drawing, title, typesetter);
  throw error(Failure::usage, "{}: a still picture ends in .png, .svg or .pdf", name);
}

// ---- moving pictures --------------------------------------------------------------------------

VideoReport render_video(const std::vector<Episode>& episodes, const RenderOptions& options,
                         const std::string& output, const Progress& progress) {
  check_options(options);
  const Form form = form_of(output);
  if (form == Form::ffmpeg || form == Form::y4m) check_video_size(options.size, output);
  Film film(episodes, options);
  film.progress = progress;
  switch (form) {
    case Form::ffmpeg:
      write_ffmpeg(film, output);
      break;
    case Form::y4m:
      write_y4m(film);
      break;
    case Form::gif:
      write_gif(film, output);
      break;
    case Form::sequence:
      write_sequence(film, *pattern_of(output));
      break;
    case Form::png:
      write_png_or_apng(film, output);
      break;
  }
  return {film.steps.size(), static_cast<double>(film.steps.size()) / options.fps};
}

}  // namespace evo::render
