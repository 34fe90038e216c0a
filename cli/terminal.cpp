#include "cli/terminal.h"

#include <langinfo.h>
#include <locale.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "formats/io/text.h"
#include "libevo/base/error.h"

namespace evo::cli {
namespace {

// A background and a letter of the 256-colour palette, the kinds' colours in pictures. A contrast
// of 4.5 and more.
struct Paint {
  int background;
  int letter;
};
constexpr std::array<Paint, 6> paints{
    // by kind, which is empty first
    {{-1, -1}, {241, 254}, {250, 236}, {214, 52}, {74, 17}, {245, 232}}};

// Of the terminal at a stream; 0 where it is none, or does not say.
winsize size_of(int stream) {
  winsize size{};
  return ::ioctl(stream, TIOCGWINSZ, &size) == 0 ? size : winsize{};
}

// How many there are in UTF-8 text whose characters are one column wide.
std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

}  // namespace

std::string draw_body(const Body& body) {
  const bool color =
      isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr && terminal_redraws();
  std::string text;
  for (int row = 0; row < body.rows; ++row) {
    for (int col = 0; col < body.cols; ++col) {
      const Voxel voxel = body.at(row, col);
      const char symbol = letter(voxel);
      if (!color) {
        text += symbol;
        if (col + 1 < body.cols) text += ' ';
      } else if (voxel == Voxel::empty) {
        text += "  ";
      } else {
        const Paint& p = paints.at(static_cast<std::size_t>(voxel));
        text += fmt::format("\x1b[48;5;{}m\x1b[38;5;{}m{} \x1b[0m", p.background, p.letter, symbol);
      }
    }
    text += '\n';
  }
  return text;
}

std::string duration(double seconds) {
  if (!(seconds >= 0.0)) return "?";
  if (seconds < 60.0) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long long>(std::llround(seconds));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::size_t terminal_columns() {
  const std::size_t known = size_of(STDERR_FILENO).ws_col;
  return known > 0 ? known : 80;
}

std::size_t terminal_rows() {
  const std::size_t known = size_of(STDERR_FILENO).ws_row;
  return known > 0 ? known : 24;
}

bool terminal_redraws() {
  const char* terminal = std::getenv("TERM");
  return terminal == nullptr || std::string_view(terminal) != "dumb";
}

bool shows_blocks() {
  static const bool known = [] {
    if (isatty(STDOUT_FILENO) != 1 && isatty(STDERR_FILENO) != 1) return true;
    const locale_t user = ::newlocale(LC_CTYPE_MASK, "", nullptr);
    if (user == nullptr) return false;
    const bool utf8 = std::string_view(::nl_langinfo_l(CODESET, user)) == "UTF-8";
    ::freelocale(user);
    return utf8;
  }();
  return known;
}

std::optional<std::size_t> output_columns() {
  if (isatty(STDOUT_FILENO) != 1) return std::nullopt;
  const std::size_t known = size_of(STDOUT_FILENO).ws_col;
  return known > 0 ? known : 80;
}

std::string as_line(const std::vector<std::string>& parts, std::optional<std::size_t> columns) {
  std::string text;
  std::size_t used = 0;
  for (const std::string& part : parts) {
    const std::size_t width = characters(part) + (text.empty() ? 0 : 2);
    if (columns && !text.empty() && used + width > *columns) continue;
    text += (text.empty() ? "" : "  ") + part;
    used += width;
  }
  return text;
}

namespace {

// Where the last column of a table begins, in bytes; 0 for text without columns.
std::size_t last_column(const std::string& line, std::size_t columns) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  std::size_t found = 0;
  for (std::size_t k = begin; k + 2 < line.size() && characters(line.substr(0, k)) < columns; ++k)
    if (line[k] == ' ' && line[k + 1] == ' ' && line[k + 2] != ' ') found = k + 2;
  return found;
}

void wrap_line(const std::string& line, std::size_t columns, std::size_t further,
               std::string& text) {
  if (characters(line) <= columns) {
    text += line;
    return;
  }
  const std::size_t last = last_column(line, columns);
  std::size_t indent = characters(std::string_view(line).substr(0, last));
  std::string rest = line;
  constexpr std::size_t least = 35;  // a last column that is narrower stands in lines of its own
  if (last == 0 || indent + least > columns) {
    indent = std::min(line.find_first_not_of(' '), line.size()) + further;
    if (last > 0) {
      text += line.substr(0, line.find_last_not_of(' ', last - 1) + 1) + '\n';
      rest = std::string(indent, ' ') + line.substr(last);
    }
  }
  for (;;) {
    const std::string head = fmt::format("{:.{}}", rest, columns);
    if (head.size() == rest.size()) break;
    std::size_t blank = rest[head.size()] == ' ' ? head.size() : head.rfind(' ');
    // A word as long as a line is not broken.
    if (blank == std::string::npos || blank <= rest.find_first_not_of(' '))
      blank = rest.find(' ', head.size());
    const std::size_t next =
        blank == std::string::npos ? blank : rest.find_first_not_of(' ', blank);
    if (next == std::string::npos) break;
    text += rest.substr(0, rest.find_last_not_of(' ', blank) + 1) + '\n';
    rest = std::string(indent, ' ') + rest.substr(next);
  }
  text += rest;
}

}  // namespace

std::string wrapped(const std::string& text, std::size_t columns, std::size_t further) {
  std::string result;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    wrap_line(text.substr(from, end - from), columns, further, result);
    if (end < text.size()) result += '\n';
    from = end + 1;
  }
  return result;
}

void print_wrapped(const std::string& text) {
  const auto columns = output_columns();
  const std::string shown = printable_lines(text);
  fmt::print("{}", columns ? wrapped(shown, *columns) : shown);
}

std::string file_size(double bytes) {
  static constexpr std::array units{"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  while (bytes >= 1000.0 && unit + 1 < units.size()) {
    bytes /= 1000.0;
    ++unit;
  }
  return unit == 0 ? fmt::format("{:.0f} B", bytes) : fmt::format("{:.1f} {}", bytes, units[unit]);
}

}  // namespace evo::cli
