// Options kept as one line of text, split as a shell would.
#pragma once

#include <string>
#include <vector>

namespace evo::cli {

// Quotes and variables included; nothing is run. Throws Error(data) with `where`.
std::vector<std::string> shell_words(const std::string& line, const std::string& where);

}  // namespace evo::cli
