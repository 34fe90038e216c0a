#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "libevo/base/random.h"
#include "render/film/video.h"
#include "render/painters/png.h"
#include "tests/unit/expect.h"
#include "tests/unit/render/read_png.h"

namespace evo::render {
namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using test::expect_error;

// ---- PNG ------------------------------------------------------------------------

TEST_CASE("a PNG comes back as it was written") {
  const test::ScratchFolder folder;
  Image image(Size{37, 11});
  Stream stream(1, "test/png");
  for (std::size_t k = 0; k < image.rgba.size(); ++k)
    image.rgba[k] = k % 4 == 3 ? 255 : static_cast<std::uint8_t>(stream.below(256));
  const Effort effort = GENERATE(Effort::small, Effort::quick);
  write_file(folder / "a.png", encode_png(image, effort));
  const Image back = read_png(folder / "a.png");
  CHECK(back.size == image.size);
  CHECK(back.rgba == image.rgba);
  CHECK(folder.entries() == 1);
  CHECK(encode_png(image, effort) == encode_png(image, effort));
}

// ---- ffmpeg -------------------------------------------------------------------------------------

// PATH with one folder in it.
struct OnlyPath {
  std::string before = std::getenv("PATH");
  explicit OnlyPath(const fs::path& folder) { ::setenv("PATH", folder.c_str(), 1); }
  ~OnlyPath() { ::setenv("PATH", before.c_str(), 1); }
};

// So many frames, each grey.
void encode(const fs::path& path, int frames) {
  const Size size{64, 36};
  FfmpegEncoder encoder(path, size, 50);
  Image frame(size);
  for (int k = 0; k < frames; ++k) {
    std::ranges::fill(frame.rgba, static_cast<std::uint8_t>(20 * k));
    encoder.add(frame.rgba);
  }
  encoder.finish();
}

TEST_CASE("a missing ffmpeg is named with its package") {
  const test::ScratchFolder folder;
  const OnlyPath path(folder.path());
  expect_error(Failure::work, Contains("package ffmpeg"), [&] { encode(folder / "a.mp4", 1); });
  CHECK(folder.entries() == 0);
}

TEST_CASE("a failing ffmpeg is quoted, and leaves no file") {
  const test::ScratchFolder folder;
  const fs::path program = folder / "bin" / "ffmpeg";
  fs::create_directories(program.parent_path());
  std::ofstream(program) << "#!/bin/sh\necho 'one thing' >&2\necho 'Unknown encoder' >&2\nexit 1\n";
  fs::permissions(program, fs::perms::owner_all);
  const OnlyPath path(program.parent_path());
  const int frames = GENERATE(0, 2000);  // failing at the end, and in between
  expect_error(Failure::work, Contains("a.mp4: ffmpeg failed: Unknown encoder"),
               [&] { encode(folder / "a.mp4", frames); });
  CHECK(folder.entries() == 1);
}

TEST_CASE("MP4, WebM and GIF are written whole") {
  if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) {
    WARN("skipped: no ffmpeg");
    return;
  }
  const test::ScratchFolder folder;
  const std::string name = GENERATE("a.mp4", "a.webm", "a.gif");
  encode(folder / name, 12);
  CHECK(folder.entries() == 1);
  std::string head(12, '\0');
  std::ifstream(folder / name, std::ios::binary).read(head.data(), 12);
  CHECK((head.substr(4, 4) == "ftyp" || head.substr(0, 4) == "\x1A\x45\xDF\xA3" ||
         head.substr(0, 6) == "GIF89a"));
  expect_error(Failure::cannot_create, Contains("nowhere"),
               [&] { encode(folder / "nowhere" / "a.mp4", 1); });
}

}  // namespace
}  // namespace evo::render
