#include "render/film/movie.h"

#include <filesystem>

#include "formats/io/files.h"
#include "libevo/base/error.h"
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

// Through ffmpeg.
void write_video(const Movie& movie, const std::string& output) {
  FfmpegEncoder encoder(output, movie.size, movie.fps);
  run_workers({movie.frames, rgba_bytes(movie.size), movie.workers,
               [&](Painter& painter, std::size_t k, std::span<std::uint8_t> rgba) {
                 paint_frame(movie, painter, k, rgba);
               },
               [&](std::size_t k, std::span<const std::uint8_t> rgba) {
                 finished(movie, k);
                 encoder.add(rgba);
               }});
  encoder.finish();
}

// "frames/%05d.png": what stands before the number, its width, what comes after.
struct Pattern {
  std::string before, after;
  std::size_t digits = 1;
  std::string name(std::size_t k) const {
    return fmt::format("{}{:0{}}{}", before, k, digits, after);
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
                 paint_frame(movie, painter, k, image.rgba);
                 write_file(pattern.name(k), encode_png(image, Effort::quick));
               },
               [&movie](std::size_t k, std::span<const std::uint8_t>) { finished(movie, k); }});
}

void check_video_size(Size size, const std::string& output) {
  if (size.width % 2 == 0 && size.height % 2 == 0) return;
  throw error(Failure::usage, "{}: videos need even sides, {}x{} has an odd one: use {}x{}", output,
              size.width, size.height, size.width + size.width % 2, size.height + size.height % 2);
}

}  // namespace

bool is_sequence(const std::string& output) {
  const std::string extension = fs::path(output).extension().string();
  if (output.find('%') != std::string::npos) {
    if (extension == ".png" && pattern_of(output)) return true;
    throw error(Failure::usage, "{}: a sequence of pictures is named like frames/%05d.png", output);
  }
  if (extension == ".mp4" || extension == ".webm" || extension == ".gif") return false;
  throw error(Failure::usage,
              "{}: unknown kind of film '{}'; allowed are .mp4, .webm, .gif and a sequence like "
              "frames/%05d.png",
              output, extension);
}

void check_movie(Size size, const std::string& output) {
  if (!is_sequence(output) && !output.ends_with(".gif")) check_video_size(size, output);
}

std::size_t write_movie(const Movie& movie, const std::string& output) {
  if (const auto pattern = pattern_of(output))
    write_sequence(movie, *pattern);
  else
    write_video(movie, output);
  return movie.frames;
}

}  // namespace evo::render
