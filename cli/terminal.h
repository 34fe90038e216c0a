// Text for a terminal: colour when there is one, plain letters in a pipe.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "libevo/body/body.h"

namespace evo::cli {

// The body, top row first, two characters per voxel: blocks of colour where standard output is a
// terminal, and $NO_COLOR is unset, else letters.
std::string draw_body(const Body& body);

// "4.2 s", "3 min 20 s", "2 h 05 min"
std::string duration(double seconds);

// The size of standard error, or 80 and 24 where it is not a terminal.
std::size_t terminal_columns();
std::size_t terminal_rows();
// Whether it can go back and draw anew: $TERM is not "dumb".
bool terminal_redraws();
// Whether "▂" is shown as such: everywhere but on a terminal whose locale has no UTF-8.
bool shows_blocks();

// The width of standard output; nothing where it is not a terminal.
std::optional<std::size_t> output_columns();

// As many of the parts as fit into a line, two blanks between them; those that do not are left
// out, not cut. All of them where there is no width.
std::string as_line(const std::vector<std::string>& parts, std::optional<std::size_t> columns);

// Lines longer than `columns` broken at blanks; they continue so much further in than they began,
// or below the last column of a table, which begins after two blanks or more. A last
// column with little room begins a line of its own.
std::string wrapped(const std::string& text, std::size_t columns, std::size_t further = 4);

// To standard output; on a terminal, long lines are wrapped to its width.
void print_wrapped(const std::string& text);

// "812 B", "4.1 MB"
std::string file_size(double bytes);

}  // namespace evo::cli
