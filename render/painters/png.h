// PNG, through libpng.
#pragma once

#include <string>

#include "render/painters/image.h"

namespace evo::render {

enum class Effort { small, quick };  // what the file is to be

// The bytes of a whole file.
std::string encode_png(const Image& image, Effort effort = Effort::small);

}  // namespace evo::render
