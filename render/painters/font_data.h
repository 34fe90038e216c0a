// DejaVu Sans, Book and Bold, as FreeType reads them; their files are part of the program.
#pragma once

#include <ft2build.h>
#include FT_FREETYPE_H

namespace evo::render {

// Both throw Error(work).
FT_Library start_freetype();
FT_Face open_font(FT_Library library, bool bold);

}  // namespace evo::render
