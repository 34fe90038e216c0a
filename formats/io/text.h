// Text from files and arguments on its way out: to terminals, pages and pictures.
#pragma once

#include <string>
#include <string_view>

namespace evo {

// Control characters, line breaks included, and bytes that are not UTF-8 are written as \x1b.
std::string printable(std::string_view text);
// The same of several lines, whose breaks stay.
std::string printable_lines(std::string_view text);

// The same in XML and HTML, in an element or a quoted attribute.
std::string escaped(std::string_view text);

}  // namespace evo
