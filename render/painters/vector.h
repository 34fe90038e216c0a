// Pictures as shapes instead of pixels, for papers and pages: sharp at any size,
// text that can be searched.
#pragma once

#include <map>
#include <string>

#include "render/painters/text.h"

namespace evo::render {

// "#1f77b4", without its opacity.
std::string hex(Color color);

// A document that needs nothing else. Text is set in DejaVu Sans, or in what a
// viewer has instead, stretched to the same width. The same drawing gives the same
// bytes. `title` is for those who cannot see the picture. With the style of a page, a part of that,
// in its font, as wide as there is room: nothing that is cut, no gradients; colours by hex() are
// what the page calls them.
using PageStyle = std::map<std::string, std::string>;
std::string encode_svg(const Drawing& drawing, const std::string& title, Typesetter& typesetter,
                       const PageStyle* style = nullptr);

// One page of the drawing's size at 96 pixels an inch, its letters embedded.
std::string encode_pdf(const Drawing& drawing, const std::string& title, Typesetter& typesetter);

}  // namespace evo::render
