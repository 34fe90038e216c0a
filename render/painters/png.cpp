#include "render/painters/png.h"

#include <png.h>

#include <vector>

#include "libevo/base/error.h"

namespace evo::render {

std::string encode_png(const Image& image, Effort effort) {
  std::vector<std::uint8_t> rgb(image.rgba.size() / 4 * 3);
  for (std::size_t pixel = 0; pixel < image.rgba.size() / 4; ++pixel)
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * pixel + c] = image.rgba[4 * pixel + c];
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.size.width);
  png.height = static_cast<png_uint_32>(image.size.height);
  png.format = PNG_FORMAT_RGB;
  png.flags = effort == Effort::quick ? PNG_IMAGE_FLAG_FAST : 0;
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string file(bytes, '\0');
  if (png_image_write_to_memory(&png, file.data(), &bytes, 0, rgb.data(), 0, nullptr) == 0)
    throw error(Failure::work, "libpng cannot encode a picture of {}x{} pixels: {}",
                image.size.width, image.size.height, png.message);
  file.resize(bytes);
  return file;
}

}  // namespace evo::render
