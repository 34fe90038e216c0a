// JSON text read with care: errors carry line, column and path; a key given
// twice is an error; so is nesting so deep that walking over it would exhaust
// the stack. And the errors of documents made of JSON.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "libevo/base/error.h"

// Instantiated once, in json.cpp.
extern template class nlohmann::basic_json<nlohmann::ordered_map>;

namespace evo {

// Key order is kept, so that what passes through a tool stays recognisable.
using Json = nlohmann::ordered_json;

inline constexpr int deepest_json = 100;  // levels of arrays and objects

// The one value in `text`; `where` begins every message. Throws Error(data).
Json parse_json(std::string_view text, const std::string& where);

// On one line, without blanks; what is not UTF-8 is replaced.
std::string compact(const Json& value);

bool is_utf8(const std::string& text);

// A value, or a letter, as a message shows it: short and on one line.
std::string shown(const Json& value);
std::string shown(char letter);

// ---- texts of several values ------------------------------------------------

struct JsonPiece {
  std::string_view text;  // one value
  std::size_t line = 1;   // where it begins
};

// Splits a text of objects and arrays that follow each other, one per line or
// not, by their brackets. What stands inside is left to the parser.
class JsonPieces {
 public:
  JsonPieces(std::string_view text, std::string where) : text_(text), where_(std::move(where)) {}

  // The next one, or nothing at the end. Throws Error(data).
  std::optional<JsonPiece> next();
  // Whether nothing but blanks is left.
  bool done();

 private:
  void skip_blanks();
  void skip_value();

  std::string_view text_;
  std::string where_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

Json parse_json(const JsonPiece& piece, const std::string& where);

// ---- refused documents ------------------------------------------------------

// Why a document is refused and the JSON path of the reason; becomes an Error
// where the file and the line are known.
struct Refusal {
  std::string path;  // "/body/1", or empty for the whole
  std::string message;

  Error at(const std::string& where) const;
};

template <typename... Args>
Refusal refusal(std::string path, fmt::format_string<Args...> format, Args&&... args) {
  return {std::move(path), fmt::format(format, std::forward<Args>(args)...)};
}

// "<where>: <what>", or `what` alone.
std::string with_place(const std::string& where, const std::string& what);

}  // namespace evo
