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
  // The library keeps the last of several values of one key, and looks every new key up among
  // all before it.
  constexpr std::size_t most_keys = 40'000;
  std::vector<std::unordered_set<std::string>> open;  // keys of the objects around
  const auto check = [&](int /*depth*/, Json::parse_event_t event, const Json& parsed) {
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event != Json::parse_event_t::key) return true;
    if (!open.back().insert(parsed.get_ref<const std::string&>()).second)
      throw refusal("", "the key {} is given twice in one object", shown(parsed));
    if (open.back().size() > most_keys)
      throw refusal("", "an object with more than {} keys", most_keys);
    return true;
  };
  try {
    return Json::parse(piece.text, check);
  } catch (const Json::parse_error& failure) {
    throw malformed(piece, failure.byte, failure.what(), where);
  } catch (const Json::exception& failure) {  // a number too large
    throw malformed(piece, 0, failure.what(), where);
  } catch (const Refusal& refused) {
    throw refused.at(with_place(where, fmt::format("line {}", piece.line)));
  }
}

Json parse_json(std::string_view text, const std::string& where) {
  JsonPieces pieces(text, where);
  const auto piece = pieces.next();
  if (!piece) throw Refusal{"", "is empty, expected JSON"}.at(where);
  if (!pieces.done()) throw Refusal{"", "more than one JSON value"}.at(where);
  return parse_json(*piece, where);
}

}  // namespace evo
