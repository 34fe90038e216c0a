// The files of the package fonts-dejavu-core.
#include "render/painters/font_data.h"

#include "libevo/base/error.h"
#include "render/painters/embed.h"

EVO_EMBED(evo_font_regular, EVO_FONT_REGULAR);
EVO_EMBED(evo_font_bold, EVO_FONT_BOLD);

namespace evo::render {

FT_Library start_freetype() {
  FT_Library library = nullptr;
  if (FT_Init_FreeType(&library) != 0) throw Error(Failure::work, "FreeType cannot start");
  return library;
}

FT_Face open_font(FT_Library library, bool bold) {
  const std::string_view file = bold ? EVO_EMBEDDED(evo_font_bold) : EVO_EMBEDDED(evo_font_regular);
  FT_Face face = nullptr;
  if (FT_New_Memory_Face(library, reinterpret_cast<const FT_Byte*>(file.data()),  // NOLINT: bytes
                         static_cast<FT_Long>(file.size()), 0, &face) != 0)
    throw Error(Failure::work, "FreeType cannot read the built-in font");
  return face;
}

}  // namespace evo::render
