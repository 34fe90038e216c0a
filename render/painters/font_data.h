#pragma once

#include <span>

namespace evo::render {

// TrueType files: DejaVu Sans, Book and Bold.
std::span<const unsigned char> font_regular();
std::span<const unsigned char> font_bold();

}  // namespace evo::render
