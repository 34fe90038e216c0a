// JSON: the value that documents are written from, and the reading of JSON text, which fills a
// Node.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/io/node.h"

// Instantiated once, in json.cpp.
extern template class nlohmann::basic_json<nlohmann::ordered_map>;

namespace evo {

// Key order is kept, so that what passes through a tool stays recognisable.
using Json = nlohmann::ordered_json;

// On one line, without blanks; what is not UTF-8 is replaced.
std::string compact(const Json& value);

bool is_utf8(const std::string& text);

// A text, or a letter, as a message shows it: short and on one line.
std::string shown(std::string_view text);
std::string shown(char letter);

// What a document holds. Plain scalars have the types of YAML's core schema, without hexadecimal
// and octal numbers; what is quoted is text, and so are the items of the keys `text_keys` at the
// outer level, quoted or not (an id may look like a number). Throws Error(data) for aliases that
// blow a small text up.
Json to_json(const Node& node, const std::vector<std::string>& text_keys = {});
// A value as a document to be read; `where` begins every message.
Node to_node(const Json& value, const std::string& where);

// ---- texts of several values ------------------------------------------------

struct JsonPiece {
  std::string_view text;  // one value
  int line = 1;           // where it begins
  int column = 1;

  Node parse(const std::string& file) const;
};

// Splits a text of objects and arrays that follow each other, one per line or
// not, by their brackets. What stands inside is left to the parser.
class JsonPieces {
 public:
  JsonPieces(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  // The next one, or nothing at the end. Throws Error(data).
  std::optional<JsonPiece> next();
  // Whether nothing but blanks is left.
  bool done();

 private:
  void skip_blanks();
  void skip_value();

  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 1;
};

}  // namespace evo
