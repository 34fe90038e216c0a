// Video: raw Y4M, and MP4 or WebM through the `ffmpeg` program.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "formats/io/files.h"
#include "render/painters/image.h"

namespace evo::render {

// Bytes of a frame as three planes, chroma halved both ways (4:2:0).
std::size_t yuv_bytes(Size size);
// BT.709, limited range, chroma sited in the middle. `out` has yuv_bytes().
void to_yuv(const PixelView& image, std::span<std::uint8_t> out);

// The line a Y4M stream begins with; each frame then is y4m_frame_line and planes.
std::string y4m_header(Size size, double fps);
inline constexpr std::string_view y4m_frame_line = "FRAME\n";

// Writes all of it. False when the reader has closed the pipe, which raises no
// signal here. Throws Error(io) naming `label`.
bool write_quietly(int descriptor, std::string_view bytes, const std::string& label);

// A video file: frames go in as planes, `ffmpeg` writes the file, which appears
// under its name when all is done.
class FfmpegEncoder {
 public:
  // By the extension: .mp4 (H.264) or .webm (VP9). Throws Error(work) naming the
  // package when there is no ffmpeg, Error(cannot_create).
  FfmpegEncoder(const std::filesystem::path& path, Size size, double fps);
  ~FfmpegEncoder();
  FfmpegEncoder(const FfmpegEncoder&) = delete;
  FfmpegEncoder& operator=(const FfmpegEncoder&) = delete;

  // Throws Error(work) with ffmpeg's last words when it has stopped reading.
  void add(std::span<const std::uint8_t> planes);
  void finish();

 private:
  struct Process;
  std::filesystem::path path_;
  AtomicFile file_;
  std::unique_ptr<Process> process_;
};

}  // namespace evo::render
