// neat-python's own configuration file, as the benchmark's users have it.
#pragma once

#include <string>
#include <string_view>

namespace evo {

// Whether text begins as such a file does: with a section, "[NEAT]".
bool begins_as_ini(std::string_view text);

// The settings as text of our own kind (`evo/neat`), each on the line where it was.
// Read as Python's configparser does: `key = value` or `key: value`, lines that continue
// indented, comments from # or ; to the end of a line of their own. What neat-python
// knows besides is left out where it changes nothing, and else refused. Throws
// Error(data) with the line.
std::string neat_ini_to_yaml(std::string_view text, const std::string& where);

}  // namespace evo
