// Files as bytes of the program: the assembler includes them where CMake found them.
//
//   EVO_EMBED(symbol, path);  // outside of all namespaces
//   EVO_EMBEDDED(symbol)      // a std::string_view
#pragma once

#include <cstddef>
#include <string_view>

// NOLINTBEGIN(bugprone-macro-parentheses): a path is one of several adjacent literals
#define EVO_EMBED(symbol, path)        \
  __asm__(                             \
      ".section .rodata\n"             \
      ".balign 16\n" #symbol           \
      ":\n"                            \
      ".incbin \"" path "\"\n" #symbol \
      "_end:\n"                        \
      ".byte 0\n"                      \
      ".previous\n");                  \
  extern "C" const char symbol[];      \
  extern "C" const char symbol##_end[]
// NOLINTEND(bugprone-macro-parentheses)

#define EVO_EMBEDDED(symbol) \
  std::string_view { symbol, static_cast<std::size_t>(symbol##_end - symbol) }
