// Pictures of tests, back from their files.
#pragma once

#include <png.h>

#include <filesystem>
#include <stdexcept>

#include "render/painters/image.h"

namespace evo::render {

inline Image read_png(const std::filesystem::path& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&png, path.c_str()) == 0)
    throw std::runtime_error(png.message);
  png.format = PNG_FORMAT_RGBA;
  Image image(Size{static_cast<int>(png.width), static_cast<int>(png.height)});
  if (png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr) == 0)
    throw std::runtime_error(png.message);
  return image;
}

}  // namespace evo::render
