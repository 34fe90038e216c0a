// The fonts as bytes of the program: the assembler includes the files of the
// package fonts-dejavu-core, whose paths CMake found.
#include "render/painters/font_data.h"

#define EVO_EMBED(symbol, path)        \
  __asm__(                             \
      ".section .rodata\n"             \
      ".balign 16\n" #symbol           \
      ":\n"                            \
      ".incbin \"" path "\"\n" #symbol \
      "_end:\n"                        \
      ".byte 0\n"                      \
      ".previous\n")

EVO_EMBED(evo_font_regular, EVO_FONT_REGULAR);
EVO_EMBED(evo_font_bold, EVO_FONT_BOLD);

extern "C" {
extern const unsigned char evo_font_regular[];
extern const unsigned char evo_font_regular_end[];
extern const unsigned char evo_font_bold[];
extern const unsigned char evo_font_bold_end[];
}

namespace evo::render {

std::span<const unsigned char> font_regular() { return {evo_font_regular, evo_font_regular_end}; }
std::span<const unsigned char> font_bold() { return {evo_font_bold, evo_font_bold_end}; }

}  // namespace evo::render
