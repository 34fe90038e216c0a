// Pictures as shapes instead of pixels, for papers and pages: sharp at any size,
// text that can be searched.
#pragma once

#include <string>

#include "render/painters/text.h"

namespace evo::render {

// "#1f77b4", without its opacity.
std::string hex(Color color);

// A document that needs nothing else. Text is set in DejaVu Sans, or in what a
// viewer has instead, stretched to the same width. The same drawing gives the same
// bytes. `title` is for those who cannot see the picture.
std::string encode_svg(const Drawing& drawing, const std::string& title, Typesetter& typesetter);

// One page of the drawing's size at 96 pixels an inch, its letters embedded.
std::string encode_pdf(const Drawing& drawing, const std::string& title, Typesetter& typesetter);

}  // namespace evo::render
