// Video: MP4, WebM and GIF through the program `ffmpeg`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "formats/io/files.h"
#include "render/painters/image.h"

namespace evo::render {

// A video file: frames go in as pixels, `ffmpeg` writes the file, which appears
// under its name when all is done.
class FfmpegEncoder {
 public:
  // By the extension: .mp4 (H.264), .webm (VP9) or .gif. Throws Error(work) naming the
  // package when there is no ffmpeg, Error(cannot_create).
  FfmpegEncoder(const std::filesystem::path& path, Size size, double fps);
  ~FfmpegEncoder();
  FfmpegEncoder(const FfmpegEncoder&) = delete;
  FfmpegEncoder& operator=(const FfmpegEncoder&) = delete;

  // Throws Error(work) with ffmpeg's last words when it has stopped reading.
  void add(std::span<const std::uint8_t> rgba);
  void finish();

 private:
  struct Process;
  std::filesystem::path path_;
  AtomicFile file_;
  std::unique_ptr<Process> process_;
};

}  // namespace evo::render
