#include "render/painters/png.h"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <string_view>

#include "formats/io/files.h"
#include "libevo/base/error.h"
#include "render/film/animation.h"

namespace evo::render {
namespace {

// libpng leaves a function by longjmp on errors; in memory the only one is
// running out of it.
void append(png_structp png, png_bytep bytes, std::size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))
      ->append(reinterpret_cast<const char*>(bytes), count);  // NOLINT: bytes
}

// Rows of RGBX pixels, `stride` bytes apart, as an RGB file.
bool encode_rows(Size size, const std::uint8_t* pixels, std::size_t stride, int level,
                 std::string& out) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  if (info == nullptr || setjmp(png_jmpbuf(png)) != 0) {  // NOLINT: libpng's way
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, &out, append, nullptr);
  png_set_compression_level(png, level);
  png_set_IHDR(png, info, static_cast<png_uint_32>(size.width),
               static_cast<png_uint_32>(size.height), 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  png_set_filler(png, 0, PNG_FILLER_AFTER);
  for (int y = 0; y < size.height; ++y)
    png_write_row(png, pixels + static_cast<std::size_t>(y) * stride);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return true;
}

std::string encode_area(const PixelView& image, const Area& area, int level) {
  const auto stride = static_cast<std::size_t>(image.size.width) * 4;
  const auto start =
      static_cast<std::size_t>(area.y) * stride + static_cast<std::size_t>(area.x) * 4;
  std::string out;
  if (!encode_rows(area.size, &image.rgba[start], stride, level, out))
    throw error(Failure::work, "libpng cannot encode a picture of {}x{} pixels", area.size.width,
                area.size.height);
  return out;
}

// ---- chunks of an animated file ----------------------------------------------

constexpr std::size_t signature_bytes = 8;

void put16(std::string& out, std::uint32_t value) {
  out.push_back(static_cast<char>(value >> 8 & 255U));
  out.push_back(static_cast<char>(value & 255U));
}

void put32(std::string& out, std::uint32_t value) {
  put16(out, value >> 16);
  put16(out, value & 0xFFFFU);
}

std::uint32_t get32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k)
    value = value << 8U | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

void put_chunk(std::string& out, std::string_view type, std::string_view data) {
  put32(out, static_cast<std::uint32_t>(data.size()));
  const std::size_t start = out.size();
  out.append(type).append(data);
  const auto* checked = reinterpret_cast<const Bytef*>(out.data() + start);  // NOLINT: bytes
  put32(out, static_cast<std::uint32_t>(
                 crc32(0, checked, static_cast<uInt>(type.size() + data.size()))));
}

// Calls f(type, data) for every chunk of a PNG file.
template <typename F>
void each_chunk(std::string_view file, F f) {
  for (std::size_t at = signature_bytes; at + 12 <= file.size();) {
    const std::size_t length = get32(file, at);
    f(file.substr(at + 4, 4), file.substr(at + 8, length));
    at += length + 12;
  }
}

}  // namespace

std::string encode_png(const PixelView& image, int level) {
  return encode_area(image, {0, 0, image.size}, level);
}

void write_png(const std::filesystem::path& path, const PixelView& image, int level) {
  write_file(path, encode_png(image, level));
}

Image read_png(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0)
    throw error(Failure::data, "{}: not a PNG picture: {}", path.string(), png.message);
  png.format = PNG_FORMAT_RGBA;
  Image image(Size{static_cast<int>(png.width), static_cast<int>(png.height)});
  if (png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr) == 0)
    throw error(Failure::data, "{}: not a PNG picture: {}", path.string(), png.message);
  return image;
}

// ---- animation ----------------------------------------------------------------

ApngEncoder::ApngEncoder(Size size, std::size_t frames, int ticks)
    : size_(size), frames_(frames), ticks_(ticks) {}

void ApngEncoder::add(const PixelView& frame, int delay) {
  const Area area = changed_area(size_, previous_, frame.rgba, 4);
  const std::string file = encode_area(frame, area, 6);
  const bool first = added_++ == 0;
  bool described = false;
  const auto describe = [&] {
    std::string control;
    put32(control, sequence_++);
    put32(control, static_cast<std::uint32_t>(area.size.width));
    put32(control, static_cast<std::uint32_t>(area.size.height));
    put32(control, static_cast<std::uint32_t>(area.x));
    put32(control, static_cast<std::uint32_t>(area.y));
    put16(control, static_cast<std::uint32_t>(delay));
    put16(control, static_cast<std::uint32_t>(ticks_));
    control.append(2, '\0');  // leave the frame as it is; replace what was there
    put_chunk(bytes_, "fcTL", control);
    described = true;
  };
  if (first) bytes_.append(file, 0, signature_bytes);
  each_chunk(file, [&](std::string_view type, std::string_view data) {
    if (type == "IDAT") {
      if (!described) describe();
      if (first) {
        put_chunk(bytes_, type, data);
        return;
      }
      std::string numbered;
      put32(numbered, sequence_++);
      put_chunk(bytes_, "fdAT", numbered.append(data));
    } else if (first && type != "IEND") {
      put_chunk(bytes_, type, data);
      if (type != "IHDR") return;
      std::string animation;
      put32(animation, static_cast<std::uint32_t>(frames_));
      put32(animation, 0);  // for ever
      put_chunk(bytes_, "acTL", animation);
    }
  });
  previous_.assign(frame.rgba.begin(), frame.rgba.end());
}

std::string ApngEncoder::finish() {
  if (added_ != frames_)
    throw error(Failure::work, "an animation of {} frames was given {}", frames_, added_);
  put_chunk(bytes_, "IEND", "");
  return std::move(bytes_);
}

}  // namespace evo::render
