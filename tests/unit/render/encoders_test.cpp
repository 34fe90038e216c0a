#include <fcntl.h>
#include <gif_lib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>

#include "libevo/base/random.h"
#include "render/film/animation.h"
#include "render/film/gif.h"
#include "render/film/video.h"
#include "render/painters/png.h"
#include "tests/unit/render/expect_error.h"

namespace evo::render {
namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;

// A folder that is gone afterwards.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("evo-render-" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(path), fs::directory_iterator()));
  }
};

// A gradient with a square that moves with `k`.
Image test_frame(Size size, int k) {
  Image image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const bool square = x >= 3 * k && x < 3 * k + 8 && y >= 5 && y < 13;
      auto* pixel = &image.rgba[4 * static_cast<std::size_t>(y * size.width + x)];
      pixel[0] = square ? 250 : static_cast<std::uint8_t>(2 * y);
      pixel[1] = square ? 140 : static_cast<std::uint8_t>(100 + y);
      pixel[2] = square ? 60 : 200;
      pixel[3] = 255;
    }
  return image;
}

// ---- PNG ------------------------------------------------------------------------

TEST_CASE("a PNG comes back as it was written") {
  const Folder folder;
  Image image(Size{37, 11});
  Stream stream(1, "test/png");
  for (std::size_t k = 0; k < image.rgba.size(); ++k)
    image.rgba[k] = k % 4 == 3 ? 255 : static_cast<std::uint8_t>(stream.below(256));
  const int level = GENERATE(1, 6, 9);
  write_png(folder.path / "a.png", view(image), level);
  const Image back = read_png(folder.path / "a.png");
  CHECK(back.size == image.size);
  CHECK(back.rgba == image.rgba);
  CHECK(folder.files() == 1);
  CHECK(encode_png(view(image), level) == encode_png(view(image), level));
}

TEST_CASE("what is no PNG is refused") {
  const Folder folder;
  std::ofstream(folder.path / "a.png") << "no picture";
  expect_error(Failure::data, Contains("a.png"), [&] { read_png(folder.path / "a.png"); });
  expect_error(Failure::no_input, Contains("b.png"), [&] { read_png(folder.path / "b.png"); });
}

// ---- what changed ------------------------------------------------------------------

TEST_CASE("the changed area is the smallest rectangle") {
  const Size size{20, 10};
  std::vector<std::uint8_t> before(200, 7);
  auto after = before;
  CHECK(changed_area(size, {}, after, 1).size == size);
  CHECK(changed_area(size, before, after, 1).size == Size{1, 1});
  after[3 * 20 + 4] = 1;
  after[6 * 20 + 15] = 1;
  const Area area = changed_area(size, before, after, 1);
  CHECK(area.x == 4);
  CHECK(area.y == 3);
  CHECK(area.size == Size{12, 4});
}

// ---- animated PNG ---------------------------------------------------------------------

TEST_CASE("an animated PNG has its chunks in order and shows its first frame anywhere") {
  const Folder folder;
  const Size size{40, 20};
  ApngEncoder encoder(size, 3, 1000);
  for (int k = 0; k < 3; ++k) {
    const Image frame = test_frame(size, k);
    encoder.add(view(frame), 20);
  }
  const std::string bytes = encoder.finish();
  std::vector<std::string> types;
  std::uint32_t sequence = 0;
  for (std::size_t at = 8; at < bytes.size();) {
    const auto get = [&](std::size_t from) {
      std::uint32_t v = 0;
      for (std::size_t k = 0; k < 4; ++k) v = v << 8U | static_cast<unsigned char>(bytes[from + k]);
      return v;
    };
    const std::string type = bytes.substr(at + 4, 4);
    types.push_back(type);
    if (type == "fcTL" || type == "fdAT") CHECK(get(at + 8) == sequence++);
    at += get(at) + 12;
  }
  const std::vector<std::string> expected{"IHDR", "acTL", "sRGB", "fcTL", "IDAT",
                                          "fcTL", "fdAT", "fcTL", "fdAT", "IEND"};
  CHECK(types == expected);
  write_file(folder.path / "a.png", bytes);
  CHECK(read_png(folder.path / "a.png").rgba == test_frame(size, 0).rgba);
}

TEST_CASE("an animated PNG with frames missing is not finished") {
  ApngEncoder encoder({4, 4}, 2, 100);
  const Image frame(Size{4, 4});
  encoder.add(view(frame), 1);
  CHECK_THROWS_AS(encoder.finish(), Error);
}

// ---- palette ----------------------------------------------------------------------------

