// PNG files, through libpng.
#pragma once

#include <filesystem>
#include <string>

#include "render/painters/image.h"

namespace evo::render {

enum class Effort { small, quick };  // what the file is to be

// The bytes of a whole file.
std::string encode_png(const PixelView& image, Effort effort = Effort::small);
// Throws Error(cannot_create, io).
void write_png(const std::filesystem::path& path, const PixelView& image,
               Effort effort = Effort::small);

}  // namespace evo::render
