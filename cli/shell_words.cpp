#include "cli/shell_words.h"

#include <wordexp.h>

#include "libevo/base/error.h"

namespace evo::cli {

std::vector<std::string> shell_words(const std::string& line, const std::string& where) {
  wordexp_t expansion{};
  if (::wordexp(line.c_str(), &expansion, WRDE_NOCMD) != 0)
    throw error(Failure::data, "{}: a shell could not read: {}", where, line);
  std::vector<std::string> words(expansion.we_wordv, expansion.we_wordv + expansion.we_wordc);
  ::wordfree(&expansion);
  return words;
}

}  // namespace evo::cli