TEST_CASE("few colours are kept exactly, many are close") {
  Histogram histogram;
  const Image frame = test_frame({40, 20}, 1);
  histogram.add(frame.rgba);
  const auto exact = make_palette(histogram, 255);
  CHECK(exact.size() == histogram.counts().size());
  PaletteMap map(exact);
  for (std::size_t k = 0; k < frame.rgba.size(); k += 4) {
    const Color color =
        map.palette()[map.index(frame.rgba[k], frame.rgba[k + 1], frame.rgba[k + 2])];
    CHECK((color.r == frame.rgba[k] && color.g == frame.rgba[k + 1]));
  }

  Image noisy(Size{100, 100});
  Stream stream(3, "test/palette");
  for (std::size_t k = 0; k < noisy.rgba.size(); ++k)  // greys with a tint, and a flat orange
    noisy.rgba[k] = k < 4000 ? std::array<std::uint8_t, 4>{250, 140, 60, 255}[k % 4]
                             : static_cast<std::uint8_t>(stream.below(100));
  Histogram many;
  many.add(noisy.rgba);
  PaletteMap close(make_palette(many, 255));
  CHECK(close.palette().size() == 255);
  const Color orange = close.palette()[close.index(250, 140, 60)];
  CHECK((orange.r == 250 && orange.g == 140 && orange.b == 60));
  double error = 0;
  for (std::size_t k = 4000; k < noisy.rgba.size(); k += 4) {
    const Color c =
        close.palette()[close.index(noisy.rgba[k], noisy.rgba[k + 1], noisy.rgba[k + 2])];
    error += std::pow(c.r - noisy.rgba[k], 2) + std::pow(c.g - noisy.rgba[k + 1], 2) +
             std::pow(c.b - noisy.rgba[k + 2], 2);
  }
  // A regular lattice of 255 points in a cube of side 100 errs by 250 on average.
  CHECK(error / 9000 < 250);
}

// ---- GIF -----------------------------------------------------------------------------------

// Frames of a GIF as a viewer shows them.
std::vector<std::vector<std::uint8_t>> play(const fs::path& path, std::vector<int>& delays) {
  int code = 0;
  GifFileType* gif = DGifOpenFileName(path.c_str(), &code);
  REQUIRE(gif != nullptr);
  REQUIRE(DGifSlurp(gif) == GIF_OK);
  std::vector<std::vector<std::uint8_t>> frames;
  std::vector<std::uint8_t> canvas(static_cast<std::size_t>(gif->SWidth * gif->SHeight) * 3);
  for (int k = 0; k < gif->ImageCount; ++k) {
    const SavedImage& image = gif->SavedImages[k];
    GraphicsControlBlock control{};
    REQUIRE(DGifSavedExtensionToGCB(gif, k, &control) == GIF_OK);
    delays.push_back(control.DelayTime);
    const GifImageDesc& where = image.ImageDesc;
    for (int y = 0; y < where.Height; ++y)
      for (int x = 0; x < where.Width; ++x) {
        const int index = image.RasterBits[y * where.Width + x];
        if (index == control.TransparentColor) continue;
        const GifColorType color = gif->SColorMap->Colors[index];
        auto* pixel =
            &canvas[3 * static_cast<std::size_t>((where.Top + y) * gif->SWidth + where.Left + x)];
        pixel[0] = color.Red;
        pixel[1] = color.Green;
        pixel[2] = color.Blue;
      }
    frames.push_back(canvas);
  }
  DGifCloseFile(gif, &code);
  return frames;
}

TEST_CASE("a GIF plays back as drawn") {
  const Folder folder;
  const Size size{40, 20};
  Histogram histogram;
  for (int k = 0; k < 4; ++k) histogram.add(test_frame(size, k).rgba);
  GifEncoder encoder(size, make_palette(histogram, gif_colors));
  for (int k = 0; k < 4; ++k) {
    const Image frame = test_frame(size, k == 3 ? 2 : k);  // the last changes nothing
    encoder.add(view(frame), 2 + k);
  }
  write_file(folder.path / "a.gif", encoder.finish());
  std::vector<int> delays;
  const auto frames = play(folder.path / "a.gif", delays);
  REQUIRE(frames.size() == 4);
  CHECK(delays == std::vector<int>{2, 3, 4, 5});
  for (int k = 0; k < 4; ++k) {
    const Image drawn = test_frame(size, k == 3 ? 2 : k);
    const auto& shown = frames[static_cast<std::size_t>(k)];
    bool same = true;
    for (std::size_t p = 0; p < shown.size() / 3; ++p)
      for (std::size_t c = 0; c < 3; ++c) same = same && shown[3 * p + c] == drawn.rgba[4 * p + c];
    CHECK(same);
  }
}

