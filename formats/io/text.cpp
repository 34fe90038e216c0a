#include "formats/io/text.h"

#include <fmt/format.h>

#include <algorithm>

namespace evo {
namespace {

constexpr std::string_view blanks = " \t\r";

// Bytes of the first character; 0 where none begins that UTF-8 allows: too long a
// form, half a surrogate pair, a number beyond U+10FFFF.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return 1;
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
  const bool refused = (byte(0) == 0xE0 && byte(1) < 0xA0) || (byte(0) == 0xED && byte(1) > 0x9F) ||
                       (byte(0) == 0xF0 && byte(1) < 0x90) || (byte(0) == 0xF4 && byte(1) > 0x8F);
  return refused ? 0 : length;
}

}  // namespace

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> pieces;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    pieces.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return pieces;
}

std::vector<std::string_view> split_words(std::string_view text) {
  std::vector<std::string_view> words = split(text, blanks);
  std::erase(words, "");
  return words;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

std::string printable(std::string_view text) {
  std::string shown;
  const auto byte = [](char c) { return static_cast<unsigned char>(c); };
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    // U+0080 to U+009F are control characters of two bytes.
    const bool control = byte(text[0]) < 0x20 || byte(text[0]) == 0x7F ||
                         (length == 2 && byte(text[0]) == 0xC2 && byte(text[1]) < 0xA0);
    const std::size_t taken = std::max<std::size_t>(length, 1);
    for (const char c : text.substr(0, taken))
      shown += length == 0 || control ? fmt::format("\\x{:02x}", byte(c)) : std::string(1, c);
    text.remove_prefix(taken);
  }
  return shown;
}

std::string printable_lines(std::string_view text) {
  std::string shown;
  for (const std::string_view line : split(text, "\n")) shown += printable(line) + '\n';
  shown.pop_back();
  return shown;
}

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : printable_lines(text)) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else if (c == '"')
      safe += "&quot;";
    else if (c == '\'')
      safe += "&#39;";
    else
      safe += c;
  }
  return safe;
}

}  // namespace evo
