#include "formats/io/json.h"

#include <algorithm>
#include <unordered_set>
#include <vector>

template class nlohmann::basic_json<nlohmann::ordered_map>;

namespace evo {
namespace {

// What the parser has to say, without its own numbering and line breaks.
std::string parser_reason(const std::string& message) {
  constexpr std::size_t most = 160;
  std::string reason = message;
  for (const char* prefix_end : {"] ", "column ", ": "})
    if (const auto found = reason.find(prefix_end); found != std::string::npos)
      reason.erase(0, found + std::string_view(prefix_end).size());
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  if (reason.size() > most) reason = reason.substr(0, most) + "...";
  return reason;
}

Error malformed(const JsonPiece& piece, std::size_t byte, const std::string& message,
                const std::string& where) {
  const std::string_view before = piece.text.substr(0, byte == 0 ? 0 : byte - 1);
  const auto lines = static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  return refusal("", "malformed JSON at column {}: {}", before.size() - line_start + 1,
                 parser_reason(message))
      .at(with_place(where, fmt::format("line {}", piece.line + lines)));
}

// Builds a value from the parser's events. The library's own builder keeps the
// last of several values of one key, rounds whole numbers that are too long, and
// looks every new key up among all before it.
class Builder : public nlohmann::json_sax<Json> {
 public:
  Json value;
  std::size_t failed_at = 0;  // byte, where the parser gave up
  std::string failure;

  bool null() override { return add(nullptr); }
  bool boolean(bool given) override { return add(given); }
  bool number_integer(number_integer_t given) override { return add(given); }
  bool number_unsigned(number_unsigned_t given) override { return add(given); }
  bool number_float(number_float_t given, const string_t& text) override {
    if (loses_digits(given, text))
      throw refusal("", "the whole number {} has more than 64 bits; write it as text",
                    shown(Json(text)));
    return add(given);
  }
  bool string(string_t& given) override { return add(std::move(given)); }
  bool binary(binary_t&) override { return false; }  // not in JSON text
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& given) override {
    if (!open_.back().keys.insert(given).second)
      throw refusal("", "the key {} is given twice in one object", shown(Json(given)));
    open_.back().key = std::move(given);
    return true;
  }
  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& reason) override {
    failed_at = position;
    failure = reason.what();
    return false;
  }

 private:
  struct Open {
    Json value;
    std::unordered_set<std::string> keys;
    std::string key;  // of the item that comes next
  };

  static bool loses_digits(double value, const std::string& text) {
    return text.find_first_not_of("-0123456789") == text.npos &&
           text != fmt::format("{:.0f}", value);
  }

  bool open(Json empty) {
    open_.push_back({std::move(empty), {}, {}});
    return true;
  }

  bool close() {
    Json done = std::move(open_.back().value);
    open_.pop_back();
    return add(std::move(done));
  }

  bool add(Json item) {
    if (open_.empty()) {
      value = std::move(item);
    } else if (Open& parent = open_.back(); parent.value.is_array()) {
      parent.value.push_back(std::move(item));
    } else {
      // The vector below the ordered map: the key is known to be new.
      using Items = std::vector<Json::object_t::value_type>;
      static_cast<Items&>(parent.value.get_ref<Json::object_t&>())
          .emplace_back(std::move(parent.key), std::move(item));
    }
    return true;
  }

  std::vector<Open> open_;
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

}  // namespace

bool is_utf8(const std::string& text) {
  try {
    (void)Json(text).dump();
    return true;
  } catch (const Json::exception&) {
    return false;
  }
}

std::string compact(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string shown(const Json& value) {
  constexpr std::size_t most = 40;
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > most) text = text.substr(0, most) + "...";
  return text;
}

std::string shown(char letter) {
  if (letter >= ' ' && letter <= '~') return fmt::format("'{}'", letter);
  return fmt::format("0x{:02X}", static_cast<unsigned char>(letter));
}

std::string with_place(const std::string& where, const std::string& what) {
  return where.empty() ? what : fmt::format("{}: {}", where, what);
}

Error Refusal::at(const std::string& where) const {
  return {Failure::data, with_place(where, with_place(path, message))};
}

// ---- JsonPieces ---------------------------------------------------------------

std::optional<JsonPiece> JsonPieces::next() {
  skip_blanks();
  if (at_ == text_.size()) return std::nullopt;
  if (text_[at_] != '{' && text_[at_] != '[')
    throw refusal("", "expected a JSON object, which begins with '{{', found {}", shown(text_[at_]))
        .at(with_place(where_, fmt::format("line {}", line_)));
  const std::size_t begin = at_;
  const std::size_t line = line_;
  skip_value();
  return JsonPiece{text_.substr(begin, at_ - begin), line};
}

bool JsonPieces::done() {
  skip_blanks();
  return at_ == text_.size();
}

void JsonPieces::skip_blanks() {
  for (; at_ < text_.size() && is_blank(text_[at_]); ++at_)
    if (text_[at_] == '\n') ++line_;
}

void JsonPieces::skip_value() {
  int depth = 0;
  bool in_text = false;
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (c == '\n') ++line_;
    if (in_text) {
      if (c == '\\') ++at_;
      if (c == '"') in_text = false;
      continue;
    }
    if (c == '"') in_text = true;
    if ((c == '{' || c == '[') && ++depth > deepest_json)
      throw refusal("", "nested deeper than {} levels", deepest_json)
          .at(with_place(where_, fmt::format("line {}", line_)));
    if ((c == '}' || c == ']') && --depth == 0) {
      ++at_;
      return;
    }
  }
  at_ = text_.size();  // never closed, which the parser will say
}

// ---- parsing ------------------------------------------------------------------

Json parse_json(const JsonPiece& piece, const std::string& where) {
  Builder builder;
  try {
    if (!Json::sax_parse(piece.text, &builder))
      throw malformed(piece, builder.failed_at, builder.failure, where);
  } catch (const Refusal& refused) {
    throw refused.at(with_place(where, fmt::format("line {}", piece.line)));
  }
  return std::move(builder.value);
}

Json parse_json(std::string_view text, const std::string& where) {
  JsonPieces pieces(text, where);
  const auto piece = pieces.next();
  if (!piece) throw Refusal{"", "is empty, expected JSON"}.at(where);
  if (!pieces.done()) throw Refusal{"", "more than one JSON value"}.at(where);
  return parse_json(*piece, where);
}

}  // namespace evo