// ---- Y4M --------------------------------------------------------------------------------------

TEST_CASE("planes are BT.709, limited range") {
  const auto planes = [](Color color, Size size) {
    Image image(size);
    for (std::size_t k = 0; k < image.rgba.size(); k += 4) {
      image.rgba[k] = color.r;
      image.rgba[k + 1] = color.g;
      image.rgba[k + 2] = color.b;
    }
    std::vector<std::uint8_t> out(yuv_bytes(size));
    to_yuv(view(image), out);
    return out;
  };
  const auto color = [&](Color c) {
    const auto p = planes(c, {2, 2});
    return std::array<int, 3>{p[0], p[4], p[5]};
  };
  CHECK(color({0, 0, 0}) == std::array<int, 3>{16, 128, 128});
  CHECK(color({255, 255, 255}) == std::array<int, 3>{235, 128, 128});
  CHECK(color({255, 0, 0}) == std::array<int, 3>{63, 102, 240});
  CHECK(color({0, 255, 0}) == std::array<int, 3>{173, 42, 26});
  CHECK(color({0, 0, 255}) == std::array<int, 3>{32, 240, 118});
  CHECK(planes({9, 9, 9}, {5, 3}).size() == 15 + 2 * 6);  // odd sides are rounded up
  CHECK(y4m_header({640, 360}, 29.97) ==
        "YUV4MPEG2 W640 H360 F29970:1000 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n");
}

TEST_CASE("a reader that goes away raises no signal") {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  CHECK(write_quietly(ends[1], "abc", "test"));
  ::close(ends[0]);
  CHECK_FALSE(write_quietly(ends[1], "def", "test"));
  ::close(ends[1]);
  expect_error(Failure::io, Contains("test"), [] { write_quietly(-1, "x", "test"); });
}

// ---- ffmpeg -------------------------------------------------------------------------------------

// PATH with one folder in it.
struct OnlyPath {
  std::string before = std::getenv("PATH");
  explicit OnlyPath(const fs::path& folder) { ::setenv("PATH", folder.c_str(), 1); }
  ~OnlyPath() { ::setenv("PATH", before.c_str(), 1); }
};

void encode(const fs::path& path, int frames) {
  const Size size{64, 36};
  FfmpegEncoder encoder(path, size, 50);
  std::vector<std::uint8_t> planes(yuv_bytes(size));
  for (int k = 0; k < frames; ++k) {
    to_yuv(view(test_frame(size, k % 10)), planes);
    encoder.add(planes);
  }
  encoder.finish();
}

TEST_CASE("a missing ffmpeg is named with its package") {
  const Folder folder;
  const OnlyPath path(folder.path);
  expect_error(Failure::work, Contains("package ffmpeg"),
               [&] { encode(folder.path / "a.mp4", 1); });
  CHECK(folder.files() == 0);
}

TEST_CASE("a failing ffmpeg is quoted, and leaves no file") {
  const Folder folder;
  const fs::path program = folder.path / "bin" / "ffmpeg";
  fs::create_directories(program.parent_path());
  std::ofstream(program) << "#!/bin/sh\necho 'one thing' >&2\necho 'Unknown encoder' >&2\nexit 1\n";
  fs::permissions(program, fs::perms::owner_all);
  const OnlyPath path(program.parent_path());
  const int frames = GENERATE(0, 2000);  // failing at the end, and in between
  expect_error(Failure::work, Contains("a.mp4: ffmpeg failed: Unknown encoder"),
               [&] { encode(folder.path / "a.mp4", frames); });
  CHECK(folder.files() == 1);
}

TEST_CASE("MP4 and WebM are written whole") {
  if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) {
    WARN("skipped: no ffmpeg");
    return;
  }
  const Folder folder;
  const std::string name = GENERATE("a.mp4", "a.webm");
  encode(folder.path / name, 12);
  CHECK(folder.files() == 1);
  std::string head(12, '\0');
  std::ifstream(folder.path / name, std::ios::binary).read(head.data(), 12);
  CHECK((head.substr(4, 4) == "ftyp" || head.substr(0, 4) == "\x1A\x45\xDF\xA3"));
  expect_error(Failure::usage, Contains(".mp4 or .webm"),
               [&] { encode(folder.path / "a.avi", 1); });
  expect_error(Failure::cannot_create, Contains("nowhere"),
               [&] { encode(folder.path / "nowhere" / "a.mp4", 1); });
}

}  // namespace
}  // namespace evo::render
