#include "render/film/movie.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "formats/io/files.h"
#include "libevo/base/error.h"
#include "render/film/gif.h"
#include "render/film/video.h"
#include "render/film/workers.h"
#include "render/painters/painter.h"
#include "render/painters/png.h"

namespace evo::render {
namespace {

namespace fs = std::filesystem;

std::size_t rgba_bytes(Size size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height) * 4;
}

void finished(const Movie& movie, std::size_t k) {
  if (movie.progress) movie.progress(k + 1, movie.frames);
}

// Pixels of frame k.
void paint_frame(const Movie& movie, Painter& painter, std::size_t k,
                 std::span<std::uint8_t> rgba) {
  painter.paint(movie.draw(k, painter.typesetter()), {movie.size, rgba});
}

using TakePixels = std::function<bool(std::size_t frame, PixelView pixels)>;

void each_frame(const Movie& movie, const TakePixels& take) {
  const Size size = movie.size;
  run_workers({movie.frames, rgba_bytes(size), movie.workers,
               [&](Painter& painter, std::size_t k, std::span<std::uint8_t> buffer) {
                 paint_frame(movie, painter, k, buffer.first(rgba_bytes(size)));
                 return rgba_bytes(size);
               },
               [&](std::size_t k, std::span<const std::uint8_t> bytes) {
                 finished(movie, k);
                 return take(k, {size, bytes});
               }});
}

// As each_frame, in planes for video; the conversion is the workers' work.
void each_yuv_frame(const Movie& movie,
                    const std::function<bool(std::span<const std::uint8_t>)>& take) {
  const Size size = movie.size;
  run_workers({movie.frames, yuv_bytes(size), movie.workers,
               [&movie, size, image = Image(size)](Painter& painter, std::size_t k,
                                                   std::span<std::uint8_t> buffer) mutable {
                 paint_frame(movie, painter, k, image.rgba);
                 to_yuv(view(image), buffer);
                 return yuv_bytes(size);
               },
               [&](std::size_t k, std::span<const std::uint8_t> bytes) {
                 finished(movie, k);
                 return take(bytes);
               }});
}

// ---- forms of output -------------------------------------------------------------------------

void write_ffmpeg(const Movie& movie, const fs::path& path) {
  FfmpegEncoder encoder(path, movie.size, movie.fps);
  each_yuv_frame(movie, [&](std::span<const std::uint8_t> planes) {
    encoder.add(planes);
    return true;
  });
  encoder.finish();
}

void write_y4m(const Movie& movie) {
  const std::string label = "standard output";
  if (!write_quietly(STDOUT_FILENO, y4m_header(movie.size, movie.fps), label)) return;
  each_yuv_frame(movie, [&](std::span<const std::uint8_t> planes) {
    const std::string_view bytes(reinterpret_cast<const char*>(planes.data()),  // NOLINT: bytes
                                 planes.size());
    return write_quietly(STDOUT_FILENO, y4m_frame_line, label) &&
           write_quietly(STDOUT_FILENO, bytes, label);
  });
}

// Frames whose colours make the palette, from the whole movie.
Histogram sample_colors(const Movie& movie) {
  constexpr std::size_t most = 12;
  const std::size_t n = std::min(most, movie.frames);
  Histogram histogram;
  run_workers({n, rgba_bytes(movie.size), movie.workers,
               [&](Painter& painter, std::size_t k, std::span<std::uint8_t> buffer) {
                 const std::size_t bytes = rgba_bytes(movie.size);
                 paint_frame(movie, painter,
                             k * (movie.frames - 1) / std::max<std::size_t>(1, n - 1),
                             buffer.first(bytes));
                 return bytes;
               },
               [&](std::size_t, std::span<const std::uint8_t> bytes) {
                 histogram.add(bytes);
                 return true;
               }});
  return histogram;
}

void write_gif(const Movie& movie, const fs::path& path) {
  AtomicFile file(path);
  GifEncoder encoder(movie.size, make_palette(sample_colors(movie), gif_colors));
  constexpr double ticks = 100;  // a second
  const auto moment = [&](std::size_t k) {
    return static_cast<int>(std::lround(static_cast<double>(k) * ticks / movie.fps));
  };
  each_frame(movie, [&](std::size_t k, PixelView pixels) {
    encoder.add(pixels, moment(k + 1) - moment(k));
    return true;
  });
  file.write(encoder.finish());
  file.commit();
}

void write_png_or_apng(const Movie& movie, const fs::path& path) {
  if (movie.frames == 1) {
    each_frame(movie, [&](std::size_t, PixelView pixels) {
      write_png(path, pixels);
      return true;
    });
    return;
  }
  AtomicFile file(path);
  constexpr int ticks = 10000;  // a second
  ApngEncoder encoder(movie.size, movie.frames, ticks);
  const int delay = static_cast<int>(std::lround(ticks / movie.fps));
  each_frame(movie, [&](std::size_t, PixelView pixels) {
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
void write_sequence(const Movie& movie, const Pattern& pattern) {
  const fs::path folder = fs::path(pattern.name(0)).parent_path();
  std::error_code failed;
  if (!folder.empty()) fs::create_directories(folder, failed);
  if (failed)
    throw error(Failure::cannot_create, "{}: cannot be created: {}", folder.string(),
                failed.message());
  run_workers({movie.frames, 0, movie.workers,
               [&movie, &pattern, image = Image(movie.size)](Painter& painter, std::size_t k,
                                                             std::span<std::uint8_t>) mutable {
                 constexpr int quick = 2;
                 paint_frame(movie, painter, k, image.rgba);
                 write_png(pattern.name(k), view(image), quick);
                 return std::size_t{0};
               },
               [&movie](std::size_t k, std::span<const std::uint8_t>) {
                 finished(movie, k);
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

bool is_sequence(const std::string& output) { return form_of(output) == Form::sequence; }

void check_movie(Size size, const std::string& output) {
  const Form form = form_of(output);
  if (form == Form::ffmpeg || form == Form::y4m) check_video_size(size, output);
}

VideoReport write_movie(const Movie& movie, const std::string& output) {
  check_movie(movie.size, output);
  switch (form_of(output)) {
    case Form::ffmpeg:
      write_ffmpeg(movie, output);
      break;
    case Form::y4m:
      write_y4m(movie);
      break;
    case Form::gif:
      write_gif(movie, output);
      break;
    case Form::sequence:
      write_sequence(movie, *pattern_of(output));
      break;
    case Form::png:
      write_png_or_apng(movie, output);
      break;
  }
  return {movie.frames, static_cast<double>(movie.frames) / movie.fps};
}

}  // namespace evo::render
