// Options kept as one line of text in a setting, such as train_options.
#pragma once

#include <string>
#include <vector>

namespace evo {

// The words of the line: blanks separate them, '..' and ".." keep text together, \ keeps
// the next character. Nothing is expanded: $HOME and * stand for themselves. Throws
// Error(data), with `where`, for a quote that is left open.
std::vector<std::string> option_words(const std::string& line, const std::string& where);

}  // namespace evo
