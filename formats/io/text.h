// Text from files and arguments: taken apart, and made safe for terminals, pages and pictures.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace evo {

// The pieces between any of the separators, empty ones too.
std::vector<std::string_view> split(std::string_view text, std::string_view separators);
// The pieces between blanks, none of them empty.
std::vector<std::string_view> split_words(std::string_view text);
// Without the blanks at both ends.
std::string_view trimmed(std::string_view text);
// Without the mark that some editors put before UTF-8.
std::string_view without_byte_order_mark(std::string_view text);

// Control characters, line breaks included, and bytes that are not UTF-8 are written as \x1b.
std::string printable(std::string_view text);
// The same of several lines, whose breaks stay.
std::string printable_lines(std::string_view text);

// The same in XML and HTML, in an element or a quoted attribute.
std::string escaped(std::string_view text);

}  // namespace evo
